//! What comes out of a sweep: plain numbers that files hold.

use serde::{Deserialize, Serialize};

use super::{PictureDoubt, Plan, Shard, Variant};
use crate::measure::bench::Spread;

/// Changes whenever a file of an older program would be misread.
pub const FORMAT: u32 = 3;

/// A sweep, or a part of one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// [`FORMAT`].
    pub format: u32,
    /// What was measured.
    pub subject: SubjectFacts,
    /// What was asked.
    pub plan: Plan,
    /// The part of the plan that this is; `None` for all of it.
    pub shard: Option<Shard>,
    /// What errors are measured against, in words.
    pub truth: String,
    /// The command that repeats it.
    pub command: String,
    /// What the times were taken on; one entry for each machine.
    pub machines: Vec<MachineFacts>,
    /// Whether cells of the plan (or of its shard) are missing.
    pub partial: bool,
    /// What was not measured, and why.
    pub left_out: Vec<String>,
    /// What searches need beside the height map.
    pub precompute: Vec<Precompute>,
    /// The views, in order.
    pub views: Vec<ViewFacts>,
    /// The figures, in order of the plan.
    pub cells: Vec<Cell>,
    /// Pictures for the page, few.
    pub pictures: Vec<Thumbnail>,
}

/// What was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SubjectFacts {
    /// As the user named it.
    pub input: String,
    /// Triangles of the model.
    pub triangles: usize,
    /// Material in the middle of the picture.
    pub material: String,
    /// Its height map.
    pub height_map: String,
    /// Columns and rows of it.
    pub map_size: [u32; 2],
    /// Bits of it.
    pub map_bits: u8,
    /// Its amplitude, world units.
    pub amplitude: f64,
    /// Angle at which the scene's own camera sees it, degrees.
    pub own_angle_deg: f64,
}

/// What times were taken on, and with which program.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct MachineFacts {
    /// The processor's own name, where the system tells it.
    pub cpu: Option<String>,
    /// Threads that it runs at once.
    pub cores: usize,
    /// Worker threads that were used.
    pub threads: usize,
    /// Vector instructions.
    pub level: String,
    /// Version of the program.
    pub version: String,
    /// Its commit, if it knows.
    pub commit: Option<String>,
}

/// What a search needs to have ready.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Precompute {
    /// In words.
    pub what: String,
    /// Time to make it, ms.
    pub ms: f64,
    /// Heap bytes it takes.
    pub bytes: usize,
}

/// One view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ViewFacts {
    /// Its number in the plan.
    pub index: usize,
    /// Angle to the normal in the middle of the picture, degrees.
    pub angle_deg: f64,
    /// Factor on the amplitude.
    pub amplitude: f64,
    /// View rays that show a relief.
    pub rays: usize,
    /// 5 %, 50 % and 95 % of them are at most this far from the smooth normal, degrees.
    pub ray_angles_deg: [f64; 3],
    /// Share of the picture that the model covers, 0…1.
    pub covered: f64,
    /// Rounding of the geometric truth, texels, largest.
    pub truth_doubt_texels: f64,
    /// How far the halves of the reference picture are from the whole.
    pub reference_noise: PictureErrors,
}

/// One method by one parameter in one view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Number of the view in the plan.
    pub view: usize,
    /// Angle of the view, degrees.
    pub angle_deg: f64,
    /// Factor on the amplitude.
    pub amplitude: f64,
    /// Bits of the height map.
    pub bits: u8,
    /// Method and parameters.
    pub variant: Variant,
    /// Where rays land.
    pub geometry: GeometricErrors,
    /// Samples per pixel of the picture.
    pub samples: u32,
    /// How it looks, against that of the reference from the same samples.
    pub picture: PictureErrors,
    /// What these samples leave open about that.
    pub picture_doubt: PictureDoubt,
    /// Whether one of the picture's errors is less than ten times the doubt about it.
    pub limited_by_noise: bool,
    /// Mean FLIP of the picture after 1, 2, 4, … samples per pixel; empty where it was not followed.
    pub flip_by_samples: Vec<f64>,
    /// What it takes.
    pub cost: Cost,
}

/// Where rays land, against the truth.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct GeometricErrors {
    /// Distance of texture coordinates, texels of the height map.
    pub uv_texels: Stats,
    /// Share of rays that are more than a texel off, 0…1.
    pub wrong_texel_share: f64,
    /// Difference of displacement along the normal, over the amplitude.
    pub depth: Stats,
    /// Angle between shading normals, degrees.
    pub normal_deg: Stats,
    /// Intersection over union of the outlines; `None` if the truth keeps the mesh's outline.
    pub silhouette_iou: Option<f64>,
    /// Share of pairs of a ray and a light that are lit by one and not by the other, the mesh's own shadows left
    /// out; `None` without lights.
    pub shadow_disagreement: Option<f64>,
}

/// An error over many rays.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Stats {
    /// Root of the mean square.
    pub rms: f64,
    /// Half of the rays are not worse.
    pub p50: f64,
    /// 95 % of the rays are not worse.
    pub p95: f64,
}

/// How far two pictures are apart.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PictureErrors {
    /// Of linear values, over pixels and channels.
    pub linear_rmse: f64,
    /// Of clipped sRGB, decibels; `None` for equal pictures.
    pub psnr_db: Option<f64>,
    /// Structural similarity, 1 for equal pictures.
    pub ssim: f64,
    /// Mean FLIP, 0 for equal pictures.
    pub flip: f64,
}

/// Median and range.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Spread3 {
    /// The middle one.
    pub median: f64,
    /// The least.
    pub min: f64,
    /// The greatest.
    pub max: f64,
}

impl Spread3 {
    /// All three times a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self {
            median: self.median * factor,
            min: self.min * factor,
            max: self.max * factor,
        }
    }

    /// Range over median; 0 without times.
    #[must_use]
    pub fn relative_range(self) -> f64 {
        if self.median > 0.0 {
            (self.max - self.min) / self.median
        } else {
            0.0
        }
    }
}

impl From<Spread> for Spread3 {
    fn from(Spread { median, min, max }: Spread) -> Self {
        Self { median, min, max }
    }
}

/// What one sample of every pixel takes. Counts are exact and the same on every machine; times are not.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Cost {
    /// Look-ups in maps for each sample that the model covers, beside the steps.
    pub look_ups: f64,
    /// Height samples and pyramid nodes of searches and relief shadows, likewise.
    pub steps: f64,
    /// Rays of all kinds, likewise.
    pub rays: f64,
    /// Relief shadows asked for, likewise.
    pub shadow_walks: f64,
    /// Wall-clock time of a frame of the timed size, ms.
    pub frame_ms: Spread3,
    /// The same over the samples that the model covers, ns.
    pub ns_per_sample: Spread3,
    /// Median for a frame of 1920×1080 that looks the same, ms.
    pub full_hd_ms: f64,
}

/// A small picture on the page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Thumbnail {
    /// Number of the view.
    pub view: usize,
    /// Label of the variant, or `truth`.
    pub label: String,
    /// The picture, PNG in base64.
    pub picture: String,
    /// Its FLIP to the truth in false colours, PNG in base64; empty for the truth.
    pub error: String,
}

impl Record {
    /// Above this range over median a time says little.
    pub const NOISY: f64 = 0.25;

    /// Share of cells whose times spread by more than [`NOISY`](Self::NOISY).
    #[must_use]
    pub fn noisy_share(&self) -> f64 {
        let noisy = |cell: &&Cell| cell.cost.frame_ms.relative_range() > Self::NOISY;
        self.cells.iter().filter(noisy).count() as f64 / self.cells.len().max(1) as f64
    }

    /// Whether most times spread too much to be trusted.
    #[must_use]
    pub fn is_noisy(&self) -> bool {
        self.noisy_share() > 0.5
    }

    /// The errors alone, without anything that was timed: equal on all machines for equal plans.
    #[must_use]
    pub fn without_times(&self) -> Self {
        let mut record = self.clone();
        record.machines.clear();
        record.command.clear();
        for cell in &mut record.cells {
            cell.cost = cell.cost.without_times();
        }
        for made in &mut record.precompute {
            made.ms = 0.0;
        }
        record
    }
}

impl Cost {
    /// The counts alone.
    #[must_use]
    pub fn without_times(self) -> Self {
        Self {
            frame_ms: Spread3::default(),
            ns_per_sample: Spread3::default(),
            full_hd_ms: 0.0,
            ..self
        }
    }
}
