//! `[[material]]` and `[[material.map]]`: what overrides the model's materials.

use super::document::{MapKeys, MaterialKeys, Placed, Which};
use super::fault::Read;
use super::parse::{amplitude, or_default, placed};
use super::section::{Item, Limits, Section};
use crate::texture::{Channel, MapRole, NormalAxes, NormalSpace, Wrap};

/// The key that gives a material its one map in a role.
pub(super) const fn simple_key(role: MapRole) -> &'static str {
    match role {
        MapRole::Albedo => "albedo_map",
        MapRole::Height => "height_map",
        MapRole::Normal => "normal_map",
        MapRole::Slope => "slope_map",
        MapRole::Opacity => "opacity_map",
    }
}

/// All entries in file order.
pub(super) fn materials(root: &mut Section<'_>) -> Read<Vec<MaterialKeys>> {
    let tables = root.sections("material")?.unwrap_or_default();
    tables.into_iter().map(material).collect()
}

fn material(mut table: Section<'_>) -> Read<MaterialKeys> {
    let which = which(&mut table)?;
    let mut simple_maps = Vec::new();
    for role in MapRole::ALL {
        let path = table.read(simple_key(role), |x| Ok(placed(x, x.text()?)))?;
        simple_maps.extend(path.map(|path| (role, path)));
    }
    let maps = table.sections("map")?;
    let keys = MaterialKeys {
        which,
        kd: table.read("kd", Item::color)?,
        ks: table.read("ks", Item::color)?,
        shininess: table.read("shininess", |x| x.single(Limits::AtLeast(0.0)))?,
        reflectivity: table.read("reflectivity", |x| x.single(Limits::Within(0.0, 1.0)))?,
        amplitude: table.read("amplitude", amplitude)?,
        midlevel: table.read("midlevel", |x| or_default(x, |x| x.single(Limits::Finite)))?,
        default_amplitude: table.read("default_amplitude", |x| x.number(Limits::AtLeast(0.0)))?,
        maps: maps
            .map(|tables| tables.into_iter().map(map).collect())
            .transpose()?,
        simple_maps,
        normal_down: table.read("normal_y", normal_down)?,
        normal_space: table.read("normal_space", |x| {
            Ok(placed(x, x.choice(&NormalSpace::ALL, NormalSpace::name)?))
        })?,
        normal_axes: table.read("normal_axes", |x| Ok(placed(x, axes(x)?)))?,
        destair: table.read("destair", |x| Ok(placed(x, x.boolean()?)))?,
        normal_amplitude: table.read("normal_amplitude", |x| Ok(placed(x, baked_amplitude(x)?)))?,
    };
    table.finish()?;
    Ok(keys)
}

fn which(table: &mut Section<'_>) -> Read<Placed<Which>> {
    let name = table.read("name", |item| {
        let name = item.text()?;
        let which = if name == "*" {
            Which::Every
        } else {
            Which::Named(name)
        };
        Ok(placed(item, which))
    })?;
    let index = table.read("index", |item| {
        let number = item.integer(0, u32::from(u16::MAX))?;
        Ok(placed(item, Which::Numbered(number as usize)))
    })?;
    // The number goes before the name, which then only tells the reader what it is.
    index.or(name).ok_or_else(|| {
        table.fault(format!(
            "`{}` needs `name`: a material of the model, or \"*\" for every one",
            table.name()
        ))
    })
}

fn normal_down(item: &Item<'_>) -> Read<Placed<bool>> {
    let word = item.choice(&["up", "down"], |word| word)?;
    Ok(placed(item, word == "down"))
}

fn axes(item: &Item<'_>) -> Read<NormalAxes> {
    let text = item.text()?;
    NormalAxes::parse(&text).ok_or_else(|| {
        item.fault(format!(
            "must tell what red, green and blue are, each of x, y and z once, such as \"+x -z +y\", not \"{text}\""
        ))
    })
}

/// World units above zero, or "default". A map baked for no relief cannot be scaled to one.
fn baked_amplitude(item: &Item<'_>) -> Read<Option<f64>> {
    or_default(item, |x| x.number(Limits::Above(0.0)))
}

fn map(mut table: Section<'_>) -> Read<MapKeys> {
    let image = table.read("image", |x| Ok(placed(x, x.text()?)))?;
    let role = table.read("role", |x| x.choice(&MapRole::ALL, MapRole::name))?;
    let needs = |key: &str| table.fault(format!("`{}` needs `{key}`", table.name()));
    let image = image.ok_or_else(|| needs("image"))?;
    let role = role.ok_or_else(|| needs("role"))?;
    let keys = MapKeys {
        image,
        role,
        enabled: table.read("enabled", Item::boolean)?,
        channel: table.read("channel", |x| x.choice(&Channel::ALL, Channel::name))?,
        invert: table.read("invert", Item::boolean)?,
        flip_green: table.read("flip_green", Item::boolean)?,
        space: table.read("space", |x| x.choice(&NormalSpace::ALL, NormalSpace::name))?,
        axes: table.read("axes", axes)?,
        destair: table.read("destair", Item::boolean)?,
        flip_v: table.read("flip_v", Item::boolean)?,
        wrap: table.read("wrap", |x| x.choice(&Wrap::ALL, Wrap::name))?,
        uv_scale: table.read("uv_scale", pair)?,
        uv_offset: table.read("uv_offset", pair)?,
        gain: table.read("gain", |x| x.single(Limits::Finite))?,
        bias: table.read("bias", |x| x.single(Limits::Finite))?,
        strength: table.read("strength", |x| x.single(Limits::Above(0.0)))?,
        baked_amplitude: table.read("baked_amplitude", baked_amplitude)?,
        note: table.read("note", Item::text)?,
    };
    table.finish()?;
    Ok(keys)
}

fn pair(item: &Item<'_>) -> Read<[f32; 2]> {
    item.array(|x| x.single(Limits::Finite))
}
