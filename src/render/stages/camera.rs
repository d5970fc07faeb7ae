//! Places → camera rays.

use super::super::Frame;
use super::super::sampling::pixel_sample;
use super::super::sites::Sites;
use super::{Column, PLACES, Places, Rays, groups};
use crate::geometry::NO_HIT;
use crate::math::lanes::Lanes;
use crate::math::simd::{Kernel, Simd};
use crate::math::wide::Wide;
use crate::math::{Bits as _, Real as _};

/// The pixels that a tile's rays go through.
#[derive(Debug, Clone, Copy)]
pub struct Pixels {
    /// The tile's upper left pixel, in the film.
    pub corner: [u32; 2],
    /// Pixels of the picture from one of the film's to the next.
    pub stride: u32,
    /// Places with a pixel.
    pub active: Places,
}

/// Sets the rays of sample `index` of the pixels.
pub fn camera_rays(frame: &Frame<'_>, pixels: &Pixels, index: u32, rays: &mut Rays) {
    rays.count = PLACES;
    rays.active = pixels.active;
    rays.weight = Column::splat(1.0);
    if frame.cone_spread.is_some() {
        rays.travelled = Column::splat(0.0);
    }
    rays.lanes.leaving = Lanes::splat(NO_HIT);
    let [x, y, z] = frame.camera.origin.to_array();
    rays.lanes.origin = [Column::splat(x), Column::splat(y), Column::splat(z)];
    frame.level.run_or_plain(CameraRays {
        frame,
        pixels,
        index,
        rays,
    });
}

struct CameraRays<'a> {
    frame: &'a Frame<'a>,
    pixels: &'a Pixels,
    index: u32,
    rays: &'a mut Rays,
}

impl Kernel for CameraRays<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (sites, rays) = (Sites::get(), self.rays);
        let Pixels { corner, stride, .. } = *self.pixels;
        let far = Wide::new(simd, f32::INFINITY);
        for group in 0..groups::<S>(rays.count) {
            let x = sites.column.get(simd, group).plus(corner[0]).times(stride);
            let y = sites.row.get(simd, group).plus(corner[1]).times(stride);
            let [sx, sy] = pixel_sample([x, y], self.index);
            let (x, y) = (x.signed_to_real() + sx, y.signed_to_real() + sy);
            let dir = self.frame.camera.direction(x, y);
            rays.lanes.dir[0].set(group, dir.x);
            rays.lanes.dir[1].set(group, dir.y);
            rays.lanes.dir[2].set(group, dir.z);
            let t_max = Wide::select(rays.active.mask(simd, group), far, -far);
            rays.lanes.t_max.set(group, t_max);
        }
    }
}
