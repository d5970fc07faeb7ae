//! From an OBJ file to a scene with settings to start from.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;
use std::sync::Arc;

use super::mesh::{Assembly, assemble};
use super::obj::{Kind, Notes, Obj};
use super::staging::staged;
use super::{
    LibraryRef, LoadMonitor, LoadOptions, MaterialSet, Stage, fill_default_amplitudes,
    load_materials,
};
use crate::geometry::bvh::Bvh;
use crate::geometry::{Normalization, TriangleMesh};
use crate::scene::{
    DisplaySettings, LoadError, LoadWarning, LoadedScene, ModelFacts, Scene, SceneSource,
};

/// No model's text is longer. Read, parsed and assembled it would take four times as much memory.
const MAX_BYTES: u64 = 16 << 30;
/// Nor longer than this where the length is not known beforehand.
const MAX_STREAM_BYTES: u64 = 1 << 30;
/// Bytes read between two looks at the monitor.
const READ_BYTES: u64 = 4 << 20;

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
    let monitor = &*options.monitor;
    let text = read(path, monitor)?;
    let mut obj = Obj::parse(&text, path, monitor)?;
    drop(text);
    let header = Header::take(&mut obj);
    let Assembly {
        mesh,
        normalization,
        facts,
        crossed,
    } = assemble(obj, options)?;
    let mut warnings = geometry_notes(header.notes, path, &facts, &crossed);
    let Some(bounds) = facts.bounds else {
        return Err(no_surface(path, &facts, &warnings));
    };
    monitor.reached(Stage::Materials, 0.0)?;
    let mut set = load_materials(&header.libraries, &header.materials, options)?;
    settle_amplitudes(&mut set, path, (&mesh, &normalization));
    warnings.append(&mut set.warnings);
    let settings = staged(&mesh, bounds, set.materials);
    let bvh = Bvh::build_watched(&mesh, &|share| monitor.reached(Stage::Tree, share))?;
    let scene = Scene {
        displaced: crate::surface::displaced::DisplacementCell::default(),
        tangents: crate::geometry::TangentCell::default(),
        uv_charts: crate::geometry::UvChartCell::default(),
        name: path.file_name().map_or_else(
            || path.display().to_string(),
            |name| name.to_string_lossy().into_owned(),
        ),
        source: SceneSource::Model(path.to_owned()),
        bvh,
        mesh,
        normalization,
        images: set.images,
        facts,
    };
    monitor.reached(Stage::Tree, 1.0)?;
    Ok(LoadedScene {
        scene: Arc::new(scene),
        settings,
        display: DisplaySettings::default(),
        size: None,
        warnings,
    })
}

/// All bytes of a file.
fn read(path: &Path, monitor: &LoadMonitor) -> Result<Vec<u8>, LoadError> {
    let in_file = |source| LoadError::Io {
        path: path.to_owned(),
        source,
    };
    let mut file = File::open(path).map_err(in_file)?;
    // What is no plain file has no size to speak of, and is read all the same.
    let facts = file.metadata().map_err(in_file)?;
    let size = facts.len();
    let most = if facts.is_file() {
        MAX_BYTES
    } else {
        MAX_STREAM_BYTES
    };
    let too_long = |bytes: u64| {
        let message = format!("{bytes} bytes of text; at most {most} are read");
        (bytes > most).then(|| in_file(io::Error::new(ErrorKind::FileTooLarge, message)))
    };
    if let Some(error) = too_long(size) {
        return Err(error);
    }
    let mut text = Vec::new();
    text.try_reserve_exact(size as usize)
        .map_err(|_| in_file(ErrorKind::OutOfMemory.into()))?;
    loop {
        monitor.reached(Stage::Reading, text.len() as f32 / size as f32)?;
        let part = file.by_ref().take(READ_BYTES).read_to_end(&mut text);
        if part.map_err(in_file)? == 0 {
            return Ok(text);
        }
        if let Some(error) = too_long(text.len() as u64) {
            return Err(error);
        }
    }
}

/// What outlives the polygons of a file.
struct Header {
    materials: Vec<(Vec<u8>, usize)>,
    libraries: Vec<LibraryRef>,
    notes: Notes,
}

impl Header {
    fn take(obj: &mut Obj) -> Self {
        Self {
            materials: std::mem::take(&mut obj.materials),
            libraries: std::mem::take(&mut obj.libraries),
            notes: std::mem::take(&mut obj.notes),
        }
    }
}

/// Amplitudes that libraries leave open depend on the mesh. Every warning gets its file.
fn settle_amplitudes(
    set: &mut MaterialSet,
    path: &Path,
    (mesh, normalization): (&TriangleMesh, &Normalization),
) {
    let notes = fill_default_amplitudes(&mut set.materials, &set.images, mesh, normalization);
    set.warnings
        .extend(notes.into_iter().map(|message| LoadWarning {
            file: path.to_owned(),
            line: None,
            message,
        }));
    for warning in &mut set.warnings {
        // Without a library, nobody told the materials which model asks for them.
        if warning.file.as_os_str().is_empty() {
            path.clone_into(&mut warning.file);
        }
    }
}

fn geometry_notes(
    mut notes: Notes,
    path: &Path,
    facts: &ModelFacts,
    crossed: &[u32],
) -> Vec<LoadWarning> {
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
    notes.finish(path)
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
