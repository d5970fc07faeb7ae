//! Times the rays of a file.

use std::time::Instant;

use serde_json::{Map, Value, json};

use super::options::RaceOptions;
use super::report::Report;
use crate::cli::error::CliError;
use crate::geometry::bvh::Bvh;
use crate::measure::bench::ray_file::{RayFile, read_rays, write_hits};
use crate::measure::bench::{Answers, RayRace, RaySpeed};
use crate::render::RayQuery;

/// Runs the command.
pub(super) fn run(options: &RaceOptions) -> Result<(), CliError> {
    let file = read_rays(&options.rays)?;
    let list = file.list();
    if list.active() == 0 {
        return Err(CliError::NothingToTime {
            path: options.rays.clone(),
            message: "holds no active ray".to_owned(),
        });
    }
    let began = Instant::now();
    let bvh = Bvh::build(&file.mesh);
    let build_ms = began.elapsed().as_secs_f64() * 1e3;
    let race = RayRace {
        bvh: &bvh,
        list: &list,
        query: file.query,
    };
    let answers = race.check()?;
    if let Some(path) = &options.hits {
        write_hits(path, &file.rays, &answers)?;
    }
    let speeds = options.threads.iter();
    let speeds = speeds
        .map(|&threads| race.time(threads, options.passes))
        .collect::<Result<Vec<_>, _>>()?;
    report(
        options,
        &file,
        (list.active(), hits(&answers)),
        (build_ms, &speeds),
    )
}

fn hits(answers: &Answers) -> usize {
    match answers {
        Answers::Closest(hits) => hits.iter().flatten().count(),
        Answers::Any(hits) => hits.iter().filter(|hit| **hit).count(),
    }
}

fn report(
    options: &RaceOptions,
    file: &RayFile,
    (active, hits): (usize, usize),
    (build_ms, speeds): (f64, &[RaySpeed]),
) -> Result<(), CliError> {
    let query = match file.query {
        RayQuery::Closest => "closest",
        RayQuery::Any => "any",
    };
    let (triangles, kind) = (file.mesh.len(), &file.kind);
    let table: Map<String, Value> = speeds
        .iter()
        .map(|s| {
            let speed = json!({"best": s.best, "median": s.median});
            (s.threads.to_string(), speed)
        })
        .collect();
    let mut report = Report::new(options.json);
    report.machine(json!({
        "file": options.rays.to_string_lossy(),
        "kind": kind,
        "query": query,
        "triangles": triangles,
        "places": file.rays.len(),
        "rays": active,
        "hits": hits,
        "passes": options.passes,
        "build_ms": build_ms,
        "mrays_per_s": table,
    }))?;
    if !options.json {
        let mut text = format!(
            "{}: {kind}, {query}: {triangles} triangles, tree built in {build_ms:.1} ms, {active} rays, {hits} hits\n",
            options.rays.display()
        );
        for s in speeds {
            text += &format!(
                "{:3} threads {:8.2} million rays a second (best {:.2})\n",
                s.threads, s.median, s.best
            );
        }
        crate::cli::output::answer(&text)?;
    }
    report.finish()
}
