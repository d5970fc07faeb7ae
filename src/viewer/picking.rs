//! Between places in the window and places in the world.

use egui::{Pos2, Rect, pos2};
use glam::DVec3;

use crate::geometry::Ray;
use crate::geometry::bvh::AcceptAll;
use crate::geometry::triangle::Watertight;
use crate::scene::{Camera, CameraAxes, Scene};

/// A camera with the rectangle that its picture fills, in points.
#[derive(Debug, Clone, Copy)]
pub struct Projection {
    camera: Camera,
    axes: CameraAxes,
    rect: Rect,
    /// Half the picture's height at distance 1.
    tan: f64,
}

impl Projection {
    /// Nothing is divided by a rectangle or field of view without extent.
    #[must_use]
    pub fn new(camera: &Camera, rect: Rect) -> Self {
        Self {
            camera: *camera,
            axes: camera.axes(),
            rect,
            tan: (camera.vfov * 0.5).tan().max(f64::MIN_POSITIVE),
        }
    }

    /// The camera's axes.
    #[must_use]
    pub const fn axes(&self) -> &CameraAxes {
        &self.axes
    }

    /// World units per point at a distance along the view.
    #[must_use]
    pub fn units_per_point(&self, depth: f64) -> f64 {
        2.0 * depth * self.tan / f64::from(self.rect.height().max(1.0))
    }

    /// Distance of a point from the eye, along the view.
    #[must_use]
    pub fn depth(&self, p: DVec3) -> f64 {
        (p - self.camera.eye).dot(self.axes.forward)
    }

    /// Where a world point is seen; `None` behind the eye.
    #[must_use]
    pub fn project(&self, p: DVec3) -> Option<Pos2> {
        let offset = p - self.camera.eye;
        let depth = offset.dot(self.axes.forward);
        if depth.is_nan() || depth <= 0.0 {
            return None;
        }
        let scale = 1.0 / self.units_per_point(depth);
        let (x, y) = (offset.dot(self.axes.right), offset.dot(self.axes.up));
        let center = self.rect.center();
        Some(pos2(
            center.x + (x * scale) as f32,
            center.y - (y * scale) as f32,
        ))
    }

    /// The world point at a place of the window and a distance along the view.
    #[must_use]
    pub fn unproject(&self, pos: Pos2, depth: f64) -> DVec3 {
        self.camera.eye + self.direction(pos) * depth
    }

    /// Direction of the ray through a place of the window, of length 1 along the view.
    fn direction(&self, pos: Pos2) -> DVec3 {
        let offset = pos - self.rect.center();
        let scale = self.units_per_point(1.0);
        let (x, y) = (f64::from(offset.x) * scale, f64::from(-offset.y) * scale);
        self.axes.forward + self.axes.right * x + self.axes.up * y
    }

    /// The point of the model that is seen at a place of the window. Cut-outs count as solid.
    #[must_use]
    pub fn pick(&self, scene: &Scene, pos: Pos2) -> Option<DVec3> {
        let ray = Ray {
            origin: scene.normalization.internal_from_world(self.camera.eye),
            dir: self.direction(pos).normalize_or(DVec3::NEG_Z).as_vec3(),
        };
        let hit = scene
            .bvh
            .intersect::<Watertight, _>(&ray, f32::INFINITY, &AcceptAll)?;
        Some(scene.normalization.world_from_internal(ray.at(hit.t)))
    }

    /// What zooming at a place of the window holds still: the model there, else the plane through the pivot.
    #[must_use]
    pub fn anchor(&self, scene: &Scene, pos: Pos2) -> DVec3 {
        self.pick(scene, pos)
            .unwrap_or_else(|| self.unproject(pos, self.depth(self.camera.target)))
    }

    /// The pixel of a picture of this size that lies at a place of the window.
    #[must_use]
    pub fn pixel(&self, pos: Pos2, [w, h]: [u32; 2]) -> [u32; 2] {
        let part = (pos - self.rect.min) / self.rect.size().max(egui::Vec2::splat(1.0));
        let index =
            |part: f32, n: u32| ((part * n as f32).max(0.0) as u32).min(n.saturating_sub(1));
        [index(part.x, w), index(part.y, h)]
    }
}
