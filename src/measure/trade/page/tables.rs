//! Tables of the page.

use super::super::plots::{front, usual_cells};
use super::super::{Cell, Record, short};
use super::{escaped, heading, push};

/// Error of a texture coordinate that counts as none, texels.
const TEXEL: f64 = 1.0;
/// FLIP that nobody sees.
const ALIKE: f64 = 0.05;

/// The cheapest variant that is right to a texel, and the cheapest that looks right, for every view.
pub(super) fn cheapest(html: &mut String, record: &Record) {
    heading(html, "cheapest");
    push(
        html,
        "<div class=\"wide\"><table><tr><th rowspan=\"2\">view</th><th rowspan=\"2\">amplitude</th>\
         <th colspan=\"3\">right to a texel (uv p95 ≤ 1)</th><th colspan=\"3\">looks like the truth (FLIP ≤ 0.05)</th></tr>\
         <tr><th class=\"word\">method</th><th>uv p95, texels</th><th>ns per sample</th>\
         <th class=\"word\">method</th><th>FLIP</th><th>ns per sample</th></tr>",
    );
    for view in &record.views {
        let bits = record.subject.map_bits;
        let cells = record
            .cells
            .iter()
            .filter(|c| c.view == view.index && c.bits == bits);
        let least = |is_enough: &dyn Fn(&Cell) -> bool| {
            let enough = cells.clone().filter(|c| is_enough(c));
            enough.min_by(|a, b| time(a).total_cmp(&time(b)))
        };
        let right = least(&|c| c.geometry.uv_texels.p95 <= TEXEL && !c.variant.is_bare());
        let alike = least(&|c| c.picture.flip <= ALIKE);
        let three = |cell: Option<&Cell>, error: &dyn Fn(&Cell) -> f64| match cell {
            Some(c) => format!(
                "<td class=\"word\">{}</td><td>{}</td><td>{:.0}</td>",
                c.variant.label(),
                decimals(error(c)),
                time(c)
            ),
            None => "<td class=\"word\">none</td><td></td><td></td>".to_owned(),
        };
        push(
            html,
            &format!(
                "<tr><td>{:.0}°</td><td>×{}</td>{}{}</tr>",
                view.angle_deg,
                short(view.amplitude),
                three(right, &|c| c.geometry.uv_texels.p95),
                three(alike, &|c| c.picture.flip),
            ),
        );
    }
    push(html, "</table></div>");
}

fn time(cell: &Cell) -> f64 {
    cell.cost.ns_per_sample.median
}

/// Three decimals, so that a column lines up.
fn decimals(value: f64) -> String {
    format!("{value:.3}")
}

/// Milliseconds: decimals only where they say something.
fn millis(ms: f64) -> String {
    if ms < 100.0 {
        format!("{ms:.1}")
    } else {
        format!("{ms:.0}")
    }
}

/// Every figure of the usual cells, a table an angle.
pub(super) fn all_methods(html: &mut String, record: &Record) {
    heading(html, "tables");
    push(
        html,
        "<p><small>Amplitude and bits of the map's own. Two figures with a stroke: median and 95th percentile. \
         Green: no other method is both cheaper and nearer in texels. &lt; and &gt;: nearer than this, which is ten times what halves of the samples differ by, or less than 8 bits show. \
         In brackets: the fastest and the slowest frame.</small></p>",
    );
    let cells = usual_cells(record);
    let mut angles: Vec<f64> = cells.iter().map(|c| c.angle_deg).collect();
    angles.dedup();
    for angle in angles {
        let of_view = cells.iter().copied().filter(|c| c.angle_deg == angle);
        let cells: Vec<_> = of_view.collect();
        push(html, &format!("<h3>{angle:.0}°</h3>"));
        push(
            html,
            "<div class=\"wide\"><table><tr><th class=\"word\">method</th><th>uv, texels</th><th>above<br>1 texel</th>\
             <th>depth / A</th><th>normal, °</th><th>shadows<br>that differ</th><th>RMSE</th><th>PSNR, dB</th><th>SSIM</th>\
             <th>FLIP</th><th>look-ups<br>+ steps</th><th>rays</th><th>ns per sample</th><th>1080p, ms</th></tr>",
        );
        let place = |c: &&Cell| [time(c), c.geometry.uv_texels.p95];
        let front = front(&cells.iter().map(place).collect::<Vec<_>>());
        for (i, cell) in cells.iter().enumerate() {
            push(html, &row(cell, front.contains(&i)));
        }
        push(html, "</table></div>");
    }
}

fn row(cell: &Cell, is_front: bool) -> String {
    let (g, p, c) = (&cell.geometry, &cell.picture, &cell.cost);
    // Less-than signs that are no markup.
    let [rmse, psnr, ssim, flip] = p
        .told(&cell.picture_doubt)
        .map(|told| told.replace('<', "&lt;"));
    let shadows = g
        .shadow_disagreement
        .map_or_else(|| "–".to_owned(), |s| format!("{:.1} %", s * 100.0));
    let class = if is_front { " class=\"front\"" } else { "" };
    format!(
        "<tr{class}><td class=\"word\">{}</td><td>{}</td><td>{:.1} %</td><td>{}</td><td>{}</td><td>{shadows}</td><td>{rmse}</td><td>{psnr}</td><td>{ssim}</td><td>{flip}</td><td>{:.1} + {:.1}</td><td>{:.2}</td><td>{:.0} ({:.0}–{:.0})</td><td>{}</td></tr>",
        cell.variant.label(),
        g.uv_texels.short(),
        g.wrong_texel_share * 100.0,
        g.depth.short(),
        g.normal_deg.short(),
        c.look_ups,
        c.steps,
        c.rays,
        c.ns_per_sample.median,
        c.ns_per_sample.min,
        c.ns_per_sample.max,
        millis(c.full_hd_ms),
    )
}

/// What searches need before the first picture.
pub(super) fn made_beforehand(html: &mut String, record: &Record) {
    if record.precompute.is_empty() {
        return;
    }
    push(
        html,
        "<h3>Made beforehand, once per map</h3><table><tr><th class=\"word\">what</th><th>ms</th><th>KiB</th></tr>",
    );
    for made in &record.precompute {
        let kib = made.bytes as f64 / 1024.0;
        push(
            html,
            &format!(
                "<tr><td class=\"word\">{}</td><td>{}</td><td>{kib:.0}</td></tr>",
                escaped(&made.what),
                millis(made.ms)
            ),
        );
    }
    push(html, "</table>");
}
