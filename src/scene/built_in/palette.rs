//! Materials with generated maps.

use super::maps::{MapSet, Relief};
use crate::math::LinearRgb;
use crate::shading::Material;
use crate::texture::{MapImage, MapRole, MapSlot};

/// What a surface does with light besides its maps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finish {
    /// Diffuse colour, multiplies the albedo map.
    pub kd: LinearRgb,
    /// Specular colour; with `kd` at most 1 in each channel, so that no energy is made.
    pub ks: LinearRgb,
    /// Phong exponent.
    pub shininess: f32,
    /// Share of mirror reflection.
    pub reflectivity: f32,
}

impl Finish {
    /// No highlight: brick, earth, plaster.
    pub const MATTE: Self = Self {
        kd: LinearRgb::WHITE,
        ks: LinearRgb::BLACK,
        shininess: 10.0,
        reflectivity: 0.0,
    };

    /// The same under a coat that shines: `ks` for every channel, and as much less diffuse.
    #[must_use]
    pub const fn glossy(ks: f32, shininess: f32) -> Self {
        Self {
            kd: LinearRgb::gray(1.0 - ks),
            ks: LinearRgb::gray(ks),
            shininess,
            reflectivity: 0.0,
        }
    }

    /// Worked metal: a broad, tinted highlight over its own colour.
    #[must_use]
    pub const fn metal(tint: LinearRgb, shininess: f32) -> Self {
        Self {
            kd: LinearRgb::gray(0.75),
            ks: LinearRgb::new(0.2 * tint.r, 0.2 * tint.g, 0.2 * tint.b),
            shininess,
            reflectivity: 0.0,
        }
    }

    /// With a share of mirror reflection.
    #[must_use]
    pub const fn mirroring(self, reflectivity: f32) -> Self {
        Self {
            reflectivity,
            ..self
        }
    }

    /// With the diffuse colour multiplied.
    #[must_use]
    pub const fn tinted(self, tint: LinearRgb) -> Self {
        Self {
            kd: LinearRgb::new(self.kd.r * tint.r, self.kd.g * tint.g, self.kd.b * tint.b),
            ..self
        }
    }
}

/// The materials of a scene in the making, and the pictures they share.
#[derive(Debug, Default)]
pub struct Palette {
    /// Pictures; the slots of `materials` index them.
    pub images: Vec<MapImage>,
    /// One per material index.
    pub materials: Vec<Material>,
    baked: Vec<(Relief, usize)>,
}

impl Palette {
    /// Adds a material with albedo, height and normal map; gives its index.
    ///
    /// `tile` is the world width of a tile on the meshes that wear it: the relief's depth is its natural
    /// share of that. Pictures of a relief are made once, however many materials use them.
    pub fn relief(&mut self, relief: Relief, tile: f64, finish: Finish) -> u16 {
        let first = self.pictures(relief);
        let depth = relief.amplitude() * tile;
        let slot = |offset, role, what: &str| MapSlot {
            note: format!("generated: {}, {what}", relief.name()),
            ..MapSlot::new(first + offset, role)
        };
        let normal = MapSlot {
            baked_amplitude: Some(depth),
            ..slot(2, MapRole::Normal, "exact derivatives, OpenGL (+Y)")
        };
        let index = self.plain(relief.name(), finish);
        let material = &mut self.materials[usize::from(index)];
        material.default_amplitude = depth;
        material.maps = vec![
            slot(0, MapRole::Albedo, "sRGB"),
            slot(1, MapRole::Height, "16-bit"),
            normal,
        ];
        index
    }

    /// Adds a material without maps; gives its index.
    pub fn plain(&mut self, name: &str, finish: Finish) -> u16 {
        self.materials.push(Material {
            ks: finish.ks,
            shininess: finish.shininess,
            reflectivity: finish.reflectivity,
            ..Material::matte(name, finish.kd)
        });
        (self.materials.len() - 1) as u16
    }

    /// Index of the first of a relief's three pictures: albedo, height, normal.
    fn pictures(&mut self, relief: Relief) -> usize {
        if let Some(&(_, first)) = self.baked.iter().find(|(r, _)| *r == relief) {
            return first;
        }
        let first = self.images.len();
        let MapSet {
            height,
            normal,
            albedo,
        } = relief.bake(relief.resolution());
        for (raw, what) in [(albedo, "albedo"), (height, "height"), (normal, "normal")] {
            let name = format!("{} {what}", relief.name());
            self.images.push(MapImage::new(name, None, raw));
        }
        self.baked.push((relief, first));
        first
    }
}
