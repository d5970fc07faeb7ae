//! What `measure` prints.

use std::fmt::Write as _;

use crate::measure::trade::{Cell, Record, ViewFacts};

/// The cells of the material's own amplitude and bits, view by view; then notes and advice.
pub(super) fn summary(record: &Record) -> String {
    let mut text = String::new();
    let s = &record.subject;
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "{}: {}, {} of {}x{} texels and {} bits, amplitude {}",
        s.input, s.material, s.height_map, s.map_size[0], s.map_size[1], s.map_bits, s.amplitude
    );
    let _ = writeln!(text, "truth: {}", record.truth);
    for m in &record.machines {
        let cpu = m.cpu.as_deref().unwrap_or("a processor without a name");
        let _ = writeln!(
            text,
            "reliefscope {} on {cpu}, {} cores, {} threads, {}",
            m.version, m.cores, m.threads, m.level
        );
    }
    let usual = record.usual_amplitude();
    for view in record.views.iter().filter(|v| v.amplitude == usual) {
        view_table(&mut text, record, view);
    }
    for made in &record.precompute {
        let kib = made.bytes as f64 / 1024.0;
        let _ = writeln!(text, "{}: {:.1} ms, {kib:.0} KiB", made.what, made.ms);
    }
    text.push('\n');
    for note in record.notes() {
        let _ = writeln!(text, "note: {note}");
    }
    for advice in record.advice() {
        let _ = writeln!(text, "{}", advice.line);
    }
    text
}

fn view_table(text: &mut String, record: &Record, view: &ViewFacts) {
    let _ = writeln!(
        text,
        "\n{:.0} degrees, {} rays; < and > stand before ten times what halves of the samples differ by",
        view.angle_deg, view.rays
    );
    let _ = writeln!(
        text,
        "  {:<28}{:>9}{:>9}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8} {:>9}{:>9}",
        "method",
        "uv p50",
        "uv p95",
        ">1 tx",
        "n p95",
        "shadow",
        "PSNR",
        "SSIM",
        "FLIP",
        "looks",
        "ns"
    );
    let bits = record.subject.map_bits;
    let own = |c: &&Cell| c.view == view.index && c.bits == bits;
    for cell in record.cells.iter().filter(own) {
        let _ = writeln!(text, "{}", line(cell));
    }
}

fn line(cell: &Cell) -> String {
    let g = &cell.geometry;
    let [_, psnr, ssim, flip] = cell.picture.told(&cell.picture_doubt);
    let percent = |share: f64| format!("{:.1}%", share * 100.0);
    format!(
        "  {:<28}{:>9.3}{:>9.3}{:>8}{:>8.2}{:>8}{psnr:>8}{ssim:>8}{flip:>8} {:>9.1}{:>9.0}",
        cell.variant.label(),
        g.uv_texels.p50,
        g.uv_texels.p95,
        percent(g.wrong_texel_share),
        g.normal_deg.p95,
        g.shadow_disagreement
            .map_or_else(|| "-".to_owned(), percent),
        cell.cost.look_ups + cell.cost.steps,
        cell.cost.ns_per_sample.median,
    )
}
