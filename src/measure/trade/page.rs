//! A record as one HTML page that needs nothing else.

use std::fmt::Write as _;

use base64::Engine as _;

use super::plots::{self, PlotMetric, nearest_angle, usual_cells};
use super::{Cell, Record, csv_table, short};
use crate::math::srgb8_from_linear;
use crate::render::Picture;
use crate::scene::save_picture::png_bytes;

/// Angles of the fronts and of the tables, degrees.
const ANGLES: [f64; 3] = [30.0, 60.0, 80.0];

/// A view in which less than one in so many rays shows a relief is told.
const FEW: usize = 20;

const STYLE: &str = "\
body{font:15px/1.5 system-ui,sans-serif;max-width:1320px;margin:2em auto;padding:0 1.2em;color:#22262e;background:#f6f7f9}
h1{font-size:1.6em;margin-bottom:.2em}h2{margin-top:1.8em;border-bottom:1px solid #d5d9e0}
table{border-collapse:collapse;background:#fff;font-variant-numeric:tabular-nums;margin:.6em 0}
th,td{border:1px solid #dde1e7;padding:.22em .6em;text-align:right}th{background:#eef0f4}
td:first-child,th:first-child{text-align:left}tr.front td{background:#eefaee}
.note{background:#fff6dd;border-left:4px solid #d9a400;padding:.5em .9em;margin:.5em 0}
.advice{background:#e9f4ff;border-left:4px solid #2474c0;padding:.5em .9em;margin:.5em 0}
.plots{display:flex;flex-wrap:wrap;gap:14px}.plots svg{background:#fff;border:1px solid #dde1e7}
figure{display:inline-block;margin:.3em}figcaption{font-size:.85em}img{display:block;image-rendering:pixelated;max-width:420px}
code{background:#eceff3;padding:.1em .3em}small{color:#5b6270}";

/// The page: advice, verdicts, charts, tables, pictures, and how to repeat it.
#[must_use]
pub fn page(record: &Record) -> String {
    let mut html = String::new();
    let title = format!("What accuracy costs on {}", record.subject.input);
    push(
        &mut html,
        "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\">",
    );
    push(
        &mut html,
        &format!("<title>{}</title><style>{STYLE}</style>", escaped(&title)),
    );
    push(&mut html, &format!("<h1>{}</h1>", escaped(&title)));
    facts(&mut html, record);
    notes(&mut html, record);
    advice(&mut html, record);
    verdicts(&mut html, record);
    charts(&mut html, record);
    tables(&mut html, record);
    costs_of_preparation(&mut html, record);
    pictures(&mut html, record);
    all_cells(&mut html, record);
    push(&mut html, "</html>");
    html
}

fn push(html: &mut String, line: &str) {
    html.push_str(line);
    html.push('\n');
}

/// Text as HTML shows it.
fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

fn facts(html: &mut String, record: &Record) {
    let s = &record.subject;
    let line = format!(
        "Material {} of {} triangles, height map {} of {}×{} texels and {} bits, amplitude {} world units; the scene's own camera sees it at {:.0}°.",
        s.material,
        s.triangles,
        s.height_map,
        s.map_size[0],
        s.map_size[1],
        s.map_bits,
        short(s.amplitude),
        s.own_angle_deg
    );
    push(html, &format!("<p>{}</p>", escaped(&line)));
    let plan = &record.plan;
    let line = format!(
        "Truth: {}. {} cells from {} views; {} view rays a view; pictures of {}×{} at {} samples a pixel against a reference of {}; frames of {}×{} timed {} times in turns; seed {}.",
        record.truth,
        record.cells.len(),
        record.views.len(),
        plan.rays,
        plan.size[0],
        plan.size[1],
        plan.samples,
        2 * plan.samples,
        plan.timed_size[0],
        plan.timed_size[1],
        plan.rounds,
        plan.seed
    );
    push(html, &format!("<p>{}</p>", escaped(&line)));
    for m in &record.machines {
        let commit = m
            .commit
            .as_deref()
            .map(|c| format!(", {c}"))
            .unwrap_or_default();
        let line = format!(
            "reliefscope {}{commit} on {}, {} cores, {} threads used, {}",
            m.version,
            m.cpu.as_deref().unwrap_or("a processor without a name"),
            m.cores,
            m.threads,
            m.level
        );
        push(html, &format!("<p><small>{}</small></p>", escaped(&line)));
    }
    push(
        html,
        &format!(
            "<p>Repeat it: <code>{}</code></p>",
            escaped(&record.command)
        ),
    );
}

fn notes(html: &mut String, record: &Record) {
    for note in record.notes() {
        push(html, &format!("<p class=\"note\">{}</p>", escaped(&note)));
    }
}

fn advice(html: &mut String, record: &Record) {
    push(html, "<h2>Advice</h2>");
    for advice in record.advice() {
        push(
            html,
            &format!("<p class=\"advice\">{}</p>", escaped(&advice.line)),
        );
    }
}

/// The cheapest variant that is right to a texel, for every view.
fn verdicts(html: &mut String, record: &Record) {
    push(html, "<h2>Cheapest with p95 ≤ 1 texel</h2>");
    push(
        html,
        "<table><tr><th>view</th><th>amplitude</th><th>method</th><th>p95, texels</th><th>ns per sample</th><th>looks like the truth (FLIP ≤ 0.05)</th></tr>",
    );
    for view in &record.views {
        let bits = record.subject.map_bits;
        let cells = record
            .cells
            .iter()
            .filter(|c| c.view == view.index && c.bits == bits);
        let cheapest = |is_enough: &dyn Fn(&Cell) -> bool| {
            let enough = cells.clone().filter(|c| is_enough(c));
            enough.min_by(|a, b| {
                a.cost
                    .ns_per_sample
                    .median
                    .total_cmp(&b.cost.ns_per_sample.median)
            })
        };
        let right = cheapest(&|c| c.geometry.uv_texels.p95 <= 1.0 && !c.variant.is_bare());
        let alike = cheapest(&|c| c.picture.flip <= 0.05);
        let name = |c: Option<&Cell>| c.map_or_else(|| "none".to_owned(), |c| c.variant.label());
        let number = |f: &dyn Fn(&Cell) -> f64| right.map_or_else(String::new, |c| short(f(c)));
        push(
            html,
            &format!(
                "<tr><td>{:.0}°</td><td>×{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
                view.angle_deg,
                short(view.amplitude),
                name(right),
                number(&|c| c.geometry.uv_texels.p95),
                number(&|c| c.cost.ns_per_sample.median),
                name(alike),
            ),
        );
    }
    push(html, "</table>");
}

fn charts(html: &mut String, record: &Record) {
    push(html, "<h2>Charts</h2><div class=\"plots\">");
    let mut fronts = Vec::new();
    for wanted in ANGLES {
        let angle = nearest_angle(&usual_cells(record), wanted);
        if let Some(angle) = angle.filter(|a| !fronts.contains(a)) {
            fronts.push(angle);
        }
    }
    let mut drawings = Vec::new();
    for metric in [PlotMetric::Texels, PlotMetric::Flip] {
        drawings.extend(
            fronts
                .iter()
                .map(|&a| plots::error_by_cost(record, a, metric)),
        );
    }
    drawings.extend(PlotMetric::ALL.map(|metric| plots::error_by_angle(record, metric)));
    if record.plan.amplitudes.len() > 1 {
        drawings.push(plots::error_by_amplitude(record, 60.0, PlotMetric::Texels));
        drawings.push(plots::error_by_amplitude(record, 60.0, PlotMetric::Flip));
    }
    drawings.push(plots::error_by_steps(record, 60.0, PlotMetric::Texels));
    drawings.push(plots::quality_by_time(record, 60.0));
    for drawing in drawings {
        push(html, &drawing.to_svg());
    }
    push(html, "</div>");
}

fn tables(html: &mut String, record: &Record) {
    let cells = usual_cells(record);
    let mut angles: Vec<f64> = cells.iter().map(|c| c.angle_deg).collect();
    angles.dedup();
    for angle in angles {
        let cells: Vec<_> = cells
            .iter()
            .copied()
            .filter(|c| c.angle_deg == angle)
            .collect();
        push(html, &format!("<h2>All methods at {angle:.0}°</h2>"));
        push(
            html,
            "<table><tr><th>method</th><th>uv, texels<br>p50 / p95</th><th>above 1 texel</th><th>depth / A<br>p50 / p95</th><th>normal, °<br>p50 / p95</th><th>shadows that differ</th><th>RMSE</th><th>PSNR, dB</th><th>SSIM</th><th>FLIP</th><th>look-ups + steps</th><th>rays</th><th>ns per sample</th><th>1080p, ms</th></tr>",
        );
        let place = |c: &&Cell| [c.cost.ns_per_sample.median, c.geometry.uv_texels.p95];
        let front = plots::front(&cells.iter().map(place).collect::<Vec<_>>());
        for (i, cell) in cells.iter().enumerate() {
            push(html, &row(cell, front.contains(&i)));
        }
        push(html, "</table>");
    }
    push(
        html,
        "<p><small>Green: no other method is both cheaper and nearer in texels. *: less than ten times the reference's own error.</small></p>",
    );
}

fn row(cell: &Cell, is_front: bool) -> String {
    let (g, p, c) = (&cell.geometry, &cell.picture, &cell.cost);
    let mark = if cell.limited_by_noise { "*" } else { "" };
    let psnr = p
        .psnr_db
        .map_or_else(|| "∞".to_owned(), |db| format!("{db:.1}"));
    let shadows = g
        .shadow_disagreement
        .map_or_else(|| "–".to_owned(), |s| format!("{:.1} %", s * 100.0));
    let class = if is_front { " class=\"front\"" } else { "" };
    format!(
        "<tr{class}><td>{}</td><td>{}</td><td>{:.1} %</td><td>{}</td><td>{}</td><td>{shadows}</td><td>{}{mark}</td><td>{psnr}</td><td>{:.3}</td><td>{}{mark}</td><td>{:.1} + {:.1}</td><td>{:.2}</td><td>{:.0} ({:.0}–{:.0})</td><td>{:.1}</td></tr>",
        cell.variant.label(),
        g.uv_texels.short(),
        g.wrong_texel_share * 100.0,
        g.depth.short(),
        g.normal_deg.short(),
        short(p.linear_rmse),
        p.ssim,
        short(p.flip),
        c.look_ups,
        c.steps,
        c.rays,
        c.ns_per_sample.median,
        c.ns_per_sample.min,
        c.ns_per_sample.max,
        c.full_hd_ms,
    )
}

fn costs_of_preparation(html: &mut String, record: &Record) {
    if record.precompute.is_empty() {
        return;
    }
    push(
        html,
        "<h2>Made beforehand, once per map</h2><table><tr><th>what</th><th>ms</th><th>KiB</th></tr>",
    );
    for made in &record.precompute {
        let kib = made.bytes as f64 / 1024.0;
        push(
            html,
            &format!(
                "<tr><td>{}</td><td>{:.1}</td><td>{kib:.0}</td></tr>",
                escaped(&made.what),
                made.ms
            ),
        );
    }
    push(html, "</table>");
}

fn pictures(html: &mut String, record: &Record) {
    if record.pictures.is_empty() {
        return;
    }
    push(
        html,
        "<h2>Pictures, and where they differ from the truth</h2><p><small>Right of each picture its FLIP: black none, red 1/3, yellow 2/3, white 1.</small></p>",
    );
    for view in &record.views {
        let mut shown = record
            .pictures
            .iter()
            .filter(|p| p.view == view.index)
            .peekable();
        if shown.peek().is_some() {
            push(html, &format!("<h3>{:.0}°</h3>", view.angle_deg));
        }
        for thumbnail in shown {
            let image = |data: &str| {
                if data.is_empty() {
                    String::new()
                } else {
                    format!("<img alt=\"\" src=\"data:image/png;base64,{data}\">")
                }
            };
            push(
                html,
                &format!(
                    "<figure><div style=\"display:flex\">{}{}</div><figcaption>{}</figcaption></figure>",
                    image(&thumbnail.picture),
                    image(&thumbnail.error),
                    escaped(&thumbnail.label)
                ),
            );
        }
    }
}

/// Everything, for programs and for the curious.
fn all_cells(html: &mut String, record: &Record) {
    let _ = writeln!(
        html,
        "<h2>Every figure</h2><details><summary>{} cells as comma-separated values</summary><pre>{}</pre></details>",
        record.cells.len(),
        escaped(&csv_table(record))
    );
}

/// A picture as the screen shows it, and its errors in false colours: PNGs in base64.
#[must_use]
pub fn thumbnail(picture: &Picture, errors: Option<&[f32]>) -> (Option<String>, Option<String>) {
    let size = [picture.width, picture.height];
    let shown: Vec<_> = picture
        .pixels
        .iter()
        .map(|&c| srgb8_from_linear(c))
        .collect();
    let colored = errors.map(|e| e.iter().map(|&e| heat(e)).collect::<Vec<_>>());
    let encoded = |pixels: &[[u8; 3]]| {
        let bytes = png_bytes(size, pixels)?;
        Some(base64::engine::general_purpose::STANDARD.encode(bytes))
    };
    (encoded(&shown), colored.and_then(|pixels| encoded(&pixels)))
}

/// From black by red and yellow to white.
fn heat(error: f32) -> [u8; 3] {
    let part = |start: f32| ((error * 3.0 - start).clamp(0.0, 1.0) * 255.0).round() as u8;
    [part(0.0), part(1.0), part(2.0)]
}

impl Record {
    /// What a reader must know before trusting the figures, a sentence each.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.partial {
            notes.push("This is a part: the sweep was stopped, or shards are missing.".to_owned());
        }
        if let Some(shard) = self.shard {
            notes.push(format!("This is shard {} of {}.", shard.index, shard.count));
        }
        let noisy = self.noisy_share();
        if self.is_noisy() {
            notes.push(format!(
                "The machine was noisy: {:.0} % of the times spread by more than {:.0} % of their median. Trust the counts of look-ups, steps and rays before the times.",
                noisy * 100.0,
                Self::NOISY * 100.0
            ));
        }
        let limited = self.cells.iter().filter(|c| c.limited_by_noise).count();
        if limited > 0 {
            notes.push(format!(
                "The pictures of {limited} of {} cells differ from the reference by less than ten times what its own halves do; their figures say “at most”.",
                self.cells.len()
            ));
        }
        let few = |v: &&super::ViewFacts| v.rays < self.plan.rays as usize / FEW;
        notes.extend(self.views.iter().filter(few).map(|view| {
            format!(
                "At {:.0}° only {} of {} view rays show a relief from its front.",
                view.angle_deg, view.rays, self.plan.rays
            )
        }));
        notes.extend(
            self.left_out
                .iter()
                .map(|what| format!("Not measured: {what}.")),
        );
        notes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::LinearRgb;

    #[test]
    fn heat_goes_from_black_to_white() {
        assert_eq!(heat(0.0), [0, 0, 0]);
        assert_eq!(heat(1.0 / 3.0), [255, 0, 0]);
        assert_eq!(heat(1.0), [255, 255, 255]);
        assert_eq!(heat(f32::NAN), [0, 0, 0]);
    }

    #[test]
    fn thumbnails_are_png() {
        let picture = Picture {
            width: 1,
            height: 1,
            pixels: vec![LinearRgb::gray(1.0)],
        };
        let (shown, error) = thumbnail(&picture, Some(&[0.5]));
        // The signature of PNG in base64.
        assert!(shown.is_some_and(|s| s.starts_with("iVBORw0KGgo")));
        assert!(error.is_some_and(|s| s.starts_with("iVBORw0KGgo")));
        assert_eq!(escaped("a<b>&\"c\""), "a&lt;b&gt;&amp;&quot;c&quot;");
    }
}
