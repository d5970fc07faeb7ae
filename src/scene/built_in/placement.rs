//! Where a built-in scene is put: `NAME@SCALE` or `NAME@SCALE,OFFSET`.

use glam::DVec3;

use super::scenes::Stage;
use crate::scene::SceneSource;
use crate::shading::{Falloff, LightKind};

/// The way to an offset: no two coordinates alike.
const ASIDE: DVec3 = DVec3::new(1.0, -0.75, 0.5);

/// A scale and an offset that everything in a scene goes through: mesh, camera, lights and amplitudes. In exact
/// arithmetic the picture would stay the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Factor on all lengths, 10⁻¹⁵…10¹⁵.
    pub scale: f64,
    /// How far to the side, on the longest axis, in radii: half the largest extents. 0…10⁶.
    pub offset: f64,
}

impl Placement {
    /// As the scene was made.
    pub const PLAIN: Self = Self {
        scale: 1.0,
        offset: 0.0,
    };
    /// Largest power of ten of a scale, up and down.
    pub const MOST_SCALE: i32 = 15;
    /// Largest power of ten of an offset.
    pub const MOST_OFFSET: i32 = 6;

    /// A scene's name and its placement; plain without one. `None` if what follows the `@` is no placement.
    #[must_use]
    pub fn split(name: &str) -> Option<(&str, Self)> {
        let Some((name, numbers)) = name.split_once('@') else {
            return Some((name, Self::PLAIN));
        };
        let (scale, offset) = numbers.split_once(',').unwrap_or((numbers, "0"));
        let placement = Self {
            scale: scale.trim().parse().ok()?,
            offset: offset.trim().parse().ok()?,
        };
        let most = 10_f64.powi(Self::MOST_SCALE);
        let scales = 0.99 / most..=1.01 * most;
        let offsets = 0.0..=10_f64.powi(Self::MOST_OFFSET);
        let fits = scales.contains(&placement.scale) && offsets.contains(&placement.offset);
        fits.then_some((name, placement))
    }

    /// What opens a scene so placed.
    #[must_use]
    pub fn name(&self, scene: &str) -> String {
        let Self { scale, offset } = self;
        match (scale, offset) {
            (1.0, 0.0) => scene.to_owned(),
            (_, 0.0) => format!("{scene}@{scale:e}"),
            _ => format!("{scene}@{scale:e},{offset:e}"),
        }
    }

    /// The name and placement of an open scene; `None` if it is not built in.
    #[must_use]
    pub fn of(source: &SceneSource) -> Option<(&str, Self)> {
        match source {
            SceneSource::BuiltIn(name) => Self::split(name),
            SceneSource::Model(_) | SceneSource::SceneFile(_) => None,
        }
    }

    /// Puts a scene there.
    pub(super) fn apply(&self, stage: &mut Stage) {
        if *self == Self::PLAIN {
            return;
        }
        let places = stage.mesh.vertices.iter().map(|v| v.position);
        let least = places.clone().fold(DVec3::INFINITY, DVec3::min);
        let most = places.fold(DVec3::NEG_INFINITY, DVec3::max);
        let radius = (most - least).max_element() * 0.5;
        let shift = ASIDE * (self.offset * radius);
        let put = |p: DVec3| (p + shift) * self.scale;
        for vertex in &mut stage.mesh.vertices {
            vertex.position = put(vertex.position);
        }
        stage.camera.eye = put(stage.camera.eye);
        stage.camera.target = put(stage.camera.target);
        for light in &mut stage.lights {
            if let LightKind::Point { position, falloff } = &mut light.kind {
                *position = put(*position);
                if *falloff == Falloff::InverseSquare {
                    // Irradiance at distance 1 of a lamp that is `scale` times as far away.
                    light.intensity = (f64::from(light.intensity) * self.scale * self.scale) as f32;
                }
            }
        }
        for material in &mut stage.palette.materials {
            material.default_amplitude *= self.scale;
            for slot in &mut material.maps {
                slot.baked_amplitude = slot.baked_amplitude.map(|baked| baked * self.scale);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Placement;

    #[test]
    fn names_hold_placements() {
        for (scale, offset) in [
            (1.0, 0.0),
            (1e-15, 0.0),
            (1e15, 1e6),
            (1.0, 1e4),
            (2.5, 10.0),
        ] {
            let placement = Placement { scale, offset };
            let name = placement.name("extremes");
            assert_eq!(
                Placement::split(&name),
                Some(("extremes", placement)),
                "{name}"
            );
        }
        assert_eq!(Placement::PLAIN.name("wall"), "wall");
        for bad in [
            "wall@",
            "wall@x",
            "wall@0",
            "wall@1e16",
            "wall@1,2e6",
            "wall@1,-1",
            "wall@nan",
        ] {
            assert_eq!(Placement::split(bad), None, "{bad}");
        }
    }
}
