//! The scene of all tests of methods: a long textured plane under a sun and a lamp.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::trees::levels;
use super::{Finding, convex};
use crate::math::LinearRgb;
use crate::render::{Counters, Picture, Progressive, Snapshot};
use crate::scene::built_in::assemble;
use crate::scene::built_in::meshes::{Vertex, WorldMesh};
use crate::scene::load::LoadOptions;
use crate::scene::{Background, Camera, RenderSettings, Scene, SceneSource, ShadingSettings};
use crate::shading::{Falloff, Light, LightKind, Material};
use crate::surface::mapping::{MappingSettings, Method};
use crate::texture::{MapImage, MapRole, MapSlot, RawImage, Samples};

/// World width of one tile.
pub(super) const TILE: f64 = 0.5;
/// Half the plane's side.
const HALF: f64 = 20.0;
/// From the eye to the middle.
const DISTANCE: f64 = 3.0;

/// A plane z = 0 with maps; everything about it may be changed before it is rendered.
#[derive(Debug, Clone)]
pub(super) struct Board {
    /// Geometry and maps. What searches make of the maps is kept from picture to picture.
    scene: Arc<Scene>,
    /// Whether all levels of the machine are compared.
    at_all_levels: bool,
    /// Everything else.
    pub settings: RenderSettings,
}

/// A picture and what it took.
#[derive(Debug)]
pub(super) struct Rendered {
    /// First samples.
    pub picture: Picture,
    /// Of those.
    pub counters: Counters,
}

impl Board {
    /// With this relief, and with normals as good as any.
    pub fn new(heights: RawImage, normals: RawImage) -> Self {
        let roles = [(MapRole::Height, heights), (MapRole::Normal, normals)];
        Self::with_maps(roles.into())
    }

    /// With these maps.
    pub fn with_maps(maps: Vec<(MapRole, RawImage)>) -> Self {
        let mut material = Material::matte("board", LinearRgb::new(0.7, 0.6, 0.5));
        material.ks = LinearRgb::new(0.3, 0.3, 0.3);
        material.shininess = 40.0;
        let mut images = Vec::new();
        for (role, raw) in maps {
            let mut slot = MapSlot::new(images.len(), role);
            slot.baked_amplitude = Some(0.05 * TILE);
            material.maps.push(slot);
            images.push(MapImage::new(role.name(), None, raw));
        }
        Self::of(scene(&plane(), images), settings(material))
    }

    /// Any scene.
    pub fn of(scene: Scene, settings: RenderSettings) -> Self {
        Self {
            scene: Arc::new(scene),
            at_all_levels: true,
            settings,
        }
    }

    /// The same maps on other geometry.
    pub fn on(self, mesh: &WorldMesh) -> Self {
        let images = self.scene.images.clone();
        Self::of(scene(mesh, images), self.settings)
    }

    /// Without the other levels: what is made of a large map is made once.
    pub fn alone(mut self) -> Self {
        self.at_all_levels = false;
        self
    }

    /// The scene at all other levels of the machine, with what the last picture made of its maps.
    fn twins(&self) -> impl Iterator<Item = Arc<Scene>> {
        let best = self.scene.bvh.level();
        let others = levels().into_iter();
        let others = others.filter(move |&level| self.at_all_levels && level != best);
        others.map(|level| Arc::new(convex::at_level(&self.scene, level)))
    }

    /// Looks at the middle, `angle` degrees off the normal; so narrow that all rays are about as slanted.
    pub fn seen_at(&mut self, angle: f64) {
        let (sin, cos) = angle.to_radians().sin_cos();
        self.settings.camera = Camera {
            eye: DVec3::new(0.1, -sin, cos) * DISTANCE,
            target: DVec3::new(0.1, 0.05, 0.0),
            up: DVec3::new(0.0, cos, sin),
            vfov: (1.6 * (90.0 - angle)).min(40.0).to_radians(),
        };
    }

    /// The method, and the relief's amplitude in widths of a tile.
    pub fn mapped(&mut self, method: Method, tiles: f64) {
        self.settings.mapping.method = method;
        self.settings.mapping.amplitude = Some(tiles * TILE);
    }

    /// One sample of each pixel.
    pub fn render(&self, side: u32) -> Rendered {
        self.render_scene(&self.scene, side)
    }

    fn render_scene(&self, scene: &Arc<Scene>, side: u32) -> Rendered {
        let snapshot = Snapshot {
            scene: Arc::clone(scene),
            settings: Arc::new(self.settings.clone()),
            size: [side; 2],
        };
        // Without a thread nothing can be looked at: no pixels.
        let Ok(mut renderer) = Progressive::new(1) else {
            return Rendered {
                picture: Picture::default(),
                counters: Counters::ZERO,
            };
        };
        renderer.start(snapshot);
        renderer.pass(&|| false);
        Rendered {
            picture: renderer.picture(),
            counters: renderer.counters(),
        }
    }
}

/// What went wrong in many pictures.
#[derive(Debug, Default)]
pub(super) struct Album {
    /// Pixels.
    pub pixels: u64,
    /// Of those, without a finite colour.
    pub non_finite: u64,
    /// Of those, different at some level.
    pub differing: u64,
}

impl Album {
    /// Renders at every level of the machine; gives back the first picture.
    pub fn add(&mut self, board: &Board, side: u32) -> Rendered {
        let first = board.render(side);
        self.pixels += first.picture.pixels.len() as u64;
        self.non_finite += first.counters.non_finite;
        for scene in board.twins() {
            let twin = board.render_scene(&scene, side);
            self.non_finite += twin.counters.non_finite;
            self.differing += convex::differing(&twin.picture, &first.picture);
        }
        first
    }

    /// None of either may be.
    pub fn finding(&self) -> Finding {
        let note = match self.differing {
            0 => String::new(),
            n => format!("{n} pixels differ between levels"),
        };
        let wrong = self.non_finite + self.differing;
        Finding::none_of(self.pixels, "non-finite pixels", wrong).with_note(note)
    }
}

/// The plane, two triangles.
pub(super) fn plane() -> WorldMesh {
    let mut mesh = WorldMesh::default();
    mesh.patch([1, 1], 0, |s, t| {
        let p = (DVec2::new(s, t) * 2.0 - 1.0) * HALF;
        Vertex {
            position: p.extend(0.0),
            normal: DVec3::Z,
            uv: p / TILE,
        }
    });
    mesh
}

/// A scene of any mesh.
fn scene(mesh: &WorldMesh, images: Vec<MapImage>) -> Scene {
    let source = SceneSource::BuiltIn("board".to_owned());
    assemble("board", source, mesh, images, &LoadOptions::default())
}

fn settings(material: Material) -> RenderSettings {
    let sun = LightKind::Directional {
        direction: DVec3::new(0.5, 0.6, -0.3),
    };
    let lamp = LightKind::Point {
        position: DVec3::new(0.3, -0.2, 0.6),
        falloff: Falloff::InverseSquare,
    };
    RenderSettings {
        camera: Camera {
            eye: DVec3::Z,
            target: DVec3::ZERO,
            up: DVec3::Y,
            vfov: 0.5,
        },
        lights: vec![Light::new("sun", sun, 1.0), Light::new("lamp", lamp, 1.0)],
        materials: vec![material],
        shading: ShadingSettings {
            background: Background::plain(LinearRgb::new(0.1, 0.1, 0.2)),
            ..ShadingSettings::default()
        },
        mapping: MappingSettings::default(),
        samples: 1,
    }
}

/// A 16-bit relief of bumps that repeats, `n × n` texels.
pub(super) fn bumps(n: u32) -> RawImage {
    grey16(n, n, |x, y| {
        let wave = |i: u32| (f64::from(i) / f64::from(n) * std::f64::consts::TAU).sin();
        0.5 + 0.25 * (wave(x) * wave(y) + wave(2 * x + y))
    })
}

/// Its twin of normals, tilted as far as 60°.
pub(super) fn tilts(n: u32) -> RawImage {
    let texel = |i: u32| {
        let (x, y) = (f64::from(i % n), f64::from(i / n));
        let turn = (x + 2.0 * y) / f64::from(n) * std::f64::consts::TAU;
        let tilt = 0.6 * turn.cos();
        let normal = DVec3::new(tilt * turn.cos(), tilt * turn.sin(), 0.8).normalize_or(DVec3::Z);
        (normal * 0.5 + 0.5).to_array().map(|c| (c * 255.0) as u8)
    };
    RawImage {
        width: n,
        height: n,
        channels: 3,
        samples: Samples::U8((0..n * n).flat_map(texel).collect()),
    }
}

/// Grey texels from a function of column and row, 0…1.
pub(super) fn grey16(width: u32, height: u32, at: impl Fn(u32, u32) -> f64) -> RawImage {
    let texel = |i: u32| (at(i % width, i / width).clamp(0.0, 1.0) * 65_535.0) as u16;
    RawImage {
        width,
        height,
        channels: 1,
        samples: Samples::U16((0..width * height).map(texel).collect()),
    }
}
