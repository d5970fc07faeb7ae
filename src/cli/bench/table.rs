//! The whole table: frames, scaling, rays, growth.

use std::sync::Arc;

use serde_json::json;

use super::options::TableOptions;
use super::report::Report;
use super::rows;
use crate::cli::error::CliError;
use crate::cli::input::{load_changed, snapshot};
use crate::cli::options::SceneOptions;
use crate::measure::bench::{FrameCase, Growth, RayRace, Spread, Study, scalar_twin};
use crate::render::{RayKind, Snapshot, rays_of};
use crate::surface::mapping::Method;

/// Runs the command.
pub(super) fn run(options: &TableOptions) -> Result<(), CliError> {
    let scenes = options.scenes.iter().map(scene);
    let scenes = scenes.collect::<Result<Vec<_>, CliError>>()?;
    let mut report = Report::new(options.json);
    report.machine(json!({
        "threads": options.threads,
        "size": options.size,
        "passes": options.passes,
    }))?;
    frames(options, &scenes, &mut report)?;
    scaling(options, &scenes, &mut report)?;
    rays(options, &scenes, &mut report)?;
    growth(options, &mut report)?;
    report.finish()
}

/// A scene with its name, as the user called it.
type Named = (String, Snapshot);

fn scene(options: &SceneOptions) -> Result<Named, CliError> {
    let snapshot = snapshot(load_changed(options)?);
    Ok((options.input.display().to_string(), snapshot))
}

fn by_method(snapshot: &Snapshot, method: Method) -> Snapshot {
    let mut settings = (*snapshot.settings).clone();
    settings.mapping.method = method;
    Snapshot {
        settings: Arc::new(settings),
        ..snapshot.clone()
    }
}

fn most(options: &TableOptions) -> usize {
    options.threads.iter().copied().max().unwrap_or(1)
}

fn frames(options: &TableOptions, scenes: &[Named], report: &mut Report) -> Result<(), CliError> {
    let threads = most(options);
    report.part("frame", rows::FRAME)?;
    for (name, snapshot) in scenes {
        let twin = scalar_twin(&snapshot.scene);
        for method in Method::ALL {
            let case = FrameCase::new(by_method(snapshot, method));
            case.check(&twin)?;
            let times = case.time(threads, options.passes)?;
            report.line("frame", rows::frame(name, method, threads, &times))?;
        }
    }
    Ok(())
}

/// The pictures were checked with the frames.
fn scaling(options: &TableOptions, scenes: &[Named], report: &mut Report) -> Result<(), CliError> {
    report.part("scaling", rows::SCALING)?;
    for (name, snapshot) in scenes {
        let method = snapshot.settings.mapping.method;
        let case = FrameCase::new(snapshot.clone());
        let mut reference: Option<(usize, Spread)> = None;
        for &threads in &options.threads {
            let full = case.time(threads, options.passes)?.full;
            let row = (threads, full);
            let reference = *reference.get_or_insert(row);
            report.line("scaling", rows::scaling(name, method, row, reference))?;
        }
    }
    Ok(())
}

fn rays(options: &TableOptions, scenes: &[Named], report: &mut Report) -> Result<(), CliError> {
    report.part("rays", rows::RAYS)?;
    for (name, snapshot) in scenes {
        for kind in RayKind::ALL {
            let list = rays_of(snapshot, kind);
            let rays = list.active();
            if rays == 0 {
                continue;
            }
            let race = RayRace {
                bvh: &snapshot.scene.bvh,
                list: &list,
                query: kind.query(),
            };
            race.check()?;
            for &threads in &options.threads {
                let speed = race.time(threads, options.passes)?;
                report.line("rays", rows::rays(name, kind, rays, &speed))?;
            }
        }
    }
    Ok(())
}

fn growth(options: &TableOptions, report: &mut Report) -> Result<(), CliError> {
    let threads = most(options);
    let growth = Growth {
        size: options.size,
        threads,
        rounds: options.passes,
        is_quick: options.is_quick,
    };
    let counted = Study::ALL.map(|study| format!("{}: {}", study.name(), study.counts()));
    report.part("growth", &counted.join("; "))?;
    for study in Study::ALL {
        growth.run(study, |point| {
            report.line("growth", rows::growth(&point, threads))
        })?;
    }
    Ok(())
}
