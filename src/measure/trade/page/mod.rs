//! A record as one HTML page that needs nothing else.
//!
//! - here: what was measured, what to know before trusting it, advice, charts
//! - `tables`: the cheapest method for each view, all figures of the usual cells, what is made beforehand
//! - `thumbnails`: pictures and their errors

mod tables;
mod thumbnails;

use std::fmt::Write as _;

use super::plots::{self, PlotMetric, nearest_angle, usual_cells};
use super::{Record, csv_table, short};

pub(super) use thumbnails::thumbnail;

/// Angles of the fronts, degrees.
const ANGLES: [f64; 3] = [30.0, 60.0, 80.0];

const STYLE: &str = include_str!("style.css");

/// Sections that the page's first line leads to: mark and name.
const SECTIONS: [[&str; 2]; 5] = [
    ["cheapest", "Cheapest for each view"],
    ["charts", "Charts"],
    ["tables", "All methods"],
    ["pictures", "Pictures"],
    ["everything", "Every figure"],
];

/// The page: advice, verdicts, charts, tables, pictures, and how to repeat it.
#[must_use]
pub fn page(record: &Record) -> String {
    let mut html = String::new();
    let title = escaped(&format!("What accuracy costs on {}", record.subject.input));
    push(
        &mut html,
        "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width\">",
    );
    push(
        &mut html,
        &format!("<title>{title}</title><style>{STYLE}</style>"),
    );
    push(&mut html, &format!("<h1>{title}</h1>"));
    navigation(&mut html, record);
    facts(&mut html, record);
    for note in record.notes() {
        push(
            &mut html,
            &format!("<p class=\"note\">{}</p>", prose(&note)),
        );
    }
    push(&mut html, "<h2>Advice</h2>");
    for advice in record.advice() {
        let line = prose(&sentence(&advice.line));
        push(&mut html, &format!("<p class=\"advice\">{line}</p>"));
    }
    tables::cheapest(&mut html, record);
    charts(&mut html, record);
    tables::all_methods(&mut html, record);
    tables::made_beforehand(&mut html, record);
    thumbnails::pictures(&mut html, record);
    all_cells(&mut html, record);
    push(&mut html, "</html>");
    html
}

fn push(html: &mut String, line: &str) {
    html.push_str(line);
    html.push('\n');
}

/// The heading of a section of [`SECTIONS`].
fn heading(html: &mut String, mark: &str) {
    let section = SECTIONS.iter().find(|[m, _]| *m == mark);
    let name = section.map_or(mark, |[_, name]| name);
    push(html, &format!("<h2 id=\"{mark}\">{name}</h2>"));
}

/// Text as HTML shows it.
fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

/// [`escaped`], with what stands between back quotes as code.
fn prose(text: &str) -> String {
    let mut html = String::new();
    for (i, part) in text.split('`').enumerate() {
        let part = escaped(part);
        if i % 2 == 1 {
            let _ = write!(html, "<code>{part}</code>");
        } else {
            html.push_str(&part);
        }
    }
    html
}

/// With a capital letter and a full stop.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first: String = letters
        .next()
        .map_or_else(String::new, |c| c.to_uppercase().collect());
    format!("{first}{}.", letters.as_str())
}

fn navigation(html: &mut String, record: &Record) {
    let sections = SECTIONS
        .iter()
        .filter(|[mark, _]| *mark != "pictures" || !record.pictures.is_empty());
    let links = sections.map(|[mark, name]| format!("<a href=\"#{mark}\">{name}</a>"));
    push(html, &format!("<nav>{}</nav>", links.collect::<String>()));
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
    push(html, &format!("<p>{}</p>", prose(&line)));
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

fn charts(html: &mut String, record: &Record) {
    heading(html, "charts");
    push(html, "<div class=\"plots\">");
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

/// Everything, for programs and for the curious.
fn all_cells(html: &mut String, record: &Record) {
    heading(html, "everything");
    let _ = writeln!(
        html,
        "<details><summary>{} cells as comma-separated values</summary><pre>{}</pre></details>",
        record.cells.len(),
        escaped(&csv_table(record))
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_become_html() {
        assert_eq!(escaped("a<b>&\"c\""), "a&lt;b&gt;&amp;&quot;c&quot;");
        assert_eq!(prose("by `a<b`."), "by <code>a&lt;b</code>.");
        assert_eq!(sentence("to look"), "To look.");
        assert_eq!(sentence(""), ".");
    }
}
