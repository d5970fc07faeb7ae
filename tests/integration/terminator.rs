//! The smooth terminator: what it lifts, that a pixel's story is its picture, and that nobody else notices it.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec2};
use reliefscope::geometry::{Hit, Ray, TriangleAttributes, TriangleMesh};
use reliefscope::math::V3;
use reliefscope::render::{Progressive, Snapshot, Visibility, probe};
use reliefscope::scene::BentNormals;
use reliefscope::scene::load::{LoadOptions, load_model};
use reliefscope::shading::{Light, LightKind};
use reliefscope::surface::mapping::Method;
use reliefscope::surface::{Facet, FacetKind, SmoothedPoint, SurfaceParts, surface_at};

use crate::support::{bits, edited, picture};

/// A triangle with corners on the unit sphere, its normals pointing away from the middle, or into it.
fn mesh(towards: f32) -> TriangleMesh {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 1.0).normalize().as_vec3();
    let positions = vec![corner(-0.3, -0.2), corner(0.4, -0.3), corner(0.0, 0.4)];
    TriangleMesh {
        normals: positions.iter().map(|p| *p * towards).collect(),
        uvs: vec![Vec2::ZERO; 3],
        positions,
        indices: vec![[0, 1, 2]],
        attributes: vec![TriangleAttributes {
            material: 0,
            has_uv: true,
            smooth: true,
        }],
    }
}

/// The point at these weights, seen along `dir`.
fn point(mesh: &TriangleMesh, [u, v]: [f32; 2], dir: V3) -> (SmoothedPoint, V3, V3) {
    let ray = Ray {
        origin: (-dir * 3.0).into(),
        dir: dir.into(),
    };
    let hit = Hit {
        t: 1.0,
        prim: 0,
        sub: 0,
        u,
        v,
    };
    let s = surface_at(mesh, &hit, &ray, SurfaceParts::Plain);
    let kind = FacetKind {
        smooth: true,
        parts: SurfaceParts::Plain,
    };
    let facet: Facet = Facet::fetch(mesh, 0, kind);
    let behind = s.wo.dot(s.n_geo) < 0.0;
    let [normal, n_geo] = [s.n_smooth, s.n_geo].map(|n| if behind { -n } else { n });
    let point = SmoothedPoint::new(&facet, (u, v), s.p, (normal, n_geo, behind));
    (point, s.p, n_geo)
}

/// By the formula of the source, in double precision.
#[test]
fn bulging_facets_are_lifted_to_the_tangent_planes_and_hollow_ones_not_at_all() {
    let down = V3::new(0.0, 0.0, -1.0);
    for [u, v] in [[0.3, 0.3], [0.1, 0.7], [0.5, 0.5], [0.02, 0.01]] {
        let outside = mesh(1.0);
        let (found, p, n_geo) = point(&outside, [u, v], down);
        let p64 = glam::Vec3::from(p).as_dvec3();
        let expected: DVec3 = (0..3)
            .map(|i| {
                let (c, n) = (
                    outside.positions[i].as_dvec3(),
                    outside.normals[i].as_dvec3(),
                );
                let weight = f64::from([1.0 - u - v, u, v][i]);
                -n * (p64 - c).dot(n).min(0.0) * weight
            })
            .sum();
        let lift = glam::Vec3::from(found.lift).as_dvec3();
        assert!(
            (lift - expected).length() < 1e-6,
            "{lift} is not {expected}"
        );
        assert!(found.lift.dot(n_geo) > 0.0);
        // About as far as the sphere is over the facet.
        let over = 1.0 - p64.length();
        assert!(
            (0.2..3.0).contains(&(lift.length() / over)),
            "{lift} of {over}"
        );

        // From behind the same facet is hollow, and so it is with its normals turned over, seen from outside.
        let (from_behind, ..) = point(&outside, [u, v], -down);
        assert_eq!(from_behind.lift, V3::new(0.0, 0.0, 0.0));
        let (from_inside, ..) = point(&mesh(-1.0), [u, v], -down);
        assert_eq!(from_inside.lift, V3::new(0.0, 0.0, 0.0));
    }
    // On a corner there is nothing to lift.
    let (corner, ..) = point(&mesh(1.0), [0.0, 0.0], down);
    assert!(corner.lift.dot(corner.lift) < 1e-12, "{:?}", corner.lift);
}

/// A torus of few facets under a grazing sun, with the reference plane's maps.
fn torus() -> Snapshot {
    let (columns, rows) = (10, 6);
    let mut text = String::from("mtllib torus.mtl\nusemtl bricks\n");
    for (i, j) in (0..=columns).flat_map(|i| (0..=rows).map(move |j| (i, j))) {
        let [s, t] = [
            f64::from(i) / f64::from(columns),
            f64::from(j) / f64::from(rows),
        ];
        let [(sin_a, cos_a), (sin_b, cos_b)] = [s, t].map(|x| (x.fract() * TAU).sin_cos());
        let n = DVec3::new(cos_a * cos_b, sin_a * cos_b, sin_b);
        let p = DVec3::new(cos_a, sin_a, 0.0) + n * 0.4;
        text += &format!("v {} {} {}\nvn {} {} {}\n", p.x, p.y, p.z, n.x, n.y, n.z);
        text += &format!("vt {} {}\n", 7.0 * s, 3.0 * t);
    }
    for (i, j) in (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))) {
        let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
        text += "f";
        for k in corners.map(|(i, j)| i * (rows + 1) + j + 1) {
            text += &format!(" {k}/{k}/{k}");
        }
        text += "\n";
    }
    let maps = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reference");
    let map = |name: &str| maps.join(name).display().to_string();
    let (height, normal) = (map("height16.png"), map("normal.png"));
    let library = format!("newmtl bricks\nKd 0.8 0.8 0.8\nbump {height}\nnorm {normal}\n");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = folder.path().join("torus.obj");
    std::fs::write(&model, text).expect("is written");
    std::fs::write(folder.path().join("torus.mtl"), library).expect("is written");
    let loaded = load_model(&model, &LoadOptions::default()).expect("it can be read");
    let mut settings = loaded.settings;
    let sun = LightKind::Directional {
        direction: DVec3::new(-0.2, -0.8, -0.5),
    };
    settings.lights = vec![Light::new("sun", sun, 1.0)];
    settings.samples = 1;
    settings.camera.eye = DVec3::new(0.0, -2.0, 2.4);
    settings.camera.target = DVec3::ZERO;
    settings.camera.up = DVec3::Z;
    settings.camera.vfov = 0.9;
    settings.mapping.amplitude = Some(0.02);
    Snapshot {
        scene: loaded.scene,
        settings: Arc::new(settings),
        size: [64, 40],
    }
}

#[test]
fn a_pixels_story_is_its_picture() {
    let torus = torus();
    for (method, bent) in [
        (Method::None, BentNormals::Lifted),
        (Method::Normal, BentNormals::Softened),
        (Method::Relief, BentNormals::Softened),
        (Method::Displacement, BentNormals::Lifted),
    ] {
        let snapshot = edited(&torus, |s| {
            s.mapping.method = method;
            s.shading.bent_normals = bent;
            s.shading.smooth_terminator = true;
        });
        let shown = picture(&snapshot);
        for (i, pixel) in (0..).zip(&shown.pixels) {
            let place = [i % 64, i / 64];
            let story = probe(&snapshot, place).expect("inside");
            let [told, shown] = [story.color, *pixel].map(|c| c.to_array().map(f32::to_bits));
            assert_eq!(told, shown, "{}: {place:?}", method.name());
        }
        let textbook = edited(&snapshot, |s| s.shading.smooth_terminator = false);
        let pairs = bits(&shown).into_iter().zip(bits(&picture(&textbook)));
        let changed = pairs.filter(|(a, b)| a != b).count();
        // A displaced surface is no coarse mesh.
        assert_eq!(
            changed > 10,
            method != Method::Displacement,
            "{}",
            method.name()
        );
    }
}

/// What light a pixel's story lets through is what its colour has, lit facets that turn away included.
#[test]
fn the_story_tells_how_far_shadow_rays_are_lifted() {
    let torus = edited(&torus(), |s| s.mapping.method = Method::None);
    let smooth = edited(&torus, |s| s.shading.smooth_terminator = true);
    let mut lit_from_behind = 0;
    for place in (0..40).flat_map(|y| (0..64).map(move |x| [x, y])) {
        let [before, after] = [&torus, &smooth].map(|s| probe(s, place).expect("inside"));
        let (Some(old), Some(new)) = (&before.bounces[0].hit, &after.bounces[0].hit) else {
            assert_eq!(before, after, "{place:?}");
            continue;
        };
        assert_eq!(old.lifted, None);
        assert!(
            new.lifted.is_some_and(|lift| (0.0..0.2).contains(&lift)),
            "{new}"
        );
        assert!(
            new.to_string().contains("over the facet")
                && !old.to_string().contains("over the facet")
        );
        let [old, new] = [old, new].map(|hit| &hit.lights[0]);
        let is_lit = new.visibility == Visibility::Visible;
        assert_eq!(
            is_lit && new.cos_shade > 0.0,
            after.color.g > 0.0,
            "{place:?}"
        );
        lit_from_behind +=
            u32::from(is_lit && new.cos_geo <= 0.0 && old.visibility == Visibility::Behind);
    }
    assert!(lit_from_behind > 5, "{lit_from_behind}");
}

/// Where no normals are interpolated nothing changes: not a bit, not a ray, not a byte.
#[test]
fn flat_meshes_do_not_notice() {
    let mut snapshot = torus();
    let mut scene = (*snapshot.scene).clone();
    for attributes in &mut scene.mesh.attributes {
        attributes.smooth = false;
    }
    snapshot.scene = Arc::new(scene);
    let rendered = |smooth| {
        let snapshot = edited(&snapshot, |s| {
            s.samples = 1;
            s.shading.smooth_terminator = smooth;
        });
        let mut renderer = Progressive::new(1).expect("a thread");
        renderer.start(snapshot);
        renderer.pass(&|| false);
        (
            bits(&renderer.picture()),
            renderer.counters(),
            renderer.kept_bytes(),
        )
    };
    assert_eq!(rendered(false), rendered(true));
}
