//! From settings to the text of a scene file, so that reading it back gives the same settings.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::paths::{folder, relative};
use super::read::MAX_BYTES;
use super::text::{Text, degrees};
use super::write_material::material;
use crate::scene::save_picture::temporary_beside;
use crate::scene::{Background, DisplaySettings, LoadedScene, RenderSettings, Scene, SceneSource};
use crate::shading::{Light, LightKind};

/// What a scene file holds.
#[derive(Debug, Clone, Copy)]
pub struct SceneView<'a> {
    /// Names the model and the pictures.
    pub scene: &'a Scene,
    /// Camera, lights, materials, mapping, samples.
    pub settings: &'a RenderSettings,
    /// Exposure.
    pub display: &'a DisplaySettings,
    /// Picture size in pixels, if the scene asks for one.
    pub size: Option<[u32; 2]>,
}

impl<'a> From<&'a LoadedScene> for SceneView<'a> {
    fn from(loaded: &'a LoadedScene) -> Self {
        Self {
            scene: &loaded.scene,
            settings: &loaded.settings,
            display: &loaded.display,
            size: loaded.size,
        }
    }
}

/// A scene file that could not be written.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// The system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// TOML is UTF-8, and this path is not.
    #[error("{}: a scene file cannot hold a path that is not UTF-8", .0.display())]
    NotUtf8(PathBuf),
    /// The scene says neither where its model is nor which built-in scene it is.
    #[error("{}: the scene has no model to refer to", .0.display())]
    NoModel(PathBuf),
    /// A number that TOML could hold but no scene means.
    #[error("`{0}` is not a finite number")]
    NotFinite(String),
    /// More text than would be read back.
    #[error("{}: {length} bytes; no scene file is read beyond {MAX_BYTES}", path.display())]
    TooLong {
        /// The file.
        path: PathBuf,
        /// Of the text.
        length: usize,
    },
}

/// Writes a scene file; paths in it are relative to its folder where they share one.
///
/// The file appears whole or not at all: it is written beside its place and then renamed. Reading it gives
/// the settings bit for bit, but for `vfov`: an angle that is no whole number of steps of a degree in double
/// precision comes back one step away at most.
///
/// # Errors
/// [`SaveError`] if a number is not finite, a path is not UTF-8, the text is too long, or the system refuses.
pub fn write_scene(path: &Path, view: &SceneView<'_>) -> Result<(), SaveError> {
    let text = scene_text(view, folder(path))?;
    if text.len() as u64 > MAX_BYTES {
        return Err(SaveError::TooLong {
            path: path.to_owned(),
            length: text.len(),
        });
    }
    write_whole(path, text.as_bytes()).map_err(|source| SaveError::Io {
        path: path.to_owned(),
        source,
    })
}

/// The text of a scene file in the folder `base`.
pub(super) fn scene_text(view: &SceneView<'_>, base: &Path) -> Result<String, SaveError> {
    let mut text = Text::new(
        "Reliefscope scene file. docs/scene.md explains every key.\n\
         Lengths in world units, angles in degrees, colours linear, paths relative to this file.",
    );
    model(&mut text, view, base)?;
    camera(&mut text, view)?;
    for (i, each) in view.settings.lights.iter().enumerate() {
        light(&mut text, i, each)?;
    }
    shading(&mut text, view)?;
    mapping(&mut text, view)?;
    for i in 0..view.settings.materials.len() {
        material(&mut text, view, i, base)?;
    }
    text.table("render");
    if let Some([width, height]) = view.size {
        text.raw("size", format!("[{width}, {height}]"));
    }
    text.raw("samples", view.settings.samples);
    text.table("display");
    text.single("exposure_ev", view.display.exposure_ev)?;
    text.string("view", view.display.view.name());
    text.string("kernel", view.display.kernel.name());
    text.string("offset_rule", view.display.offset_rule.name());
    Ok(text.finish())
}

/// A path as the file names it.
pub(super) fn path_text(path: &Path, base: &Path) -> Result<String, SaveError> {
    let seen = relative(path, base);
    let text = seen.to_str().map(str::to_owned);
    text.ok_or(SaveError::NotUtf8(seen))
}

/// Writes a file whole: into a temporary one beside it, which then takes its name.
///
/// # Errors
/// The system's; what was there before stays.
pub fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = temporary_beside(path)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    // What is replaced stays as private, or as shared, as it was.
    if let Ok(old) = std::fs::metadata(path) {
        file.as_file().set_permissions(old.permissions())?;
    }
    file.persist(path)?;
    Ok(())
}

fn model(text: &mut Text, view: &SceneView<'_>, base: &Path) -> Result<(), SaveError> {
    match (&view.scene.facts.path, &view.scene.source) {
        (Some(path), _) => text.string("model", &path_text(path, base)?),
        (None, SceneSource::BuiltIn(name)) => text.string("built_in", name),
        (None, SceneSource::Model(path)) => text.string("model", &path_text(path, base)?),
        (None, SceneSource::SceneFile(path)) => return Err(SaveError::NoModel(path.clone())),
    }
    let is_normalized = view.scene.normalization != crate::geometry::Normalization::IDENTITY;
    text.raw("normalize", is_normalized);
    if view.settings.lights.is_empty() {
        text.raw("light", "[]");
    }
    if view.settings.materials.is_empty() {
        text.raw("material", "[]");
    }
    Ok(())
}

fn camera(text: &mut Text, view: &SceneView<'_>) -> Result<(), SaveError> {
    let camera = &view.settings.camera;
    text.table("camera");
    text.vector("eye", camera.eye)?;
    text.vector("target", camera.target)?;
    text.vector("up", camera.up)?;
    text.double("vfov_deg", degrees(camera.vfov))
}

fn light(text: &mut Text, index: usize, light: &Light) -> Result<(), SaveError> {
    text.array_table("light", index);
    text.string("kind", super::parse_light::kind_name(&light.kind));
    text.string("name", &light.name);
    text.raw("enabled", light.enabled);
    match light.kind {
        LightKind::Ambient => {}
        LightKind::Point { position, falloff } => {
            text.vector("position", position)?;
            text.string("falloff", super::parse_light::falloff_name(falloff));
        }
        LightKind::Directional { direction } => text.vector("direction", direction)?,
    }
    text.color("color", light.color)?;
    text.single("intensity", light.intensity)
}

fn shading(text: &mut Text, view: &SceneView<'_>) -> Result<(), SaveError> {
    let shading = &view.settings.shading;
    text.table("shading");
    text.string("model", shading.model.name());
    text.string("bent_normals", shading.bent_normals.name());
    text.string("filter", shading.filter.name());
    text.raw("specular_antialiasing", shading.specular_antialiasing);
    text.raw("smooth_terminator", shading.smooth_terminator);
    text.raw("shadows", shading.shadows);
    text.raw("max_bounces", shading.max_bounces);
    let Background { top, bottom } = shading.background;
    if top == bottom {
        return text.color("background", top);
    }
    let [top, bottom] = [
        text.color_text("background.top", top)?,
        text.color_text("background.bottom", bottom)?,
    ];
    text.raw(
        "background",
        format!("{{ top = {top}, bottom = {bottom} }}"),
    );
    Ok(())
}

fn mapping(text: &mut Text, view: &SceneView<'_>) -> Result<(), SaveError> {
    let mapping = &view.settings.mapping;
    text.table("mapping");
    text.string("method", mapping.method.name());
    text.string("lookup", mapping.lookup.name());
    text.string("derivative", mapping.derivative.name());
    text.or_default("amplitude", mapping.amplitude)?;
    text.single("midlevel", mapping.midlevel)?;
    text.raw("use_height", mapping.use_height);
    text.raw("use_normal", mapping.use_normal);
    text.raw("use_parallax", mapping.use_parallax);
    text.raw("cut_at_border", mapping.cut_at_border);
    text.raw("weld_seams", mapping.weld_seams);
    text.raw("displacement_memory", mapping.displacement_memory);
    let search = &mapping.search;
    text.raw("layers", search.layers);
    text.raw("min_layers", search.min_layers);
    text.raw("bisections", search.bisections);
    text.raw("iterations", search.iterations);
    text.raw("self_shadow", search.self_shadow);
    Ok(())
}
