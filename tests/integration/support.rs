//! Small scenes that tests build by hand.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use image::ImageFormat;
use reliefscope::geometry::bvh::Bvh;
use reliefscope::geometry::{Normalization, TriangleAttributes, TriangleMesh};
use reliefscope::math::LinearRgb;
use reliefscope::render::{PassEnd, Picture, Progressive, Snapshot};
use reliefscope::scene::{Camera, ModelFacts, RenderSettings, Scene, SceneSource, ShadingSettings};
use reliefscope::shading::{Falloff, Light, LightKind, Material};
use reliefscope::surface::mapping::MappingSettings;
use reliefscope::texture::{MapImage, MapRole, MapSlot, RawImage, Samples};

/// Pictures that are read, by the ending of their names.
pub const PICTURE_FORMATS: [(&str, ImageFormat); 9] = [
    ("png", ImageFormat::Png),
    ("jpg", ImageFormat::Jpeg),
    ("tga", ImageFormat::Tga),
    ("bmp", ImageFormat::Bmp),
    ("tif", ImageFormat::Tiff),
    ("hdr", ImageFormat::Hdr),
    ("exr", ImageFormat::OpenExr),
    ("webp", ImageFormat::WebP),
    ("gif", ImageFormat::Gif),
];

/// A 2×2 quad in the plane z = 0 that faces +z, its texture coordinates an affine map of x and y, with a
/// smaller one floating above it that casts a shadow.
pub struct QuadScene {
    pub images: Vec<MapImage>,
    pub settings: RenderSettings,
    /// Texture coordinate of a corner from its place.
    pub uv: fn(Vec2) -> Vec2,
    pub size: [u32; 2],
}

pub fn unit_uv(p: Vec2) -> Vec2 {
    (p + Vec2::ONE) * 0.5
}

impl QuadScene {
    pub fn new() -> Self {
        let camera = Camera {
            eye: DVec3::new(0.3, -2.0, 2.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            vfov: 50_f64.to_radians(),
        };
        let mut material = Material::matte("wall", LinearRgb::new(0.8, 0.6, 0.4));
        material.default_amplitude = 0.05;
        let sun = LightKind::Directional {
            direction: DVec3::new(0.7, -0.3, -0.65),
        };
        let lamp = LightKind::Point {
            position: DVec3::new(-0.6, -0.5, 0.9),
            falloff: Falloff::InverseSquare,
        };
        let settings = RenderSettings {
            camera,
            lights: vec![
                Light::new("sky", LightKind::Ambient, 0.1),
                Light::new("sun", sun, 2.0),
                Light::new("lamp", lamp, 1.0),
            ],
            materials: vec![material],
            shading: ShadingSettings::default(),
            mapping: MappingSettings::default(),
            samples: 4,
        };
        Self {
            images: Vec::new(),
            settings,
            uv: unit_uv,
            size: [48, 40],
        }
    }

    /// Lays a picture on the material.
    pub fn with_map(mut self, role: MapRole, image: RawImage) -> Self {
        let mut slot = MapSlot::new(self.images.len(), role);
        slot.baked_amplitude = Some(0.05);
        self.images.push(MapImage::new(role.name(), None, image));
        self.settings.materials[0].maps.push(slot);
        self
    }

    pub fn snapshot(self) -> Snapshot {
        let uv = self.uv;
        let mut mesh = TriangleMesh::default();
        for (half, z) in [(1.0, 0.0), (0.2, 0.4)] {
            let base = mesh.positions.len() as u32;
            for corner in [
                Vec2::new(-half, -half),
                Vec2::new(half, -half),
                Vec2::new(half, half),
                Vec2::new(-half, half),
            ] {
                mesh.positions.push(corner.extend(z));
                mesh.uvs.push(uv(corner));
                mesh.normals.push(Vec3::Z);
            }
            for triangle in [[0, 1, 2], [0, 2, 3]] {
                mesh.indices.push(triangle.map(|i| base + i));
                mesh.attributes.push(TriangleAttributes {
                    material: 0,
                    has_uv: true,
                    smooth: true,
                });
            }
        }
        let scene = Scene {
            displaced: Default::default(),
            tangents: Default::default(),
            uv_charts: Default::default(),
            name: "quad".into(),
            source: SceneSource::BuiltIn("quad".into()),
            bvh: Bvh::build(&mesh),
            mesh,
            normalization: Normalization::IDENTITY,
            images: self.images,
            facts: ModelFacts::default(),
        };
        Snapshot {
            scene: Arc::new(scene),
            settings: Arc::new(self.settings),
            size: self.size,
        }
    }
}

/// Changes the settings of a snapshot.
pub fn edited(snapshot: &Snapshot, edit: impl FnOnce(&mut RenderSettings)) -> Snapshot {
    let mut settings = (*snapshot.settings).clone();
    edit(&mut settings);
    Snapshot {
        settings: Arc::new(settings),
        ..snapshot.clone()
    }
}

/// All passes on so many threads.
pub fn converged(snapshot: &Snapshot, threads: usize) -> Progressive {
    let mut renderer = Progressive::new(threads).expect("threads");
    renderer.start(snapshot.clone());
    while !renderer.is_converged() {
        assert_eq!(renderer.pass(&|| false), PassEnd::Complete);
    }
    renderer
}

pub fn picture(snapshot: &Snapshot) -> Picture {
    converged(snapshot, 2).picture()
}

/// Bits of all channels: pictures must agree in these, not about.
pub fn bits(picture: &Picture) -> Vec<[u32; 3]> {
    picture
        .pixels
        .iter()
        .map(|c| c.to_array().map(f32::to_bits))
        .collect()
}

/// A 16-bit height map from a function of the texel centre (s right, t down, both 0…1).
pub fn heights(width: u32, height: u32, f: impl Fn(f32, f32) -> f32) -> RawImage {
    let value = |x: u32, y: u32| {
        f(
            (x as f32 + 0.5) / width as f32,
            (y as f32 + 0.5) / height as f32,
        )
    };
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let samples = texels
        .map(|(x, y)| (value(x, y) * 65_535.0).round() as u16)
        .collect();
    RawImage {
        width,
        height,
        channels: 1,
        samples: Samples::U16(samples),
    }
}

/// An 8-bit RGB picture of one colour.
pub fn plain_rgb(width: u32, height: u32, rgb: [u8; 3]) -> RawImage {
    let samples = rgb.repeat(width as usize * height as usize);
    RawImage {
        width,
        height,
        channels: 3,
        samples: Samples::U8(samples),
    }
}

/// A float RGB picture of one colour: exact normals.
pub fn plain_float(width: u32, height: u32, rgb: [f32; 3]) -> RawImage {
    let samples = rgb.repeat(width as usize * height as usize);
    RawImage {
        width,
        height,
        channels: 3,
        samples: Samples::F32(samples),
    }
}

/// Largest difference of a channel.
pub fn max_difference(a: &Picture, b: &Picture) -> f32 {
    let channels = |p: &Picture| {
        p.pixels
            .iter()
            .flat_map(|c| c.to_array())
            .collect::<Vec<_>>()
    };
    channels(a)
        .iter()
        .zip(channels(b))
        .map(|(x, y)| (x - y).abs())
        .fold(0.0, f32::max)
}
