//! Cameras around the place that is looked at.

use glam::DVec3;

use crate::scene::Camera;

/// Nearer to 0 than this sine, `up` does not say which way is up in the picture.
const LEAST_UP_SINE: f64 = 0.05;

/// The camera turned around `pivot` until it sees it at `angle` from the surface's normal, radians.
///
/// Distance and field of view stay, and so does the side of the surface from which the camera comes; it looks
/// straight at the pivot. `normal` is a unit vector on the camera's side of the surface.
#[must_use]
pub fn orbited(camera: &Camera, pivot: DVec3, normal: DVec3, angle: f64) -> Camera {
    let offset = camera.eye - pivot;
    let across = |v: DVec3| (v - normal * normal.dot(v)).try_normalize();
    // A camera on the normal comes from below the picture, as cameras over a floor do.
    let aside = across(offset)
        .filter(|_| offset.cross(normal).length() > 1e-6 * offset.length())
        .or_else(|| across(-camera.axes().up))
        .unwrap_or_else(|| normal.any_orthonormal_vector());
    let (sin, cos) = angle.sin_cos();
    let towards = normal * cos + aside * sin;
    let up = camera.up.normalize_or(DVec3::Z);
    Camera {
        eye: pivot + towards * offset.length(),
        target: pivot,
        up: if up.cross(towards).length() > LEAST_UP_SINE {
            camera.up
        } else {
            normal * sin - aside * cos
        },
        vfov: camera.vfov,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            eye: DVec3::new(0.0, -3.0, 4.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            vfov: 0.5,
        }
    }

    #[test]
    fn angles_and_distances_are_met() {
        let normal = DVec3::new(0.2, -0.5, 0.8).normalize_or(DVec3::Z);
        let pivot = DVec3::new(0.3, 0.1, 0.2);
        for degrees in [0.0_f64, 15.0, 45.0, 75.0, 89.0] {
            let turned = orbited(&camera(), pivot, normal, degrees.to_radians());
            let offset = turned.eye - pivot;
            let angle = offset.angle_between(normal).to_degrees();
            assert!((angle - degrees).abs() < 1e-6, "{angle} is not {degrees}");
            assert!((offset.length() - camera().eye.distance(pivot)).abs() < 1e-12);
            assert!(turned.axes().up.is_finite());
        }
    }

    #[test]
    fn its_own_angle_leaves_a_camera_where_it_is() {
        let angle = (0.6_f64).asin();
        let same = orbited(&camera(), DVec3::ZERO, DVec3::Z, angle);
        assert!(same.eye.distance(camera().eye) < 1e-12);
    }

    #[test]
    fn straight_above_a_floor_the_picture_keeps_its_side() {
        let above = orbited(&camera(), DVec3::ZERO, DVec3::Z, 0.0);
        assert!(above.axes().up.distance(DVec3::Y) < 1e-9);
        let aslant = orbited(&camera(), DVec3::ZERO, DVec3::Z, 0.3);
        assert!(aslant.axes().right.distance(above.axes().right) < 1e-9);
        // From the normal itself it goes down the picture.
        let from_above = orbited(&above, DVec3::ZERO, DVec3::Z, 0.3);
        assert!(from_above.eye.distance(aslant.eye) < 1e-9);
    }
}
