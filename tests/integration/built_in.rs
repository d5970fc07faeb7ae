//! Generated scenes and maps: complete, seamless, consistent, and the same everywhere.

use std::collections::HashSet;
use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec2, Vec3};
use reliefscope::geometry::Normalization;
use reliefscope::math::V2;
use reliefscope::scene::built_in::maps::{Dual, MapSet, Relief, bake};
use reliefscope::scene::built_in::{SCENES, built_in, default_name, meshes};
use reliefscope::scene::load::LoadOptions;
use reliefscope::scene::{LoadedScene, SceneSource};
use reliefscope::shading::LightKind;
use reliefscope::texture::{Addressing, Channel, MapRole, RawImage, Samples};

#[test]
fn scenes_have_distinct_kebab_case_names() {
    let names: HashSet<_> = SCENES.iter().map(|info| info.name).collect();
    assert_eq!(names.len(), SCENES.len());
    assert!(names.contains(default_name()));
    for info in SCENES {
        let kebab = |c: char| c.is_ascii_lowercase() || c == '-';
        assert!(info.name.chars().all(kebab), "{}", info.name);
        assert!(info.summary.ends_with('.') && !info.label.is_empty());
    }
    assert!(built_in("no-such-scene", &LoadOptions::default()).is_none());
}

#[test]
fn every_scene_is_complete() {
    for info in SCENES {
        let loaded = built_in(info.name, &LoadOptions::default()).expect(info.name);
        assert_eq!(
            loaded.scene.source,
            SceneSource::BuiltIn(info.name.to_owned())
        );
        assert!(loaded.warnings.is_empty());
        check_mesh(info.name, &loaded);
        check_materials(info.name, &loaded);
        check_lights_and_camera(info.name, &loaded);
    }
}

fn check_mesh(name: &str, loaded: &LoadedScene) {
    let (scene, mesh) = (&loaded.scene, &loaded.scene.mesh);
    assert_eq!(mesh.positions.len(), mesh.normals.len(), "{name}");
    assert_eq!(mesh.positions.len(), mesh.uvs.len(), "{name}");
    assert_eq!(mesh.indices.len(), mesh.attributes.len(), "{name}");
    assert!(mesh.positions.iter().all(|p| p.is_finite()), "{name}");
    assert!(mesh.uvs.iter().all(|uv: &Vec2| uv.is_finite()), "{name}");
    for n in &mesh.normals {
        assert!((n.length() - 1.0).abs() < 1e-6, "{name}: normal {n}");
    }
    for (corners, attributes) in mesh.indices.iter().zip(&mesh.attributes) {
        assert!(attributes.has_uv && attributes.smooth);
        assert!(usize::from(attributes.material) < loaded.settings.materials.len());
        let [a, b, c] = corners.map(|i| mesh.positions[i as usize].as_dvec3());
        let area = (b - a).cross(c - a);
        let normals: Vec3 = corners.iter().map(|&i| mesh.normals[i as usize]).sum();
        assert!(
            area.dot(normals.as_dvec3()) > 0.0,
            "{name}: a triangle faces away from its normals"
        );
    }
    let facts = &scene.facts;
    assert_eq!(facts.triangles - facts.degenerate, mesh.len(), "{name}");
    assert_eq!(facts.degenerate, 0, "{name}");
    let [min, max] = facts.bounds.unwrap();
    let extent = (max - min).max_element() * scene.normalization.scale;
    assert!(
        (1.0..2.0).contains(&extent),
        "{name}: internal extent {extent}"
    );
    scene.bvh.validate(mesh).unwrap();
}

fn check_materials(name: &str, loaded: &LoadedScene) {
    let used: HashSet<_> = loaded
        .scene
        .mesh
        .attributes
        .iter()
        .map(|a| usize::from(a.material))
        .collect();
    for (index, material) in loaded.settings.materials.iter().enumerate() {
        let what = format!("{name}: {}", material.name);
        assert!(used.contains(&index), "{what} is on no triangle");
        for (kd, ks) in material
            .kd
            .to_array()
            .into_iter()
            .zip(material.ks.to_array())
        {
            assert!(kd + ks <= 1.0 + 1e-6, "{what} makes energy");
        }
        if material.maps.is_empty() {
            continue;
        }
        assert!(material.default_amplitude > 0.0, "{what}");
        for (role, bits, channels) in [
            (MapRole::Albedo, 8, 3),
            (MapRole::Height, 16, 1),
            (MapRole::Normal, 8, 3),
        ] {
            let slot = material.map(role).unwrap();
            let image = &loaded.scene.images[slot.image].raw;
            assert_eq!((image.bits(), image.channels), (bits, channels), "{what}");
            assert!(slot.note.starts_with("generated: "), "{what}");
            assert_eq!(slot.baked_amplitude.is_some(), role == MapRole::Normal);
        }
    }
    assert!(loaded.settings.materials.len() >= used.len());
}

fn check_lights_and_camera(name: &str, loaded: &LoadedScene) {
    let lights = &loaded.settings.lights;
    let ambient = |kind: &LightKind| *kind == LightKind::Ambient;
    assert!(lights.iter().filter(|l| ambient(&l.kind)).count() <= 1);
    assert!(lights.iter().any(|l| !ambient(&l.kind)), "{name} is dark");
    let names: HashSet<_> = lights.iter().map(|l| &l.name).collect();
    assert_eq!(names.len(), lights.len(), "{name}: lights share a name");
    let camera = loaded.settings.camera;
    assert!(camera.distance() > 0.0 && camera.up == DVec3::Z);
    assert!((0.4..0.8).contains(&camera.vfov), "{name}");
}

#[test]
fn coordinates_are_kept_on_request() {
    let options = LoadOptions {
        normalize: false,
        ..LoadOptions::default()
    };
    let loaded = built_in("torus-study", &options).unwrap();
    assert_eq!(loaded.scene.normalization, Normalization::IDENTITY);
    assert_eq!(loaded.scene.mesh.len(), 102_400);
    let bounds = loaded.scene.mesh.bounds();
    assert!((bounds.max - Vec3::new(1.4, 1.4, 0.4)).length() < 1e-6);
}

#[test]
fn shapes_have_the_area_of_their_formula() {
    let area = |mesh: &meshes::WorldMesh| -> f64 {
        let twice = mesh.indices.iter().map(|&t| mesh.area_vector(t).length());
        twice.sum::<f64>() / 2.0
    };
    let half = DVec3::new(0.5, 0.4, 0.3);
    // A rounded box is the inner box's faces, quarter cylinders on its edges and one sphere's corners.
    let (inner, r) = (half - 0.05, 0.05);
    let rounded = 8.0 * (inner.x * inner.y + inner.y * inner.z + inner.z * inner.x)
        + TAU * r * (2.0 * (inner.x + inner.y + inner.z))
        + 4.0 * PI * r * r;
    let cases = [
        (
            area(&meshes::torus([1.0, 0.4], [320, 160], [7.0, 3.0], 0)),
            4.0 * PI * PI * 0.4,
        ),
        (
            area(&meshes::sphere(0.7, 256, [1.0; 2], 0)),
            4.0 * PI * 0.49,
        ),
        (area(&meshes::disc(0.5, 256, 0)), PI * 0.25),
        (area(&meshes::bevelled_box(half, 0.05, 1.0, 0)), rounded),
        (
            area(&meshes::quad(
                DVec3::ONE,
                [DVec3::X * 2.0, DVec3::Z * 3.0],
                1.0,
                0,
            )),
            6.0,
        ),
        (
            area(&meshes::revolve(
                &[meshes::Curve::line([0.5, 0.0], [0.5, 2.0])],
                256,
                [1.0; 2],
                0,
            )),
            TAU,
        ),
    ];
    for (i, (is, should)) in cases.into_iter().enumerate() {
        assert!(
            (is / should - 1.0).abs() < 2e-3,
            "case {i}: {is} for {should}"
        );
    }
}

#[test]
fn normals_of_curved_shapes_are_those_of_their_triangles() {
    let p = glam::DVec2::new;
    let vase = [meshes::Curve([
        p(0.2, 0.0),
        p(0.5, 0.2),
        p(0.1, 0.5),
        p(0.3, 1.0),
    ])];
    for (what, mesh) in [
        ("shaft", meshes::fluted_shaft(2.4, [0.3, 0.24], 20, 1.0, 0)),
        ("vase", meshes::revolve(&vase, 128, [2.0, 1.0], 0)),
        ("box", meshes::bevelled_box(DVec3::ONE, 0.2, 1.0, 0)),
    ] {
        for &corners in &mesh.indices {
            let face = mesh.area_vector(corners).normalize();
            for i in corners {
                let angle = mesh.vertices[i as usize].normal.angle_between(face);
                assert!(angle < 0.22, "{what}: {angle} rad between normal and face");
            }
        }
    }
}

/// Places spread evenly over the tile, none on a texel or cell border.
fn places(count: u32) -> impl Iterator<Item = (f64, f64)> {
    // The plastic number's powers make a low-discrepancy sequence (Roberts 2018).
    (1..=count).map(|i| {
        let i = f64::from(i);
        (
            (i * 0.754_877_666_246_692_8).fract(),
            (i * 0.569_840_290_998_053_3).fract(),
        )
    })
}

#[test]
fn maps_have_no_seam() {
    let near = 1e-9;
    for relief in Relief::ALL {
        let pattern = relief.pattern();
        let at = |u: f64, v: f64| pattern.texel(Dual::u(u), Dual::v(v));
        for (s, _) in places(300) {
            for (a, b) in [
                (at(near, s), at(1.0 - near, s)),
                (at(s, near), at(s, 1.0 - near)),
            ] {
                let step = (a.height.value - b.height.value).abs();
                assert!(step < 1e-5, "{}: step of {step} at {s}", relief.name());
                for (x, y) in a.paint.0.into_iter().zip(b.paint.0) {
                    // Colours may change from block to block, but not in the joint where tiles meet.
                    assert!((x - y).abs() < 2e-3, "{}: colour at {s}", relief.name());
                }
            }
        }
        let (inside, outside) = (at(0.3, 0.6), at(3.3, -1.4));
        let moved = (inside.height.value - outside.height.value).abs();
        assert!(moved < 1e-9, "{}: not periodic", relief.name());
    }
}

#[test]
fn derivatives_are_exact() {
    const STEP: f64 = 1e-6;
    for relief in Relief::ALL {
        let pattern = relief.pattern();
        let height = |u: f64, v: f64| pattern.texel(Dual::u(u), Dual::v(v)).height.value;
        let mut wrong = 0;
        for (u, v) in places(2000) {
            let exact = pattern.texel(Dual::u(u), Dual::v(v)).height;
            let du = (height(u + STEP, v) - height(u - STEP, v)) / (2.0 * STEP);
            let dv = (height(u, v + STEP) - height(u, v - STEP)) / (2.0 * STEP);
            let error = (du - exact.du).abs().max((dv - exact.dv).abs());
            wrong += u32::from(error > 1e-4 * (1.0 + exact.du.abs() + exact.dv.abs()));
        }
        // Differences across a kink (crossing canes, ridges) are wrong, but a kink is a line.
        assert!(wrong <= 4, "{}: {wrong} of 2000 differ", relief.name());
    }
}

#[test]
fn heights_use_the_range() {
    for relief in Relief::ALL {
        let pattern = relief.pattern();
        let heights = places(4000).map(|(u, v)| pattern.texel(Dual::u(u), Dual::v(v)).height.value);
        let (low, high) = heights.fold((9.0_f64, -9.0_f64), |(l, h), x| (l.min(x), h.max(x)));
        assert!(
            low >= 0.0 && high <= 1.0,
            "{}: {low} to {high}",
            relief.name()
        );
        assert!(high - low > 0.5, "{}: {low} to {high}", relief.name());
    }
}

#[test]
fn normal_map_is_the_derivative_of_the_heights() {
    const SIZE: u32 = 96;
    for relief in Relief::ALL {
        let pattern = relief.pattern();
        let maps = bake(pattern.as_ref(), SIZE, relief.amplitude());
        for y in 0..SIZE {
            for x in 0..SIZE {
                let u = (f64::from(x) + 0.5) / f64::from(SIZE);
                let v = 1.0 - (f64::from(y) + 0.5) / f64::from(SIZE);
                let h = pattern.texel(Dual::u(u), Dual::v(v)).height;
                let a = relief.amplitude();
                let normal = DVec3::new(-a * h.du, -a * h.dv, 1.0).normalize();
                let stored =
                    [0, 1, 2].map(|c| f64::from(maps.normal.fraction(x, y, c)) * 2.0 - 1.0);
                let error = (DVec3::from(stored) - normal).abs().max_element();
                assert!(
                    error < 1.01 / 255.0,
                    "{} at {x}, {y}: {error}",
                    relief.name()
                );
                let stored = f64::from(maps.height.fraction(x, y, 0));
                assert!((stored - h.value).abs() < 0.51 / 65_535.0 + 1e-6);
            }
        }
    }
}

#[test]
fn normal_map_agrees_with_the_stored_heights() {
    // Through the program's own look-ups: direction of v, sign of green, scale of the slopes.
    let relief = Relief::Waves;
    let maps = relief.bake(256);
    let images =
        [maps.height, maps.normal].map(|raw| reliefscope::texture::MapImage::new("map", None, raw));
    let slot = reliefscope::texture::MapSlot::new(0, MapRole::Height);
    let address = Addressing::from_slot(&slot);
    for (u, v) in places(500) {
        let st = address.st(V2::new(u as f32, v as f32));
        let slope = images[0]
            .height(Channel::Luma)
            .central_slope(st, address.wrap);
        let by_uv = Vec2::from(slope) * address.scale * relief.amplitude() as f32;
        let from_heights = Vec3::new(-by_uv.x, -by_uv.y, 1.0);
        let from_normals = Vec3::from(images[1].normal().sample(st, address.wrap));
        let angle = from_heights.angle_between(from_normals).to_degrees();
        assert!(angle < 0.6, "{angle} degrees apart at {u}, {v}");
    }
}

#[test]
fn maps_are_the_same_everywhere() {
    // FNV-1a over height, normal and albedo at 64 texels a side. A change here changes every picture of
    // the built-in scenes: change it knowingly.
    let expected: [(&str, u64); 12] = [
        ("bricks", 0x4263_0be0_093b_1e8c),
        ("cobble", 0xe339_7698_93a9_a38a),
        ("tiles", 0x26e3_50f6_ca87_8199),
        ("waves", 0x2795_48d4_ab50_8e1f),
        ("ripple", 0xe72b_2256_9f92_e0dd),
        ("hammered", 0xef40_931e_f1c8_d460),
        ("weave", 0xf50f_84f8_3be4_c6d1),
        ("terrain", 0x6d1c_c65b_9d87_c5ed),
        ("orange-peel", 0xc5b7_ad74_a1a9_3c88),
        ("rivets", 0xbd4e_1389_0956_e688),
        ("tread", 0x0f8e_de12_84a7_7f65),
        ("medallion", 0x65f8_5818_3041_31d9),
    ];
    let found = Relief::ALL.map(|relief| (relief.name(), checksum(&relief.bake(64))));
    assert_eq!(found, expected, "{found:#018x?}");
}

fn checksum(maps: &MapSet) -> u64 {
    let bytes = |image: &RawImage| -> Vec<u8> {
        match &image.samples {
            Samples::U8(s) => s.clone(),
            Samples::U16(s) => s.iter().flat_map(|x| x.to_le_bytes()).collect(),
            Samples::F32(_) => Vec::new(),
        }
    };
    [&maps.height, &maps.normal, &maps.albedo]
        .into_iter()
        .flat_map(bytes)
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
}
