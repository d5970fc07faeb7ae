//! `[[light]]`: sources of light in world units.

use super::fault::Read;
use super::section::{Item, Limits, Section};
use crate::math::LinearRgb;
use crate::shading::{Falloff, Light, LightKind};

const FALLOFFS: [Falloff; 2] = [Falloff::None, Falloff::InverseSquare];

/// Name of a falloff in scene files.
pub(super) const fn falloff_name(falloff: Falloff) -> &'static str {
    match falloff {
        Falloff::None => "none",
        Falloff::InverseSquare => "inverse-square",
    }
}

/// Name of a kind in scene files.
pub(super) const fn kind_name(kind: &LightKind) -> &'static str {
    match kind {
        LightKind::Ambient => "ambient",
        LightKind::Point { .. } => "point",
        LightKind::Directional { .. } => "directional",
    }
}

/// All lights, or `None` where the file has none and the model's stay.
pub(super) fn lights(root: &mut Section<'_>) -> Read<Option<Vec<Light>>> {
    let Some(tables) = root.sections("light")? else {
        return Ok(None);
    };
    let mut lights: Vec<Light> = Vec::with_capacity(tables.len());
    for table in tables {
        let (at, name) = (table.at(), table.name().to_owned());
        let light = light(table, lights.len())?;
        let ambient = |l: &Light| l.kind == LightKind::Ambient;
        if ambient(&light) && lights.iter().any(ambient) {
            let message = format!("`{name}` is a second ambient light; a scene has one at most");
            return Err(super::fault::Fault::new(at, message));
        }
        lights.push(light);
    }
    Ok(Some(lights))
}

fn light(mut table: Section<'_>, number: usize) -> Read<Light> {
    let kind_word = table.read("kind", |x| {
        x.choice(&["ambient", "point", "directional"], |word| word)
    })?;
    let name = table.read("name", Item::text)?;
    let enabled = table.read("enabled", Item::boolean)?;
    let color = table.read("color", Item::color)?;
    let intensity = table.read("intensity", |x| x.single(Limits::AtLeast(0.0)))?;
    let kind = kind(&mut table, kind_word)?;
    table.finish()?;
    Ok(Light {
        name: name.unwrap_or_else(|| format!("{} {}", kind_name(&kind), number + 1)),
        enabled: enabled.unwrap_or(true),
        kind,
        color: color.unwrap_or(LinearRgb::WHITE),
        intensity: intensity.unwrap_or(1.0),
    })
}

fn kind(table: &mut Section<'_>, word: Option<&str>) -> Read<LightKind> {
    let Some(word) = word else {
        let message = format!(
            "`{}` needs `kind`: \"ambient\", \"point\" or \"directional\"",
            table.name()
        );
        return Err(table.fault(message));
    };
    let position = table.item("position");
    let falloff = table.item("falloff");
    let direction = table.item("direction");
    let stray = match word {
        "point" => direction.as_ref(),
        "directional" => position.as_ref().or(falloff.as_ref()),
        _ => position
            .as_ref()
            .or(falloff.as_ref())
            .or(direction.as_ref()),
    };
    if let Some(item) = stray {
        return Err(item.fault(format!("means nothing to a light of kind \"{word}\"")));
    }
    match word {
        "point" => {
            let position = position
                .ok_or_else(|| table.fault(format!("`{}` needs `position`", table.name())))?;
            let falloff = falloff.map(|x| x.choice(&FALLOFFS, falloff_name));
            Ok(LightKind::Point {
                position: position.vector()?,
                falloff: falloff.transpose()?.unwrap_or_default(),
            })
        }
        "directional" => {
            let direction = direction
                .ok_or_else(|| table.fault(format!("`{}` needs `direction`", table.name())))?;
            Ok(LightKind::Directional {
                direction: direction.direction()?,
            })
        }
        _ => Ok(LightKind::Ambient),
    }
}
