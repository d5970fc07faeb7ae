//! Reflected light → the samples, and mirror rays → the next bounce.

use super::super::Frame;
use super::{
    Column, Column3, Mirrors, PLACES, Places, Rays, Surfaces, get_rgb, get3, relief, set, set_rgb,
    set3,
};
use crate::geometry::{HitLanes, offset_by_bound};
use crate::math::simd::{Kernel, Simd};
use crate::math::wide::Wide;
use crate::math::{Real as _, gamma};
use crate::scene::BentNormals;
use crate::shading::{mirror_direction, reflect};

/// A mirror ray with a smaller share of its pixel than this is not followed: half a step of 8 bits.
const MIN_WEIGHT: f32 = 1.0 / 512.0;

/// Adds the own colour, `(1 − r) · local` while mirrors are followed, of every hit and the background of every miss to the samples.
pub fn gather(
    frame: &Frame<'_>,
    mirrors: Mirrors,
    rays: &Rays,
    surfaces: &Surfaces,
    radiance: &mut Column3,
) {
    frame.level.run_or_plain(Gather {
        frame,
        mirrors,
        rays,
        surfaces,
        radiance,
    });
}

struct Gather<'a> {
    frame: &'a Frame<'a>,
    mirrors: Mirrors,
    rays: &'a Rays,
    surfaces: &'a Surfaces,
    radiance: &'a mut Column3,
}

impl Kernel for Gather<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let mut missed = self.rays.active;
        for run in &self.surfaces.runs {
            missed = missed & !run.places;
            let material = &self.frame.materials[run.material];
            let local = self.mirrors.local_share(material.reflectivity);
            for group in run.places.groups::<S>() {
                let weight = self.rays.weight.get(simd, group) * local;
                let sum = get_rgb(simd, self.radiance, group)
                    + get_rgb(simd, &self.surfaces.reflected, group) * weight;
                set_rgb(self.radiance, group, run.places.mask(simd, group), sum);
            }
        }
        for group in missed.groups::<S>() {
            let behind = self
                .frame
                .background(get3(simd, &self.rays.lanes.dir, group));
            let weight = self.rays.weight.get(simd, group);
            let sum = get_rgb(simd, self.radiance, group) + behind * weight;
            set_rgb(self.radiance, group, missed.mask(simd, group), sum);
        }
    }
}

/// Replaces the rays by the mirror rays of all points whose material reflects; returns their places.
pub fn turn_to_mirror_rays(
    frame: &Frame<'_>,
    rays: &mut Rays,
    hits: &HitLanes<PLACES>,
    surfaces: &Surfaces,
) -> Places {
    let reflects = |material: usize| frame.materials[material].reflectivity > 0.0;
    let mut mirrored = Places::EMPTY;
    if surfaces.runs.iter().any(|run| reflects(run.material)) {
        rays.lanes.leaving = hits.prim;
        frame.level.run_or_plain(MirrorRays {
            frame,
            rays,
            surfaces,
            mirrored: &mut mirrored,
        });
    }
    mirrored
}

struct MirrorRays<'a> {
    frame: &'a Frame<'a>,
    rays: &'a mut Rays,
    surfaces: &'a Surfaces,
    mirrored: &'a mut Places,
}

impl Kernel for MirrorRays<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (from, to) = (self.surfaces, self.rays);
        to.lanes.t_max = Column::splat(-1.0);
        for run in &from.runs {
            let reflectivity = self.frame.materials[run.material].reflectivity;
            if reflectivity <= 0.0 {
                continue;
            }
            for group in run.places.groups::<S>() {
                let weight = to.weight.get(simd, group) * reflectivity;
                let shows = weight.ge(Wide::new(simd, MIN_WEIGHT));
                let mask = run.places.mask(simd, group) & shows;
                let n_geo = get3(simd, &from.n_geo, group);
                let n_shade = get3(simd, &from.n_shade, group);
                let wo = -get3(simd, &to.lanes.dir, group);
                let dir = if self.frame.bent_normals == BentNormals::Textbook {
                    reflect(n_shade, wo)
                } else {
                    mirror_direction(n_shade, n_geo, wo)
                };
                let mut p = get3(simd, &from.p, group);
                let mut bound = from.bound.get(simd, group);
                if run.searches {
                    let sunk = from.relief.sunk.get(simd, group);
                    let way_out = relief::way_out((sunk, n_geo), wo, dir, run.kind.smooth);
                    p = p + way_out;
                    let rounding = sunk.splat(gamma(8));
                    bound = bound + way_out.abs().dot(n_geo.abs()) * rounding;
                }
                let origin = offset_by_bound(p, bound, n_geo, dir);
                if self.frame.cone_spread.is_some() {
                    // A mirror image is as far away as the way there and on: its cone grows as if there were
                    // no mirror.
                    let way = get3(simd, &from.p, group) - get3(simd, &to.lanes.origin, group);
                    let travelled = to.travelled.get(simd, group) + way.length();
                    set(&mut to.travelled, group, mask, travelled);
                }
                set3(&mut to.lanes.origin, group, mask, origin);
                set3(&mut to.lanes.dir, group, mask, dir);
                let far = Wide::new(simd, f32::INFINITY);
                set(&mut to.lanes.t_max, group, mask, far);
                set(&mut to.weight, group, mask, weight);
                self.mirrored.add(group, mask);
            }
        }
    }
}
