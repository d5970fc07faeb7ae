//! Searches that sample: fixed numbers of steps along the ray, then perhaps a refinement.

use super::Found;
use super::shell::Shell;
use crate::math::{Mask as _, Real};
use crate::surface::SurfaceInteraction;
use crate::surface::mapping::BoundHeight;

/// How a march ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refinement {
    /// At the first sample that is not above the relief.
    None,
    /// Where the chord between the last two samples meets the ray.
    Secant,
    /// After that many bisections between the last two samples.
    Bisection(u32),
}

/// How many steps a march takes from the top of the relief to its bottom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layers {
    /// For a ray along the normal, at least 1.
    pub fewest: u32,
    /// For a ray in the plane, at least `fewest`; in between by the cosine.
    pub most: u32,
}

impl Layers {
    /// The same number at every angle.
    #[must_use]
    pub const fn fixed(count: u32) -> Self {
        Self {
            fewest: count,
            most: count,
        }
    }

    /// How many layers a ray at this cosine between view and normal takes.
    #[must_use]
    pub fn count(self, cos: f32) -> f32 {
        self.at(cos)
    }

    /// Whole layers at this cosine between view and normal.
    #[inline(always)]
    fn at<F: Real>(self, cos: F) -> F {
        let (fewest, most) = (self.fewest.max(1) as f32, self.most.max(1) as f32);
        let cos = cos.larger(cos.splat(0.0)).smaller(cos.splat(1.0));
        let count = cos.splat(most) - cos * (most - fewest);
        (count + 0.5).floor()
    }
}

/// Walks down in equal layers until a sample is not above the relief.
///
/// What is thinner than a layer may be missed; the error is about a layer's thickness without a
/// refinement. Sources: McGuire & McGuire 2005 (steep), Tatarchuk 2006 (secant), Policarpo et al. 2005
/// (bisection).
#[inline(always)]
pub fn march<F: Real>(
    height: &BoundHeight<'_>,
    s: &SurfaceInteraction<F>,
    wanted: F::Mask,
    layers: Layers,
    refinement: Refinement,
) -> Found<F> {
    let shell = Shell::new(height, s);
    let wanted = wanted & shell.usable;
    let (zero, one) = (s.uv.x.splat(0.0), s.uv.x.splat(1.0));
    let count = layers.at(shell.cos);
    let thickness = shell.thickness() / count;
    // The last sample above the relief and the first that is not.
    let mut z_above = zero.splat(shell.top);
    let mut gap_above = gap(height, &shell, z_above);
    let (mut z_below, mut gap_below) = (z_above, gap_above);
    let mut searching = wanted & gap_above.gt(zero);
    let mut steps = one;
    let mut layer = zero;
    while searching.any() {
        layer = layer + one;
        let last = layer.ge(count);
        let z = F::select(
            last,
            zero.splat(shell.bottom),
            zero.splat(shell.top) - thickness * layer,
        );
        let gap = gap(height, &shell, z);
        steps = F::select(searching, steps + one, steps);
        z_below = F::select(searching, z, z_below);
        gap_below = F::select(searching, gap, gap_below);
        searching = searching & gap.gt(zero) & !last;
        z_above = F::select(searching, z, z_above);
        gap_above = F::select(searching, gap, gap_above);
    }
    let z = match refinement {
        Refinement::None => z_below,
        Refinement::Secant => {
            let share = gap_above / (gap_above - gap_below);
            let z = z_above + (z_below - z_above) * share;
            // Where the first sample was already not above, there is no chord.
            F::select(share.is_finite(), z, z_below)
        }
        Refinement::Bisection(rounds) => {
            for _ in 0..rounds {
                let middle = (z_above + z_below) * 0.5;
                let is_above = gap(height, &shell, middle).gt(zero);
                z_above = F::select(is_above, middle, z_above);
                z_below = F::select(is_above, z_below, middle);
            }
            steps = steps + rounds as f32;
            z_below
        }
    };
    shell.found(s, z, steps)
}

/// How far the ray at displacement `z` is above the relief.
#[inline(always)]
fn gap<F: Real>(height: &BoundHeight<'_>, shell: &Shell<F>, z: F) -> F {
    z - height.displacement(shell.uv(z))
}

/// Parallax that repeats itself, each time by the height found and the slope there.
///
/// `z ← z + (H(uv(z)) − z)·N_z·cos θ` with the relief normal's share `N_z` along the surface normal:
/// steep slopes take smaller steps, so that it seldom runs past a wall. Source: Premecz 2006.
#[inline(always)]
pub fn iterate<F: Real>(
    height: &BoundHeight<'_>,
    s: &SurfaceInteraction<F>,
    iterations: u32,
) -> Found<F> {
    let shell = Shell::new(height, s);
    let zero = s.uv.x.splat(0.0);
    let mut z = zero;
    for _ in 0..iterations {
        let (relief, slope) = height.displacement_and_slope(shell.uv(z));
        let rise = s.grad_u * slope.x + s.grad_v * slope.y;
        let n_z = zero.splat(1.0) / (rise.dot(rise) + 1.0).sqrt();
        let next = z + (relief - z) * n_z * shell.cos;
        z = F::select(next.is_finite(), next, z);
    }
    shell.found(s, z, zero.splat(iterations as f32))
}
