//! The pinhole camera, in world units and double precision.

use glam::{DQuat, DVec3};

/// A pinhole looking from `eye` to `target`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Pinhole, world units.
    pub eye: DVec3,
    /// Point in the middle of the picture and pivot of orbiting.
    pub target: DVec3,
    /// Direction that points up in the picture; need not be perpendicular to the view.
    pub up: DVec3,
    /// Vertical field of view, radians, in `(0, π)`.
    pub vfov: f64,
}

/// Orthonormal axes of a camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraAxes {
    /// To the right in the picture.
    pub right: DVec3,
    /// Up in the picture.
    pub up: DVec3,
    /// Into the picture.
    pub forward: DVec3,
}

impl Camera {
    /// Looks at the middle of a box from the direction `from` (to the eye), far enough to see all of it.
    #[must_use]
    pub fn framing(min: DVec3, max: DVec3, from: DVec3, up: DVec3, vfov: f64) -> Self {
        let center = min * 0.5 + max * 0.5;
        let radius = ((max - min).length() * 0.5).max(f64::MIN_POSITIVE);
        let distance = radius / (vfov * 0.5).sin() * 1.05;
        Self {
            eye: center + from.normalize_or(DVec3::Y) * distance,
            target: center,
            up,
            vfov,
        }
    }

    /// The same view direction and field, moved so that the box is framed.
    #[must_use]
    pub fn framed(&self, min: DVec3, max: DVec3) -> Self {
        Self::framing(min, max, self.eye - self.target, self.up, self.vfov)
    }

    /// Orthonormal axes; a view along `up` gets some horizontal direction instead of NaN.
    #[must_use]
    pub fn axes(&self) -> CameraAxes {
        let forward = (self.target - self.eye).normalize_or(DVec3::NEG_Z);
        let right = forward
            .cross(self.up)
            .normalize_or(forward.any_orthonormal_vector());
        CameraAxes {
            right,
            up: right.cross(forward),
            forward,
        }
    }

    /// Distance from eye to pivot.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.eye.distance(self.target)
    }

    /// Turns around the pivot: `yaw` about `up`, `pitch` about the picture's horizontal, radians.
    /// Stops 0.01 radians short of the poles.
    pub fn orbit(&mut self, yaw: f64, pitch: f64) {
        let up = self.up.normalize_or(DVec3::Z);
        let offset = self.eye - self.target;
        let distance = offset.length();
        let turned = DQuat::from_axis_angle(up, yaw) * offset;
        let horizontal = (turned - up * up.dot(turned)).normalize_or(self.axes().forward);
        let elevation = up
            .dot(turned / distance.max(f64::MIN_POSITIVE))
            .clamp(-1.0, 1.0)
            .asin();
        let limit = std::f64::consts::FRAC_PI_2 - 0.01;
        let (sin, cos) = (elevation + pitch).clamp(-limit, limit).sin_cos();
        self.eye = self.target + (horizontal * cos + up * sin) * distance;
    }

    /// Moves eye and pivot together, in units of the picture's height at the pivot: `right`, `up`.
    pub fn pan(&mut self, right: f64, up: f64) {
        let axes = self.axes();
        let height = 2.0 * self.distance() * (self.vfov * 0.5).tan();
        let shift = (axes.right * right + axes.up * up) * height;
        self.eye += shift;
        self.target += shift;
    }

    /// Comes closer (`factor < 1`) or goes away, keeping `fixed` (world units) at its place in the picture.
    pub fn zoom_towards(&mut self, fixed: DVec3, factor: f64) {
        self.eye = fixed + (self.eye - fixed) * factor;
        self.target = fixed + (self.target - fixed) * factor;
    }
}
