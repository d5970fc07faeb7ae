//! Places → camera rays.

use super::super::Frame;
use super::super::sampling::pixel_sample;
use super::super::sites::Sites;
use super::{Column, Places, Rays, groups};
use crate::math::Bits as _;
use crate::math::simd::{Kernel, Simd};
use crate::math::wide::Wide;

/// Sets the rays of sample `index` of all pixels in `active`. The tile's upper left pixel is `corner`.
pub fn camera_rays(
    frame: &Frame<'_>,
    sites: &Sites,
    corner: [u32; 2],
    (active, index): (Places, u32),
    rays: &mut Rays,
) {
    rays.count = sites.count;
    rays.active = active;
    frame.level.run_or_plain(CameraRays {
        frame,
        sites,
        corner,
        index,
        rays,
    });
}

struct CameraRays<'a> {
    frame: &'a Frame<'a>,
    sites: &'a Sites,
    corner: [u32; 2],
    index: u32,
    rays: &'a mut Rays,
}

impl Kernel for CameraRays<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (camera, rays) = (&self.frame.camera, self.rays);
        let one = Wide::new(simd, 1.0);
        let origin = camera.origin.to_array();
        rays.weight = Column::splat(1.0);
        for group in 0..groups::<S>(rays.count) {
            let x = self.sites.column.get(simd, group).plus(self.corner[0]);
            let y = self.sites.row.get(simd, group).plus(self.corner[1]);
            let [sx, sy] = pixel_sample([x, y], self.index);
            let dir = camera.direction(x.signed_to_real() + sx, y.signed_to_real() + sy);
            for axis in 0..3 {
                rays.lanes.origin[axis].set(group, Wide::new(simd, origin[axis]));
            }
            rays.lanes.dir[0].set(group, dir.x);
            rays.lanes.dir[1].set(group, dir.y);
            rays.lanes.dir[2].set(group, dir.z);
            let active = rays.active.mask(simd, group);
            let far = one * f32::INFINITY;
            let t_max = crate::math::Real::select(active, far, -one);
            rays.lanes.t_max.set(group, t_max);
        }
    }
}
