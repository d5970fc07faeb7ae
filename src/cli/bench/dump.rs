//! Writes the triangles of a scene and the rays of one kind.

use super::options::DumpOptions;
use crate::cli::error::CliError;
use crate::cli::input::{load_changed, snapshot};
use crate::cli::output;
use crate::measure::bench::ray_file::write_rays;
use crate::render::rays_of;

/// Runs the command.
pub(super) fn run(options: &DumpOptions) -> Result<(), CliError> {
    let snapshot = snapshot(load_changed(&options.scene)?);
    let list = rays_of(&snapshot, options.kind);
    let (kind, active) = (options.kind.name(), list.active());
    if active == 0 {
        return Err(CliError::NothingToTime {
            path: options.scene.input.clone(),
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
