//! From an OBJ file to a scene with settings to start from.

use std::path::Path;
use std::sync::Arc;

use super::mesh::{Assembly, assemble};
use super::obj::{Kind, MaterialUse, Notes, Obj};
use super::staging::staged;
use super::{LibraryRef, LoadOptions, MaterialSet, fill_default_amplitudes, load_materials};
use crate::geometry::bvh::Bvh;
use crate::math::LinearRgb;
use crate::scene::{
    DisplaySettings, LoadError, LoadWarning, LoadedScene, ModelFacts, Scene, SceneSource,
};
use crate::shading::Material;

/// Shares of the work done after reading, parsing, assembling, and reading materials.
const READ: f32 = 0.05;
const PARSED: f32 = 0.45;
const ASSEMBLED: f32 = 0.65;
const MATERIALS: f32 = 0.8;

/// Diffuse grey of a model without materials.
const GRAY: f32 = 0.8;

/// Loads an OBJ model with its material libraries and maps.
///
/// Whatever can be read is read; the rest becomes a warning with file and line. Settings that the model
/// does not give show it from a three-quarter view under three lights. `settings.materials` has one entry
/// per `usemtl` name in the order of first use, and one for faces without. A model whose faces all have
/// zero area loads with an empty mesh, so that it can be inspected.
///
/// # Errors
/// [`LoadError::Io`] if the file cannot be read, [`LoadError::Invalid`] if it has no usable face, more
/// materials than 65,535 or more corners than 32 bits count, [`LoadError::Cancelled`] on request.
pub fn load_model(path: &Path, options: &LoadOptions) -> Result<LoadedScene, LoadError> {
    options.monitor.reached(0.0)?;
    let text = std::fs::read(path).map_err(|source| LoadError::Io {
        path: path.to_owned(),
        source,
    })?;
    options.monitor.reached(READ)?;
    let mut obj = Obj::parse(&text, path, (&options.monitor, [READ, PARSED]))?;
    drop(text);
    let header = Header::take(&mut obj);
    let Assembly {
        mesh,
        normalization,
        facts,
        crossed,
    } = assemble(obj, options, [PARSED, ASSEMBLED])?;
    let mut warnings = geometry_notes(header.notes, &facts, &crossed);
    let Some(bounds) = facts.bounds else {
        return Err(no_surface(path, &facts, &warnings));
    };
    let mut set = materials(&header.materials, &header.libraries, options)?;
    warnings.append(&mut set.warnings);
    let amplitudes =
        fill_default_amplitudes(&mut set.materials, &set.images, &mesh, &normalization);
    let file = || path.to_owned();
    warnings.extend(amplitudes.into_iter().map(|message| LoadWarning {
        file: file(),
        line: None,
        message,
    }));
    options.monitor.reached(MATERIALS)?;
    let settings = staged(&mesh, bounds, set.materials);
    let scene = Scene {
        name: path.file_name().map_or_else(
            || path.display().to_string(),
            |name| name.to_string_lossy().into_owned(),
        ),
        source: SceneSource::Model(path.to_owned()),
        bvh: Bvh::build(&mesh),
        mesh,
        normalization,
        images: set.images,
        facts,
    };
    options.monitor.reached(1.0)?;
    Ok(LoadedScene {
        scene: Arc::new(scene),
        settings,
        display: DisplaySettings::default(),
        size: None,
        warnings,
    })
}

/// What outlives the polygons of a file.
struct Header {
    materials: Vec<MaterialUse>,
    libraries: Vec<LibraryRef>,
    notes: Notes,
}

impl Header {
    fn take(obj: &mut Obj) -> Self {
        let empty = Notes::new(&obj.path);
        Self {
            materials: std::mem::take(&mut obj.materials),
            libraries: std::mem::take(&mut obj.libraries),
            notes: std::mem::replace(&mut obj.notes, empty),
        }
    }
}

fn geometry_notes(mut notes: Notes, facts: &ModelFacts, crossed: &[u32]) -> Vec<LoadWarning> {
    for &line in crossed {
        notes.add(Kind::Crossed, line as usize, || {
            "face is folded or crosses itself; its triangles overlap".into()
        });
    }
    if facts.degenerate > 0 {
        notes.about_file(format!(
            "{} of {} triangles left out: no area, or corners without finite coordinates",
            facts.degenerate, facts.triangles
        ));
    }
    notes.finish()
}

fn no_surface(path: &Path, facts: &ModelFacts, warnings: &[LoadWarning]) -> LoadError {
    let mut message = if facts.triangles == 0 {
        format!("no usable faces ({} vertices)", facts.vertices)
    } else {
        format!(
            "none of the {} triangles has a finite corner",
            facts.triangles
        )
    };
    if let Some(first) = warnings.iter().find(|w| w.line.is_some()) {
        message += &format!("; the first thing noted: {first}");
    }
    LoadError::Invalid {
        path: path.to_owned(),
        line: None,
        message,
    }
}

/// One material per use, in order: from the libraries, or grey.
fn materials(
    uses: &[MaterialUse],
    libraries: &[LibraryRef],
    options: &LoadOptions,
) -> Result<MaterialSet, LoadError> {
    let named: Vec<_> = uses
        .iter()
        .filter(|u| !u.name.is_empty())
        .map(|u| (u.name.clone(), u.line))
        .collect();
    let mut set = load_materials(libraries, &named, options)?;
    let mut found = std::mem::take(&mut set.materials).into_iter();
    set.materials = uses
        .iter()
        .map(|u| {
            let (name, material) = if u.name.is_empty() {
                ("default".into(), None)
            } else {
                (String::from_utf8_lossy(&u.name), found.next())
            };
            material.unwrap_or_else(|| Material::matte(name, LinearRgb::gray(GRAY)))
        })
        .collect();
    Ok(set)
}
