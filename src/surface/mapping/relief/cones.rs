//! Relaxed cone stepping: steps as wide as a precomputed map of cones allows.

use super::Found;
use super::shell::Shell;
use crate::math::{Mask as _, Real};
use crate::surface::SurfaceInteraction;
use crate::surface::mapping::BoundHeight;
use crate::texture::ConeMap;

/// Steps to the rim of the cone over each place, then bisects.
///
/// A relaxed cone stands on the relief at its texel and is as wide as it can be while no ray from above
/// enters the relief inside it more than once. So a step may end under the relief, and bisection finds the
/// one crossing that it stepped over. Walks that run out of steps stop short.
///
/// Source: Policarpo & Oliveira 2007.
#[inline(always)]
pub fn cone_steps<F: Real>(
    (height, cones): (&BoundHeight<'_>, &ConeMap),
    s: &SurfaceInteraction<F>,
    wanted: F::Mask,
    most: u32,
    bisections: u32,
) -> Found<F> {
    let shell = Shell::new(height, s);
    let wanted = wanted & shell.usable;
    let zero = s.uv.x.splat(0.0);
    let one = zero.splat(1.0);
    let rate = shell
        .per_z()
        .times(height.addressing.scale)
        .times(height.map.size());
    let lateral = (rate.x * rate.x + rate.y * rate.y).sqrt();
    // From texels per stored height to texels per displacement.
    let widening = 1.0 / height.scale.abs();
    let mut z = zero.splat(shell.top);
    let mut z_above = z;
    let mut searching = wanted;
    let mut steps = zero;
    for _ in 0..most {
        let uv = shell.uv(z);
        let st = height.addressing.st(uv);
        let gap = z - height.displacement(uv);
        steps = F::select(searching, steps + one, steps);
        searching = searching & gap.gt(zero);
        if !searching.any() {
            break;
        }
        let width = cones.narrowest(st, height.addressing.wrap) * widening;
        let next = z - gap * width / (lateral + width);
        let next = next.larger(zero.splat(shell.bottom));
        z_above = F::select(searching, z, z_above);
        z = F::select(searching, next, z);
    }
    let (mut z_above, mut z_below) = (z_above, z);
    for _ in 0..bisections {
        let middle = (z_above + z_below) * 0.5;
        let is_above = middle.gt(height.displacement(shell.uv(middle)));
        z_above = F::select(is_above, middle, z_above);
        z_below = F::select(is_above, z_below, middle);
    }
    let steps = steps + bisections as f32;
    shell.found(s, z_below, steps)
}
