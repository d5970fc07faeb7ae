//! Amplitudes that files leave open.

use glam::{DVec3, Vec2, Vec3};
use reliefscope::geometry::{Normalization, TriangleAttributes, TriangleMesh};
use reliefscope::scene::load::{MaterialSet, fill_default_amplitudes};
use reliefscope::texture::MapRole;

use super::fixture::Fixture;
use super::recognition::write_pair;

/// World units per internal unit are 1/4.
const HALVED_TWICE: Normalization = Normalization {
    center: DVec3::ZERO,
    scale: 0.25,
};

/// Quads in the plane z = 0, each of the given world size with the given repeats of the texture.
fn quads(sizes: &[([f32; 2], [f32; 2])]) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for &([w, h], [u, v]) in sizes {
        let base = mesh.positions.len() as u32;
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            mesh.positions.push(Vec3::new(x * w, y * h, 0.0) * 0.25);
            mesh.uvs.push(Vec2::new(x * u, y * v));
        }
        for corners in [[0, 1, 2], [0, 2, 3]] {
            mesh.indices.push(corners.map(|c| base + c));
            mesh.attributes.push(TriangleAttributes {
                has_uv: true,
                ..TriangleAttributes::default()
            });
        }
    }
    mesh
}

fn filled(library: &str, mesh: &TriangleMesh) -> (MaterialSet, Vec<String>) {
    let fixture = Fixture::with_library(library);
    write_pair(&fixture, [256, 256], 0.05, |n| n);
    let mut set = fixture.load(&["m"]);
    let notes = fill_default_amplitudes(&mut set.materials, &set.images, mesh, &HALVED_TWICE);
    (set, notes)
}

fn assert_close(got: f64, expected: f64, tolerance: f64) {
    let error = (got / expected - 1.0).abs();
    assert!(error <= tolerance, "{got} instead of {expected}");
}

#[test]
fn two_percent_of_the_median_tile() {
    // A large wall with tiles of 8 × 2 and many small stray faces with other tiles.
    let mut sizes = vec![([80.0, 40.0], [10.0, 20.0])];
    sizes.extend([([1.0, 1.0], [100.0, 100.0]); 50]);
    sizes.extend([([1.0, 1.0], [0.0, 1.0]); 50]);
    let (set, notes) = filled("newmtl m\nmap_Bump h.png\n", &quads(&sizes));
    assert_close(set.materials[0].default_amplitude, 0.02 * 4.0, 1e-6);
    assert_eq!(notes.len(), 1);
    assert!(notes[0].contains("0.0800 is 2 %"), "{notes:?}");
}

#[test]
fn given_amplitudes_stay() {
    let mesh = quads(&[([4.0, 4.0], [1.0, 1.0])]);
    let (set, notes) = filled("newmtl m\nmap_Bump -bm 0.3 h.png\n", &mesh);
    assert_eq!(set.materials[0].default_amplitude, f64::from(0.3_f32));
    assert_eq!(notes, [""; 0]);
    let (set, notes) = filled("newmtl m\nKd 1 1 1\n", &mesh);
    assert_close(set.materials[0].default_amplitude, 0.08, 1e-6);
    assert_eq!(notes, [""; 0], "nothing to say without relief");
}

#[test]
fn without_coordinates_there_is_no_relief() {
    let mut mesh = quads(&[([4.0, 4.0], [1.0, 1.0])]);
    for attributes in &mut mesh.attributes {
        attributes.has_uv = false;
    }
    let (set, notes) = filled("newmtl m\nnorm n.png\n", &mesh);
    assert_eq!(set.materials[0].default_amplitude, 0.0);
    assert_eq!(set.materials[0].maps[0].baked_amplitude, None);
    assert!(notes[0].contains("no usable texture coordinates"));
}

#[test]
fn the_baked_amplitude_is_recovered() {
    let cases = [
        (
            "newmtl m\nmap_Bump -bm 0.7 h.png\nnorm n.png\n",
            0.05 * 12.0,
        ),
        (
            "newmtl m\nmap_Bump h.png\nnorm -bm 2 n.png\n",
            0.05 * 12.0 / 2.0,
        ),
        (
            "newmtl m\nmap_Bump -s 2 2 h.png\nnorm -s 2 2 n.png\n",
            0.05 * 6.0,
        ),
        (
            "newmtl m\nmap_Bump -mm 0.2 0.5 h.png\nnorm n.png\n",
            0.1 * 12.0,
        ),
    ];
    // Tiles of 18 × 8, so 12 on the (geometric) average.
    let mesh = quads(&[([36.0, 16.0], [2.0, 2.0])]);
    for (library, expected) in cases {
        let (set, _) = filled(library, &mesh);
        let normal = set.materials[0].map(MapRole::Normal).expect("normals");
        let baked = normal.baked_amplitude.expect("filled in");
        assert_close(baked, expected, 0.02);
        assert!(normal.note.contains("estimated against"), "{}", normal.note);
    }
}

#[test]
fn without_heights_normals_carry_the_amplitude_at_load() {
    let mesh = quads(&[([4.0, 4.0], [1.0, 1.0])]);
    let (set, notes) = filled("newmtl m\nnorm -bm 0.5 n.png\n", &mesh);
    let material = &set.materials[0];
    assert_close(material.default_amplitude, 0.08, 1e-6);
    assert_close(
        material.maps[0].baked_amplitude.expect("filled in"),
        0.16,
        1e-6,
    );
    assert_eq!(notes.len(), 1);
}

#[test]
fn pictures_of_other_sizes_compare() {
    let fixture = Fixture::with_library("newmtl m\nmap_Bump h.png\nnorm n.png\n");
    write_pair(&fixture, [512, 256], 0.03, |n| n);
    let large = fixture.path("h.png");
    write_pair(&fixture, [128, 128], 0.03, |n| n);
    // Keep the small normals, take the heights of twice the resolution per side.
    image::ImageBuffer::from_fn(256, 256, |x, y| {
        image::Luma([super::recognition::relief::height(x, y, [256, 256])])
    })
    .save(large)
    .expect("saved");
    let mut set = fixture.load(&["m"]);
    let mesh = quads(&[([1.0, 1.0], [1.0, 1.0])]);
    fill_default_amplitudes(&mut set.materials, &set.images, &mesh, &HALVED_TWICE);
    let normal = set.materials[0].map(MapRole::Normal).expect("normals");
    assert_close(normal.baked_amplitude.expect("filled in"), 0.03, 0.05);
}
