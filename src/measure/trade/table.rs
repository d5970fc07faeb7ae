//! The cells as a table of comma-separated values, a line each.

use super::{Cell, Record, Stats};

/// Name and content of a column.
type Column = (&'static str, fn(&Cell) -> String);

fn number(value: f64) -> String {
    format!("{value}")
}

fn maybe(value: Option<f64>) -> String {
    value.map_or_else(String::new, number)
}

/// Every column: units are in the names.
const COLUMNS: [Column; 46] = [
    ("view", |c| c.view.to_string()),
    ("angle_deg", |c| number(c.angle_deg)),
    ("amplitude_factor", |c| number(c.amplitude)),
    ("bits", |c| c.bits.to_string()),
    ("method", |c| c.variant.method.name().to_owned()),
    ("steps", |c| {
        c.variant.steps.map_or_else(String::new, |n| n.to_string())
    }),
    ("self_shadow", |c| c.variant.self_shadow.to_string()),
    ("uv_rms_texels", |c| number(c.geometry.uv_texels.rms)),
    ("uv_p50_texels", |c| number(c.geometry.uv_texels.p50)),
    ("uv_p95_texels", |c| number(c.geometry.uv_texels.p95)),
    ("uv_share_above_1_texel", |c| {
        number(c.geometry.wrong_texel_share)
    }),
    ("depth_rms_over_amplitude", |c| number(c.geometry.depth.rms)),
    ("depth_p50_over_amplitude", |c| number(c.geometry.depth.p50)),
    ("depth_p95_over_amplitude", |c| number(c.geometry.depth.p95)),
    ("normal_rms_deg", |c| number(c.geometry.normal_deg.rms)),
    ("normal_p50_deg", |c| number(c.geometry.normal_deg.p50)),
    ("normal_p95_deg", |c| number(c.geometry.normal_deg.p95)),
    ("silhouette_iou", |c| maybe(c.geometry.silhouette_iou)),
    ("shadow_disagreement", |c| {
        maybe(c.geometry.shadow_disagreement)
    }),
    ("samples_per_pixel", |c| c.samples.to_string()),
    ("linear_rmse", |c| number(c.picture.linear_rmse)),
    ("psnr_db", |c| maybe(c.picture.psnr_db)),
    ("ssim", |c| number(c.picture.ssim)),
    ("flip", |c| number(c.picture.flip)),
    ("linear_rmse_doubt", |c| number(c.picture_doubt.linear_rmse)),
    ("psnr_db_doubt", |c| number(c.picture_doubt.psnr_db)),
    ("ssim_doubt", |c| number(c.picture_doubt.ssim)),
    ("flip_doubt", |c| number(c.picture_doubt.flip)),
    ("limited_by_noise", |c| c.limited_by_noise.to_string()),
    ("look_ups_per_sample", |c| number(c.cost.look_ups)),
    ("steps_per_sample", |c| number(c.cost.steps)),
    ("rays_per_sample", |c| number(c.cost.rays)),
    ("shadow_walks_per_sample", |c| number(c.cost.shadow_walks)),
    ("ns_per_sample", |c| number(c.cost.ns_per_sample.median)),
    ("ns_per_sample_min", |c| number(c.cost.ns_per_sample.min)),
    ("ns_per_sample_max", |c| number(c.cost.ns_per_sample.max)),
    ("frame_ms", |c| number(c.cost.frame_ms.median)),
    ("frame_ms_min", |c| number(c.cost.frame_ms.min)),
    ("frame_ms_max", |c| number(c.cost.frame_ms.max)),
    ("frame_1080p_ms", |c| number(c.cost.full_hd_ms)),
    ("flip_1_sample", |c| followed(c, 0)),
    ("flip_2_samples", |c| followed(c, 1)),
    ("flip_4_samples", |c| followed(c, 2)),
    ("flip_8_samples", |c| followed(c, 3)),
    ("flip_16_samples", |c| followed(c, 4)),
    ("flip_32_samples", |c| followed(c, 5)),
];

fn followed(cell: &Cell, power: usize) -> String {
    maybe(cell.flip_by_samples.get(power).copied())
}

/// The cells of a record with a line of names on top. Numbers read back to the bit.
#[must_use]
pub fn csv_table(record: &Record) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut rows = vec![COLUMNS.map(|(name, _)| name.to_owned())];
    rows.extend(
        record
            .cells
            .iter()
            .map(|cell| COLUMNS.map(|(_, f)| f(cell))),
    );
    for row in rows {
        // All rows are of one length and memory does not refuse.
        let _ = writer.write_record(row);
    }
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8(bytes).unwrap_or_default()
}

impl Stats {
    /// `p50 / p95`, for tables.
    #[must_use]
    pub fn short(&self) -> String {
        format!("{} / {}", super::short(self.p50), super::short(self.p95))
    }
}
