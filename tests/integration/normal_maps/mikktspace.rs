//! MikkTSpace: what a baker took out of a detailed model comes back.

use std::sync::Arc;

use glam::{DMat3, DVec3, Vec2, Vec3};
use reliefscope::geometry::bvh::Bvh;
use reliefscope::geometry::{Hit, Normalization, Ray, Tangents, TriangleAttributes, TriangleMesh};
use reliefscope::math::LinearRgb;
use reliefscope::render::{Snapshot, probe};
use reliefscope::scene::{Camera, ModelFacts, RenderSettings, Scene, SceneSource, ShadingSettings};
use reliefscope::shading::{Light, LightKind, Material};
use reliefscope::surface::mapping::{
    BoundNormal, MappingSettings, MaterialMapping, MaterialMaps, Method,
};
use reliefscope::surface::{BakedFrame, SurfaceParts, surface_at};
use reliefscope::texture::{
    Addressing, MapImage, MapRole, MapSlot, NormalMap, NormalSpace, RawImage, Samples,
};

use super::same_bits_everywhere;
use crate::support::edited;

/// Texels a side of the baked map.
const SIDE: u32 = 64;
/// Degrees of longitude and latitude from the middle to the rim.
const REACH: f64 = 60.0;

/// The detailed model's normal over a direction from the middle of the ball: bumps that are mirror images left
/// and right.
fn detailed(p: DVec3) -> DVec3 {
    let p = p.normalize();
    let bumps = DVec3::new((7.0 * p.x).sin(), (5.0 * p.y).cos() * 0.6, 0.0);
    (p + 0.25 * bumps).normalize()
}

/// A piece of a ball of 4 by 4 cells. Left and right share one chart, mirrored, sheared and stretched.
fn coarse_ball() -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for side in [-1.0, 1.0] {
        let base = mesh.positions.len() as u32;
        for j in 0..=4 {
            for i in 0..=2 {
                let (lon, lat) = (f64::from(i) / 2.0, f64::from(j) / 2.0 - 1.0);
                let (a, b) = (
                    (side * lon * REACH).to_radians(),
                    (lat * REACH * 0.8).to_radians(),
                );
                let p = DVec3::new(b.cos() * a.sin(), b.sin(), b.cos() * a.cos());
                mesh.positions.push(p.as_vec3());
                mesh.normals.push(p.as_vec3());
                let v = (lat + 1.0) * 0.5;
                mesh.uvs
                    .push(Vec2::new((0.7 * lon + 0.25 * v) as f32, v as f32));
            }
        }
        for (i, j) in (0..4).flat_map(|j| (0..2).map(move |i| (i, j))) {
            let at = |i: u32, j: u32| base + j * 3 + i;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            for [p, q, r] in [[a, b, c], [a, c, d]] {
                let corners = if side > 0.0 { [p, q, r] } else { [p, r, q] };
                mesh.indices.push(corners);
                mesh.attributes.push(TriangleAttributes {
                    material: 0,
                    has_uv: true,
                    smooth: true,
                });
            }
        }
    }
    mesh
}

/// The triangle of one side that a texture coordinate falls into, with its weights.
fn covering(mesh: &TriangleMesh, uv: DVec3, right: bool) -> Option<(u32, [f64; 3])> {
    let half = mesh.len() / 2;
    let prims = if right { half..mesh.len() } else { 0..half };
    prims.into_iter().find_map(|prim| {
        let [a, b, c] = mesh.indices[prim].map(|i| mesh.uvs[i as usize].as_dvec2().extend(0.0));
        let area = (b - a).cross(c - a).z;
        let weight = |q: DVec3, r: DVec3| (q - uv).cross(r - uv).z / area;
        let weights = [weight(b, c), weight(c, a), weight(a, b)];
        let inside = weights.iter().all(|w| *w > 1e-6);
        inside.then_some((prim as u32, weights))
    })
}

/// What a baker stores for the normal `high` at a place: the exact inverse of the pixel shader that the
/// reference implementation prescribes, from the corners' own tangents, in double precision.
fn baked(mesh: &TriangleMesh, tangents: &Tangents, (prim, weights): (u32, [f64; 3])) -> DVec3 {
    let corners = mesh.indices[prim as usize].map(|i| i as usize);
    let mean =
        |value: &dyn Fn(usize) -> DVec3| (0..3).map(|k| value(k) * weights[k]).sum::<DVec3>();
    let p = mean(&|k| mesh.positions[corners[k]].as_dvec3());
    let n = mean(&|k| mesh.normals[corners[k]].as_dvec3());
    let corner = &tangents.corners()[3 * prim as usize..];
    let t = mean(&|k| Vec3::from_slice(&corner[k][..3]).as_dvec3());
    let b = n.cross(t) * f64::from(corner[0][3]);
    let frame = DMat3::from_cols(t, b, n);
    (frame.inverse() * detailed(p)).normalize()
}

/// The map of one side. Texels that no triangle covers point straight up.
fn bake(mesh: &TriangleMesh, bytes: bool) -> RawImage {
    let tangents = Tangents::new(mesh);
    let mut colors = Vec::new();
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        let place = covering(mesh, centre(x, y), true);
        let m = place.map_or(DVec3::Z, |place| baked(mesh, &tangents, place));
        colors.extend((m * 0.5 + 0.5).to_array());
    }
    let samples = if bytes {
        Samples::U8(colors.iter().map(|c| (c * 255.0).round() as u8).collect())
    } else {
        Samples::F32(colors.iter().map(|c| *c as f32).collect())
    };
    RawImage {
        width: SIDE,
        height: SIDE,
        channels: 3,
        samples,
    }
}

fn centre(x: u32, y: u32) -> DVec3 {
    let side = f64::from(SIDE);
    DVec3::new(
        (f64::from(x) + 0.5) / side,
        1.0 - (f64::from(y) + 0.5) / side,
        0.0,
    )
}

/// Mean and largest angle to the detailed model, degrees, over all texel centres of both sides.
fn errors(image: &RawImage, space: NormalSpace) -> [f64; 2] {
    let mesh = coarse_ball();
    let tangents = Tangents::new(&mesh);
    let map = NormalMap::from_image(image);
    let addressing = Addressing::from_slot(&MapSlot::new(0, MapRole::Normal));
    let normal = Some(BoundNormal {
        space,
        ..BoundNormal::new(&map, addressing)
    });
    let settings = MappingSettings {
        method: Method::Normal,
        ..MappingSettings::default()
    };
    let maps = MaterialMaps {
        normal,
        ..MaterialMaps::default()
    };
    let mapping = MaterialMapping::choose(&settings, &maps);
    let mut angles = Vec::new();
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        for right in [false, true] {
            let Some((prim, weights)) = covering(&mesh, centre(x, y), right) else {
                continue;
            };
            let [u, v] = [weights[1] as f32, weights[2] as f32];
            let hit = Hit {
                t: 1.0,
                prim,
                sub: 0,
                u,
                v,
            };
            let p = mesh.corners(prim);
            let p = p[0] * (1.0 - u - v) + p[1] * u + p[2] * v;
            let ray = Ray {
                origin: p * 2.0,
                dir: -p.normalize_or_zero(),
            };
            let mut s = surface_at(&mesh, &hit, &ray, SurfaceParts::Gradients);
            if mapping.needs_baked_frame() {
                BakedFrame::fetch((&mesh, &tangents), prim, true).place((u, v), &mut s);
            }
            mapping.apply(&mut s, true, None);
            let (found, expected) = (Vec3::from(s.n_shade).as_dvec3(), detailed(p.as_dvec3()));
            angles.push(
                found
                    .cross(expected)
                    .length()
                    .atan2(found.dot(expected))
                    .to_degrees(),
            );
        }
    }
    assert!(angles.len() > 3000, "{} places", angles.len());
    let mean = angles.iter().sum::<f64>() / angles.len() as f64;
    [mean, angles.iter().fold(0.0, |a: f64, b| a.max(*b))]
}

#[test]
fn a_baked_map_gives_the_detailed_normals_back() {
    let mesh = coarse_ball();
    let [mean, most] = errors(&bake(&mesh, false), NormalSpace::MikkTSpace);
    eprintln!("floats: mean {mean:.5}°, most {most:.5}°");
    assert!(most < 0.01, "floats: {most}°");
    // Rounding to bytes: half of 2/255 on each axis is 0.39° at the worst, a little more where the
    // interpolated frame is shorter than a unit.
    let bytes = bake(&mesh, true);
    let [mean, most] = errors(&bytes, NormalSpace::MikkTSpace);
    eprintln!("bytes: mean {mean:.3}°, most {most:.3}°");
    assert!(
        mean < 0.2 && most < 0.5,
        "bytes: mean {mean}°, most {most}°"
    );
    // The frame of each triangle by itself is another one: that is what the space is for.
    let [mean, most] = errors(&bytes, NormalSpace::Tangent);
    eprintln!("bytes in the triangles' own frames: mean {mean:.3}°, most {most:.3}°");
    assert!(mean > 0.5 && most > 2.0, "mean {mean}°, most {most}°");
}

fn snapshot(space: NormalSpace) -> Snapshot {
    let mesh = coarse_ball();
    let image = bake(&mesh, false);
    let mut material = Material::matte("ball", LinearRgb::gray(0.7));
    material.default_amplitude = 0.05;
    let mut slot = MapSlot::new(0, MapRole::Normal);
    slot.baked_amplitude = Some(0.05);
    slot.space = space;
    material.maps.push(slot);
    let sun = LightKind::Directional {
        direction: DVec3::new(0.4, -0.5, -1.0),
    };
    Snapshot {
        scene: Arc::new(Scene {
            displaced: Default::default(),
            tangents: Default::default(),
            uv_charts: Default::default(),
            name: "ball".into(),
            source: SceneSource::BuiltIn("ball".into()),
            bvh: Bvh::build(&mesh),
            mesh,
            normalization: Normalization::IDENTITY,
            images: vec![MapImage::new("normals", None, image)],
            facts: ModelFacts::default(),
        }),
        settings: Arc::new(RenderSettings {
            camera: Camera {
                eye: DVec3::new(0.0, 0.3, 4.0),
                target: DVec3::new(0.0, 0.0, 0.8),
                up: DVec3::Y,
                vfov: 26_f64.to_radians(),
            },
            lights: vec![Light::new("sun", sun, 2.0)],
            materials: vec![material],
            shading: ShadingSettings::default(),
            mapping: MappingSettings {
                method: Method::Normal,
                ..MappingSettings::default()
            },
            samples: 1,
        }),
        size: [48, 40],
    }
}

/// The whole way through the renderer, on both sides of the mirror.
#[test]
fn a_picture_shows_the_detailed_normals() {
    let snapshot = snapshot(NormalSpace::MikkTSpace);
    let mut seen = [0, 0];
    for (x, y) in (4..36)
        .step_by(3)
        .flat_map(|y| (4..44).step_by(3).map(move |x| (x, y)))
    {
        let story = probe(&snapshot, [x, y]).expect("inside");
        let Some(hit) = &story.bounces[0].hit else {
            continue;
        };
        let [u, v] = hit.uv.expect("has a chart");
        let off_rim = |c: f32, low: f32, high: f32| c > low + 0.03 && c < high - 0.03;
        // The map holds nothing beyond the chart, and look-ups mix neighbours.
        let s = (u - 0.25 * v) / 0.7;
        if !(off_rim(s, 0.0, 1.0) && off_rim(v, 0.0, 1.0)) {
            continue;
        }
        seen[usize::from(hit.p[0] > 0.0)] += 1;
        let expected = detailed(DVec3::from(hit.p));
        let found = Vec3::from(hit.n_shade).as_dvec3();
        let off = found
            .cross(expected)
            .length()
            .atan2(found.dot(expected))
            .to_degrees();
        // Between texel centres the bilinear mean differs, most where a triangle's border runs through.
        assert!(off < 1.5, "{x}, {y}: {off}°");
    }
    assert!(seen[0] > 20 && seen[1] > 20, "{seen:?}");
    same_bits_everywhere(&snapshot);
}

#[test]
fn tangents_are_made_only_where_a_material_asks() {
    let snapshot = snapshot(NormalSpace::Tangent);
    same_bits_everywhere(&snapshot);
    assert_eq!(snapshot.scene.tangents.bytes(), 0);
    let asks = edited(&snapshot, |s| {
        s.materials[0].maps[0].space = NormalSpace::MikkTSpace;
        s.mapping.method = Method::Bump;
    });
    let _ = crate::support::picture(&asks);
    assert_eq!(asks.scene.tangents.bytes(), 0, "bump reads no normal map");
    let asks = edited(&asks, |s| s.mapping.method = Method::Normal);
    let _ = crate::support::picture(&asks);
    let triangles = asks.scene.mesh.len();
    assert_eq!(asks.scene.tangents.bytes(), triangles * 3 * 16);
}

/// Where the coarse mesh is flat, both frames are the same.
#[test]
fn on_a_plane_the_spaces_agree() {
    use crate::support::{QuadScene, picture, plain_float};
    let film = |space| {
        let stored = [0.68, 0.26, 0.9];
        let mut scene = QuadScene::new().with_map(MapRole::Normal, plain_float(2, 2, stored));
        scene.uv = |p| Vec2::new(-p.x, p.y);
        scene.settings.materials[0].maps[0].space = space;
        scene.settings.mapping.method = Method::Normal;
        picture(&scene.snapshot())
    };
    let [a, b] = [NormalSpace::Tangent, NormalSpace::MikkTSpace].map(film);
    assert!(crate::support::max_difference(&a, &b) < 1e-5);
}
