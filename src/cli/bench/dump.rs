//! Writes the triangles of a scene and the rays of one kind.

use std::sync::Arc;

use super::options::DumpOptions;
use crate::cli::error::CliError;
use crate::cli::input::load;
use crate::cli::output;
use crate::measure::bench::ray_file::write_rays;
use crate::render::{Snapshot, rays_of};

/// Runs the command.
pub(super) fn run(options: &DumpOptions) -> Result<(), CliError> {
    let loaded = load(&options.input, &options.load)?;
    let snapshot = Snapshot {
        scene: loaded.scene,
        settings: Arc::new(loaded.settings),
        size: options.size,
    };
    let list = rays_of(&snapshot, options.kind);
    let (kind, active) = (options.kind.name(), list.active());
    if active == 0 {
        return Err(CliError::NothingToTime {
            path: options.input.clone(),
            message: format!("the picture sends no {kind} rays"),
        });
    }
    let mesh = &snapshot.scene.mesh;
    write_rays(&options.output, options.kind, mesh, &list)?;
    output::answer(&format!(
        "{}: {} triangles, {active} {kind} rays in {} places",
        options.output.display(),
        mesh.len(),
        list.rays.len()
    ))
}
