//! Heights or normals? And do a height map and a normal map tell the same relief?

use glam::Vec2;

use crate::texture::{Addressing, HeightMap, MapImage, MapRole, MapSlot, RawImage, Samples};

/// Texels looked at per picture axis: enough for stable means, few enough to cost nothing.
const MAX_PROBES: u32 = 256;

/// What a picture looks like, whatever the statement that names it says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    /// One channel, or three equal ones: heights.
    Grey,
    /// Tangent-space normals.
    Normals,
    /// Any other colours.
    Color,
}

/// Tells a normal map from heights and colours.
///
/// Normals: `2c − 1` has a mean length near 1, points outwards (z > 0) nearly everywhere, and blue is the
/// strongest channel on average. The length may be off by a quarter: averaging and JPEG shorten normals.
pub(super) fn look_of(image: &RawImage) -> Look {
    if !image.is_color() {
        return Look::Grey;
    }
    let mut count = 0.0;
    let mut sums = Sums::default();
    for (x, y) in probes(image.width, image.height) {
        let c = [0, 1, 2].map(|i| f64::from(image.fraction(x, y, i)));
        let n = c.map(|c| 2.0 * c - 1.0);
        let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        count += 1.0;
        sums.color_range += c[0].max(c[1]).max(c[2]) - c[0].min(c[1]).min(c[2]);
        sums.length += length;
        sums.length_error += (length - 1.0).abs();
        sums.outwards += f64::from(n[2] > 0.0);
        sums.blue_lead += c[2] - c[0].max(c[1]);
    }
    // JPEG leaves a few hundredths of colour in a grey picture.
    if sums.color_range / count < 0.02 {
        return Look::Grey;
    }
    let is_normals = (sums.length / count - 1.0).abs() < 0.25
        && sums.length_error / count < 0.25
        && sums.outwards / count > 0.97
        && sums.blue_lead / count > 0.05;
    if is_normals {
        Look::Normals
    } else {
        Look::Color
    }
}

#[derive(Default)]
struct Sums {
    color_range: f64,
    length: f64,
    length_error: f64,
    outwards: f64,
    blue_lead: f64,
}

/// Depth, channels, size and, for integers, how many different heights there are.
pub(super) fn describe_heights(image: &MapImage, slot: &MapSlot) -> String {
    let plain = describe_picture(&image.raw);
    match image.height(slot.channel) {
        HeightMap::U16(grid) => {
            let mut seen = vec![false; 1 << 16];
            for &texel in grid.texels() {
                seen[usize::from(texel)] = true;
            }
            let levels = seen.iter().filter(|&&s| s).count();
            format!("{plain}, {levels} levels")
        }
        HeightMap::F32(_) => plain,
    }
}

/// Depth, channels and size: "16-bit grey, 512×512".
pub(super) fn describe_picture(image: &RawImage) -> String {
    let depth = match image.samples {
        Samples::U8(_) => "8-bit",
        Samples::U16(_) => "16-bit",
        Samples::F32(_) => "float",
    };
    let channels = match image.channels {
        1 => "grey",
        2 => "grey with alpha",
        3 => "RGB",
        _ => "RGBA",
    };
    format!("{depth} {channels}, {}×{}", image.width, image.height)
}

/// How a normal (or slope) map relates to a height map of the same material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MapComparison {
    /// Correlation of both maps' slopes along u, −1…1; negative where one relief is inside out.
    pub along_u: f64,
    /// The same along v, green read as +Y; of the opposite sign to `along_u` where green grows downwards.
    pub along_v: f64,
    /// Amplitude at which the heights have the normals' slopes, in sides of the tile (the geometric mean
    /// of width and height of the picture), at least 0. Least squares over both axes.
    pub amplitude: f64,
}

/// Below this a correlation says nothing. Real pairs have 0.36 and more.
const MIN_CORRELATION: f64 = 0.2;

impl MapComparison {
    /// Whether the two maps tell the same relief at all.
    pub fn is_telling(&self) -> bool {
        self.along_u.abs().max(self.along_v.abs()) > MIN_CORRELATION
    }

    /// Whether green grows downwards in the normal map.
    pub fn green_is_flipped(&self) -> bool {
        self.along_v.abs() > MIN_CORRELATION && self.along_v * self.orientation() < 0.0
    }

    /// Whether one of the two maps has white for low.
    pub fn is_inside_out(&self) -> bool {
        self.along_u < -MIN_CORRELATION
    }

    fn orientation(&self) -> f64 {
        if self.is_inside_out() { -1.0 } else { 1.0 }
    }
}

/// Compares the slopes of both maps on a grid of texels of the normal map; `None` where the two do not
/// lie on the surface in the same way, or where either is flat.
///
/// The relation asked for is `n.xy = −a · n.z · ∇h`: slopes `−n.xy / n.z` against `a ∇h`, weighted with
/// `n.z²` so that normals near the horizon, whose slopes are mostly rounding, do not rule the fit.
pub(super) fn compare(
    heights: (&MapSlot, &MapImage),
    normals: (&MapSlot, &MapImage),
) -> Option<MapComparison> {
    let (height_slot, normal_slot) = (heights.0, normals.0);
    if Addressing::from_slot(height_slot) != Addressing::from_slot(normal_slot) {
        return None;
    }
    let map = heights.1.height(height_slot.channel);
    let raw = &normals.1.raw;
    if !raw.is_color() {
        return None;
    }
    let sign = if height_slot.invert { -1.0 } else { 1.0 };
    let gain = sign * f64::from(height_slot.gain);
    let (mut u, mut v) = (AxisSums::default(), AxisSums::default());
    for (x, y) in probes(raw.width, raw.height) {
        let n = [0, 1, 2].map(|c| 2.0 * f64::from(raw.fraction(x, y, c)) - 1.0);
        let [tilt_u, tilt_v, weight] = match normal_slot.role {
            MapRole::Slope => [n[0], n[1], 1.0],
            _ => [-n[0], -n[1], n[2]],
        };
        let at = Vec2::new(
            (x as f32 + 0.5) / raw.width as f32,
            (y as f32 + 0.5) / raw.height as f32,
        );
        // Rows grow downwards and v upwards, unless the picture lies upside down.
        let up = if height_slot.flip_v { 1.0 } else { -1.0 };
        let [right, down] = central_slope(map, at, height_slot);
        u.add(tilt_u, weight * gain * right);
        v.add(tilt_v, weight * gain * up * down);
    }
    let comparison = MapComparison {
        along_u: u.correlation(),
        along_v: v.correlation(),
        amplitude: 0.0,
    };
    let energy = u.height_energy + v.height_energy;
    let sense = |c: f64| if c < 0.0 { -1.0 } else { 1.0 };
    let shared = sense(u.product) * u.product + sense(v.product) * v.product;
    (energy > 0.0 && shared > 0.0).then(|| MapComparison {
        amplitude: shared / energy,
        ..comparison
    })
}

#[derive(Default)]
struct AxisSums {
    product: f64,
    height_energy: f64,
    normal_energy: f64,
}

impl AxisSums {
    fn add(&mut self, normal: f64, height: f64) {
        self.product += normal * height;
        self.height_energy += height * height;
        self.normal_energy += normal * normal;
    }

    fn correlation(&self) -> f64 {
        let norm = (self.height_energy * self.normal_energy).sqrt();
        if norm > 0.0 { self.product / norm } else { 0.0 }
    }
}

/// Central differences one texel to either side, per side of the tile (geometric mean): texels are taken
/// to be square on the surface, as programs that make normal maps from heights do.
fn central_slope(map: &HeightMap, at: Vec2, slot: &MapSlot) -> [f64; 2] {
    let size = Vec2::new(map.width() as f32, map.height() as f32);
    let slope = map.central_slope(at, slot.wrap);
    let per_texel = slope / size;
    let side = f64::from((size.x * size.y).sqrt());
    [f64::from(per_texel.x) * side, f64::from(per_texel.y) * side]
}

/// Texels on a regular grid over a picture.
fn probes(width: u32, height: u32) -> impl Iterator<Item = (u32, u32)> {
    let (step_x, step_y) = (width.div_ceil(MAX_PROBES), height.div_ceil(MAX_PROBES));
    (0..height)
        .step_by(step_y as usize)
        .flat_map(move |y| (0..width).step_by(step_x as usize).map(move |x| (x, y)))
}
