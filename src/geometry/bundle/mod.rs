//! Up to 64 rays side by side: what the bundle kernels work on.
//!
//! - `hull`: an interval around all rays, tested against eight boxes at a time
//! - `watertight`: one triangle against all rays
//!
//! Both are the vector twins of [`RaySlabs`](super::RaySlabs) and
//! [`Watertight`](super::triangle::Watertight): the same operations in the same order on each lane, so
//! the bits are the same. Generic over the level of [`simd`](super::simd).

mod hull;
mod watertight;

use std::ops::Range;

use super::slabs::{MIN_COMPONENT, PADDING};
use super::triangle::Axis;
use super::{Aabb, NO_HIT, Ray, RayLanes};
use crate::math::simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

pub(super) use hull::{Boxes, Hull};
pub(super) use watertight::{LaneHits, TriangleLanes};

/// Most rays in a bundle: an 8 × 8 block of pixels.
pub(super) const RAYS: usize = 64;

/// How far the directions of a bundle may be apart on each axis.
const MAX_DIR_SPREAD: f32 = 0.25;
/// How far its origins may be apart on each axis, in sizes of the scene.
const MAX_ORIGIN_SPREAD: f32 = 0.125;
/// Coordinates that neither overflow nor vanish in the arithmetic of a bundle.
const MAGNITUDES: Range<f32> = 1e-15..1e15;

/// A value for each ray.
pub(super) type Lanes<T> = crate::math::lanes::Lanes<T, RAYS>;

/// A float for each ray.
pub(super) type Floats = Lanes<f32>;

/// One vector from each of three arrays.
#[inline(always)]
fn load3<S: Simd>(simd: S, [x, y, z]: [&Floats; 3], group: usize) -> [S::f32s; 3] {
    [
        x.load(simd, group),
        y.load(simd, group),
        z.load(simd, group),
    ]
}

/// A set of rays: bit `i` stands for ray `i`.
pub(super) type RaySet = u64;

/// Groups of native width, from that of the first ray of a set to that of the last.
#[inline(always)]
fn groups_of<S: Simd>(set: RaySet) -> Range<usize> {
    let last = 63_u32.saturating_sub(set.leading_zeros()) as usize;
    set.trailing_zeros() as usize / S::f32s::LEN..last / S::f32s::LEN + 1
}

/// The lanes of a group that are in a set.
#[inline(always)]
pub(super) fn lanes_of<S: Simd>(simd: S, set: RaySet, group: usize) -> S::mask32s {
    S::mask32s::from_bitmask(simd, set >> (group * S::f32s::LEN % RAYS))
}

/// The smallest and the largest number in a set that is not empty.
#[inline(always)]
fn extremes<S: Simd>(simd: S, set: RaySet, floats: &Floats) -> (f32, f32) {
    let infinite = S::f32s::splat(simd, f32::INFINITY);
    let (mut least, mut most) = (infinite, -infinite);
    for group in groups_of::<S>(set) {
        let (x, in_set) = (floats.load(simd, group), lanes_of(simd, set, group));
        least = in_set.select(least.min(x), least);
        most = in_set.select(most.max(x), most);
    }
    (least.reduce_min(), most.reduce_max())
}

/// Up to 64 neighbouring rays, and those of them that are traced together prepared for box and triangle
/// tests.
pub(super) struct Bundle {
    /// The rays that are traced together; never empty when prepared.
    active: RaySet,
    /// Their dominant axis.
    along: Axis,
    origin: [Floats; 3],
    dir: [Floats; 3],
    inv_dir: [Floats; 3],
    /// Where the rays end; means something only if they converge.
    end: [Floats; 3],
    /// Whether they end closer together than they begin, as shadow rays to a lamp do. Then their hull is that
    /// of the rays from there.
    converge: bool,
    near_shift: [Floats; 3],
    far_shift: [Floats; 3],
    shear: [Floats; 2],
    /// The triangle that each ray leaves, or [`NO_HIT`].
    leaving: Lanes<u32>,
}

impl Bundle {
    /// No rays.
    pub(super) const fn new() -> Self {
        const ZEROS: [Floats; 3] = [Lanes::splat(0.0); 3];
        Self {
            active: 0,
            along: Axis::Z,
            origin: ZEROS,
            dir: ZEROS,
            inv_dir: ZEROS,
            end: ZEROS,
            converge: false,
            near_shift: ZEROS,
            far_shift: ZEROS,
            shear: [Lanes::splat(0.0); 2],
            leaving: Lanes::splat(NO_HIT),
        }
    }

    /// Number of rays that are traced together.
    #[inline(always)]
    pub(super) const fn count(&self) -> usize {
        self.active.count_ones() as usize
    }

    /// The rays of a group that leave this triangle, as bits.
    #[inline(always)]
    pub(super) fn leaving<S: Simd>(&self, simd: S, group: usize, prim: u32) -> u64 {
        let leaving = S::u32s::from_slice(simd, self.leaving.group(group, S::u32s::LEN));
        leaving.simd_eq(S::u32s::splat(simd, prim)).to_bitmask()
    }

    /// Groups of native width, from that of the first active ray to that of the last.
    #[inline(always)]
    pub(super) fn groups<S: Simd>(&self) -> Range<usize> {
        groups_of::<S>(self.active)
    }

    /// Takes up to 64 rays. Lanes beyond keep what they held.
    #[inline(always)]
    pub(super) fn load(&mut self, rays: &[Ray]) {
        let [ox, oy, oz] = &mut self.origin;
        let [dx, dy, dz] = &mut self.dir;
        for (lane, ray) in rays.iter().take(RAYS).enumerate() {
            (ox.0[lane], oy.0[lane], oz.0[lane]) = ray.origin.into();
            (dx.0[lane], dy.0[lane], dz.0[lane]) = ray.dir.into();
        }
        self.leaving = Lanes::splat(NO_HIT);
    }

    /// Takes 64 rays that lie side by side, from place `first` on.
    #[inline(always)]
    pub(super) fn load_lanes<const N: usize>(&mut self, rays: &RayLanes<N>, first: usize) {
        let (place, width) = (first / RAYS, RAYS);
        for axis in 0..3 {
            let origin = rays.origin[axis].group(place, width);
            self.origin[axis].0.copy_from_slice(origin);
            let dir = rays.dir[axis].group(place, width);
            self.dir[axis].0.copy_from_slice(dir);
        }
        let leaving = rays.leaving.group(place, width);
        self.leaving.0.copy_from_slice(leaving);
    }

    /// [`Ray::runs_away_from`] for all rays.
    #[inline(always)]
    pub(super) fn running_away<S: Simd>(&self, simd: S, bounds: &Aabb) -> RaySet {
        let splat = |x| S::f32s::splat(simd, x);
        let (min, max) = (bounds.min.to_array(), bounds.max.to_array());
        let zero = splat(0.0);
        let mut set = 0;
        for group in 0..RAYS / S::f32s::LEN {
            let mut away = zero.simd_gt(zero);
            for axis in 0..3 {
                let origin = self.origin[axis].load(simd, group);
                let dir = self.dir[axis].load(simd, group);
                let up = origin.simd_gt(splat(max[axis])) & dir.simd_gt(zero);
                let down = origin.simd_lt(splat(min[axis])) & dir.simd_lt(zero);
                away = away | up | down;
            }
            set |= away.to_bitmask() << (group * S::f32s::LEN);
        }
        set
    }

    /// Sorts the rays by dominant axis, as [`Axis::of_largest`] does. Rays that are not of unit length,
    /// or of a scale at which the bounds of a [`Hull`] are not proven, are in no set.
    #[inline(always)]
    pub(super) fn by_axis<S: Simd>(&self, simd: S, reach: f32) -> [RaySet; 3] {
        let mut sets = [0; 3];
        let splat = |x| S::f32s::splat(simd, x);
        for group in 0..RAYS / S::f32s::LEN {
            let [x, y, z] = load3(simd, self.dir.each_ref(), group);
            let squared = x * x + y * y + z * z;
            let is_unit = squared.simd_gt(splat(0.5)) & squared.simd_lt(splat(2.0));
            let [ox, oy, oz] = load3(simd, self.origin.each_ref(), group);
            // Summed, so that NaN anywhere is NaN.
            let magnitude = ox.abs() + oy.abs() + oz.abs() + reach;
            let is_usual = magnitude.simd_gt(splat(MAGNITUDES.start))
                & magnitude.simd_lt(splat(MAGNITUDES.end))
                & is_unit;
            let (x, y, z) = (x.abs(), y.abs(), z.abs());
            let along_x = x.simd_gt(y) & x.simd_gt(z);
            let along_y = !along_x & y.simd_gt(z);
            let along = [along_x, along_y, !(along_x | along_y)];
            for (set, along) in sets.iter_mut().zip(along) {
                *set |= (along & is_usual).to_bitmask() << (group * S::f32s::LEN);
            }
        }
        sets
    }

    /// A part of the rays in `set` that is more alike than all of them; `None` if all are alike enough.
    ///
    /// Cuts where they differ most, in origin or in direction: at depth edges, between two facets of a
    /// mirror, between the end of one row of pixels and the beginning of the next. `size` is the scene's.
    #[inline(always)]
    pub(super) fn cut<S: Simd>(&self, simd: S, set: RaySet, size: f32) -> Option<RaySet> {
        let (mut widest, mut at) = (1.0, None);
        let kinds = [
            (&self.dir, MAX_DIR_SPREAD),
            (&self.origin, MAX_ORIGIN_SPREAD * size),
        ];
        for (coordinates, allowed) in kinds {
            for coordinate in coordinates {
                let (least, most) = extremes(simd, set, coordinate);
                if most - least > widest * allowed {
                    widest = (most - least) / allowed;
                    at = Some((coordinate, least + (most - least) * 0.5));
                }
            }
        }
        let (coordinate, middle) = at?;
        let middle = S::f32s::splat(simd, middle);
        let mut below = 0;
        for group in groups_of::<S>(set) {
            let is_below = coordinate.load(simd, group).simd_lt(middle);
            below |= is_below.to_bitmask() << (group * S::f32s::LEN);
        }
        Some(set & below)
    }

    /// Prepares those rays for being traced together that are in `set`, which is not empty, all dominated
    /// by `along`: like [`RaySlabs::new`](super::RaySlabs::new) and
    /// [`Watertight`](super::triangle::Watertight).
    #[expect(clippy::needless_range_loop, reason = "five arrays share the index")]
    #[inline(always)]
    pub(super) fn prepare<S: Simd>(&mut self, simd: S, set: RaySet, along: Axis, reach: f32) {
        (self.active, self.along, self.converge) = (set, along, false);
        for group in self.groups::<S>() {
            let origin = load3(simd, self.origin.each_ref(), group);
            let [ox, oy, oz] = origin;
            let farthest = ox.abs().max(oy.abs()).max(oz.abs());
            let padding = (farthest + reach) * PADDING;
            for axis in 0..3 {
                let dir = self.dir[axis].load(simd, group);
                let smallest = S::f32s::splat(simd, MIN_COMPONENT);
                let is_small = dir.abs().simd_lt(smallest);
                let component = is_small.select(smallest.copysign(dir), dir);
                let inv = S::f32s::splat(simd, 1.0) / component;
                let at_origin = origin[axis] * inv;
                let margin = inv.abs() * padding;
                self.inv_dir[axis].store::<S>(group, inv);
                self.near_shift[axis].store::<S>(group, at_origin + margin);
                self.far_shift[axis].store::<S>(group, at_origin - margin);
            }
            let [dx, dy, dz] = load3(simd, along.last(self.dir.each_ref()), group);
            self.shear[0].store::<S>(group, dx / dz);
            self.shear[1].store::<S>(group, dy / dz);
        }
    }

    /// Looks whether the prepared rays, which end at `t_max`, converge.
    #[inline(always)]
    pub(super) fn find_ends<S: Simd>(&mut self, simd: S, t_max: &Floats) {
        let (mut starts, mut ends, mut farthest) = (0.0, 0.0, 0.0_f32);
        for axis in 0..3 {
            for group in self.groups::<S>() {
                let along = self.dir[axis].load(simd, group) * t_max.load(simd, group);
                self.end[axis].store::<S>(group, self.origin[axis].load(simd, group) + along);
            }
            let (least, most) = extremes(simd, self.active, &self.origin[axis]);
            starts += most - least;
            let (least, most) = extremes(simd, self.active, &self.end[axis]);
            ends += most - least;
            farthest = farthest.max(-least).max(most);
        }
        // Not so for rays without end: the sum of their ends is infinite or NaN.
        self.converge = ends < starts && farthest < MAGNITUDES.end;
    }

    /// The hull of the rays that are traced together.
    #[inline(always)]
    pub(super) fn hull<S: Simd>(&self, simd: S, reach: f32) -> Hull {
        let mut extremes = hull::Extremes::new(simd);
        for group in self.groups::<S>() {
            let lanes = lanes_of(simd, self.active, group);
            let origin = load3(simd, self.origin.each_ref(), group);
            let inv_dir = load3(simd, self.inv_dir.each_ref(), group);
            if self.converge {
                let end = load3(simd, self.end.each_ref(), group);
                extremes.add(lanes, end, inv_dir.map(|inv| -inv));
                extremes.reach(lanes, origin);
            } else {
                extremes.add(lanes, origin, inv_dir);
            }
        }
        extremes.hull(simd, self, reach)
    }

    /// Goes on with those prepared rays only that are in `set`, which is not empty: their hull is narrower.
    #[inline(always)]
    pub(super) fn narrow<S: Simd>(&mut self, simd: S, set: RaySet, reach: f32) -> Hull {
        self.active = set;
        self.hull(simd, reach)
    }
}
