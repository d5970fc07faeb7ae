//! From the text of a scene file to what it says. Nothing else is opened here.

use toml::de::DeTable;

use super::document::{
    CameraKeys, DisplayKeys, Document, MappingKeys, ModelName, OrDefault, Placed, ShadingKeys,
};
use super::fault::{Fault, Read};
use super::parse_light::lights;
use super::parse_material::materials;
use super::section::{Item, Limits, Section};
use crate::geometry::{Kernel, OffsetRule};
use crate::scene::{Background, BentNormals, ShadingModel, TextureFilter, View};
use crate::surface::mapping::{Derivative, Lookup, MappingSettings, Method, SearchSettings};

/// Most columns or rows of a picture.
const MAX_SIDE: u32 = 65_536;
/// Most pixels of a picture: 2²⁸, 3 GiB of linear sums.
const MAX_PIXELS: u64 = 1 << 28;
/// Most samples per pixel.
const MAX_SAMPLES: u32 = 1 << 20;
/// Most mirror bounces.
const MAX_BOUNCES: u32 = 64;
/// Largest exposure either way, stops: beyond it every picture is black or white.
const MAX_EXPOSURE_EV: f64 = 32.0;

/// Reads a whole file.
pub(super) fn parse(text: &str) -> Read<Document> {
    // A byte order mark would count as part of the first key.
    let bare = text.strip_prefix('\u{feff}').unwrap_or(text);
    let skipped = text.len() - bare.len();
    document(bare).map_err(|fault| Fault {
        at: fault.at.map(|at| at + skipped),
        ..fault
    })
}

/// Checks a picture's size, pixels.
pub(super) fn check_size([width, height]: [u32; 2]) -> Result<(), String> {
    let side = 1..=MAX_SIDE;
    if !(side.contains(&width) && side.contains(&height)) {
        return Err(format!(
            "must have 1 to {MAX_SIDE} columns and rows, not {width} by {height}"
        ));
    }
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(format!(
            "must not have more than {MAX_PIXELS} pixels in all, and {width} by {height} has"
        ));
    }
    Ok(())
}

fn document(text: &str) -> Read<Document> {
    let table = DeTable::parse(text).map_err(|error| syntax_fault(text, &error))?;
    let mut root = Section::root(table.get_ref());
    let model = model(&mut root)?;
    let normalize = root.read("normalize", Item::boolean)?;
    let camera = camera(&mut root)?;
    let lights = lights(&mut root)?;
    let shading = shading(&mut root)?;
    let mapping = mapping(&mut root)?;
    let materials = materials(&mut root)?;
    let (size, samples) = render(&mut root)?;
    let display = display(&mut root)?;
    root.finish()?;
    Ok(Document {
        model,
        normalize,
        camera,
        lights,
        shading,
        mapping,
        materials,
        size,
        samples,
        display,
    })
}

fn syntax_fault(text: &str, error: &toml::de::Error) -> Fault {
    let span = error.span();
    // The first line says what; a second one at most says where, which the line number does better.
    let what = error.message().lines().next().unwrap_or("not TOML");
    let word = span
        .clone()
        .and_then(|span| text.get(span))
        .map(|word| word.lines().next().unwrap_or_default().trim())
        .filter(|word| !word.is_empty() && word.len() <= 40)
        .map_or_else(String::new, |word| format!(" at `{word}`"));
    Fault {
        at: span.map(|span| span.start),
        message: format!("not TOML{word}: {what}"),
    }
}

fn model(root: &mut Section<'_>) -> Read<Placed<ModelName>> {
    let file = root.read("model", |item| {
        Ok(placed(item, ModelName::File(name(item)?)))
    })?;
    let built_in = root.read("built_in", |item| {
        Ok(placed(item, ModelName::BuiltIn(name(item)?)))
    })?;
    match (file, built_in) {
        (Some(_), Some(second)) => Err(Fault::new(
            second.at,
            "`built_in` and `model` exclude each other",
        )),
        (Some(model), None) | (None, Some(model)) => Ok(model),
        (None, None) => Err(root.fault(
            "a scene needs `model = \"FILE.obj\"` or `built_in = \"NAME\"` before its first table",
        )),
    }
}

fn name(item: &Item<'_>) -> Read<String> {
    let text = item.text()?;
    if text.is_empty() {
        return Err(item.fault("must not be empty"));
    }
    Ok(text)
}

fn camera(root: &mut Section<'_>) -> Read<CameraKeys> {
    let Some(mut table) = root.section("camera")? else {
        return Ok(CameraKeys::default());
    };
    let eye = table.read("eye", Item::vector)?;
    let target = table.read("target", |item| {
        let target = item.vector()?;
        if Some(target) == eye {
            return Err(item.fault("must not be the same point as `camera.eye`"));
        }
        Ok(target)
    })?;
    let keys = CameraKeys {
        eye,
        target,
        up: table.read("up", Item::direction)?,
        vfov_deg: table.read("vfov_deg", |x| x.number(Limits::Between(0.0, 180.0)))?,
    };
    table.finish()?;
    Ok(keys)
}

fn shading(root: &mut Section<'_>) -> Read<ShadingKeys> {
    let Some(mut table) = root.section("shading")? else {
        return Ok(ShadingKeys::default());
    };
    let keys = ShadingKeys {
        model: table.read("model", |x| {
            x.choice(&ShadingModel::ALL, ShadingModel::name)
        })?,
        bent_normals: table.read("bent_normals", |x| {
            x.choice(&BentNormals::ALL, BentNormals::name)
        })?,
        filter: table.read("filter", |x| {
            x.choice(&TextureFilter::ALL, TextureFilter::name)
        })?,
        specular_antialiasing: table.read("specular_antialiasing", Item::boolean)?,
        smooth_terminator: table.read("smooth_terminator", Item::boolean)?,
        shadows: table.read("shadows", Item::boolean)?,
        max_bounces: table.read("max_bounces", |x| x.integer(0, MAX_BOUNCES))?,
        background: table.read("background", background)?,
    };
    table.finish()?;
    Ok(keys)
}

/// `[r, g, b]`, or `{ top = …, bottom = … }`.
fn background(item: &Item<'_>) -> Read<Background> {
    if !item.is_table() {
        return item.color().map(Background::plain);
    }
    let mut table = item.section()?;
    let top = table.read("top", Item::color)?;
    let bottom = table.read("bottom", Item::color)?;
    let both = top.zip(bottom);
    table.finish()?;
    let (top, bottom) = both.ok_or_else(|| item.fault("needs both `top` and `bottom`"))?;
    Ok(Background { top, bottom })
}

fn mapping(root: &mut Section<'_>) -> Read<MappingKeys> {
    let Some(mut table) = root.section("mapping")? else {
        return Ok(MappingKeys::default());
    };
    let keys = MappingKeys {
        method: table.read("method", |x| x.choice(&Method::ALL, Method::name))?,
        lookup: table.read("lookup", |x| x.choice(&Lookup::ALL, Lookup::name))?,
        derivative: table.read("derivative", |x| {
            x.choice(&Derivative::ALL, Derivative::name)
        })?,
        amplitude: table.read("amplitude", amplitude)?,
        midlevel: table.read("midlevel", |x| x.single(Limits::Finite))?,
        use_height: table.read("use_height", Item::boolean)?,
        use_normal: table.read("use_normal", Item::boolean)?,
        use_parallax: table.read("use_parallax", Item::boolean)?,
        cut_at_border: table.read("cut_at_border", Item::boolean)?,
        weld_seams: table.read("weld_seams", Item::boolean)?,
        displacement_memory: table.read("displacement_memory", |x| {
            x.integer(0, MappingSettings::MAX_DISPLACEMENT_MEMORY)
        })?,
        layers: table.read("layers", |x| x.integer(1, SearchSettings::MAX_LAYERS))?,
        min_layers: table.read("min_layers", |x| x.integer(1, SearchSettings::MAX_LAYERS))?,
        bisections: table.read("bisections", |x| {
            x.integer(0, SearchSettings::MAX_BISECTIONS)
        })?,
        iterations: table.read("iterations", |x| {
            x.integer(1, SearchSettings::MAX_ITERATIONS)
        })?,
        self_shadow: table.read("self_shadow", Item::boolean)?,
    };
    table.finish()?;
    Ok(keys)
}

fn render(root: &mut Section<'_>) -> Read<(Option<[u32; 2]>, Option<u32>)> {
    let Some(mut table) = root.section("render")? else {
        return Ok((None, None));
    };
    let size = table.read("size", |item| {
        let size = item.array(|n| n.integer(1, MAX_SIDE))?;
        check_size(size).map_err(|why| item.fault(why))?;
        Ok(size)
    })?;
    let samples = table.read("samples", |x| x.integer(1, MAX_SAMPLES))?;
    table.finish()?;
    Ok((size, samples))
}

fn display(root: &mut Section<'_>) -> Read<DisplayKeys> {
    let Some(mut table) = root.section("display")? else {
        return Ok(DisplayKeys::default());
    };
    let keys = DisplayKeys {
        exposure_ev: table.read("exposure_ev", |x| {
            x.single(Limits::Within(-MAX_EXPOSURE_EV, MAX_EXPOSURE_EV))
        })?,
        view: table.read("view", |x| x.choice(&View::ALL, View::name))?,
        kernel: table.read("kernel", |x| x.choice(&Kernel::ALL, Kernel::name))?,
        offset_rule: table.read("offset_rule", |x| {
            x.choice(&OffsetRule::ALL, OffsetRule::name)
        })?,
    };
    table.finish()?;
    Ok(keys)
}

/// A relief's height, world units, or "default".
pub(super) fn amplitude(item: &Item<'_>) -> Read<OrDefault<f64>> {
    or_default(item, |x| x.number(Limits::AtLeast(0.0)))
}

/// A number, or "default" for none of one's own.
pub(super) fn or_default<T>(
    item: &Item<'_>,
    read: impl FnOnce(&Item<'_>) -> Read<T>,
) -> Read<OrDefault<T>> {
    match item.as_str() {
        Some("default") => Ok(None),
        Some(_) => Err(item.fault("must be a number or \"default\"")),
        None => read(item).map(Some),
    }
}

/// A value with the place of its key.
pub(super) fn placed<T>(item: &Item<'_>, value: T) -> Placed<T> {
    Placed {
        value,
        key: item.name().to_owned(),
        at: item.at(),
    }
}
