//! Heights, normals and holes by what a picture looks like.

use reliefscope::scene::load::MaterialSet;
use reliefscope::texture::{Channel, MapRole, MapSlot};

use super::fixture::{Fixture, assert_one_warning, warnings};
use super::recognition::relief::{height, normal};

pub mod relief {
    //! One relief as heights and as normals: waves with exact derivatives, tileable.

    use std::f64::consts::TAU;

    /// Height 0…1 and its derivatives by u and v (v up) at a place of the unit tile.
    fn waves(u: f64, v: f64) -> [f64; 3] {
        let (a, b) = (TAU * (2.0 * u + v), TAU * (u - 3.0 * v));
        let h = 0.5 + 0.25 * a.sin() + 0.2 * b.cos();
        let du = 0.25 * a.cos() * TAU * 2.0 - 0.2 * b.sin() * TAU;
        let dv = 0.25 * a.cos() * TAU + 0.2 * b.sin() * TAU * 3.0;
        [h, du, dv]
    }

    fn at(x: u32, y: u32, [w, h]: [u32; 2]) -> [f64; 3] {
        let u = (f64::from(x) + 0.5) / f64::from(w);
        let v = 1.0 - (f64::from(y) + 0.5) / f64::from(h);
        waves(u, v)
    }

    /// Stored height of a pixel, 16 bits.
    pub fn height(x: u32, y: u32, size: [u32; 2]) -> u16 {
        (at(x, y, size)[0] * 65_535.0).round() as u16
    }

    /// Stored normal of a pixel, 8 bits, +Y up, for an amplitude in units of the tile.
    pub fn normal(x: u32, y: u32, size: [u32; 2], amplitude: f64) -> [u8; 3] {
        let [_, du, dv] = at(x, y, size);
        let n = [-amplitude * du, -amplitude * dv, 1.0];
        let length = n.iter().map(|c| c * c).sum::<f64>().sqrt();
        n.map(|c| ((c / length * 0.5 + 0.5) * 255.0).round() as u8)
    }
}

/// Writes the waves as `h.png` (16 bits) and `n.png`, the normals through `change`.
pub fn write_pair(
    fixture: &Fixture,
    size: [u32; 2],
    amplitude: f64,
    change: fn([u8; 3]) -> [u8; 3],
) {
    let [w, h] = size;
    image::ImageBuffer::from_fn(w, h, |x, y| image::Luma([height(x, y, size)]))
        .save(fixture.path("h.png"))
        .expect("saved");
    image::RgbImage::from_fn(w, h, |x, y| {
        image::Rgb(change(normal(x, y, size, amplitude)))
    })
    .save(fixture.path("n.png"))
    .expect("saved");
}

fn flip_green([r, g, b]: [u8; 3]) -> [u8; 3] {
    [r, 255 - g, b]
}

fn slot(set: &MaterialSet, role: MapRole) -> &MapSlot {
    set.materials[0].map(role).expect("a slot in this role")
}

#[test]
fn a_bump_map_that_holds_normals() {
    let fixture = Fixture::with_library("newmtl m\nmap_Bump -bm 2 n.png\n");
    write_pair(&fixture, [64, 64], 0.05, |n| n);
    let set = fixture.load(&["m"]);
    let normal = slot(&set, MapRole::Normal);
    assert_eq!(normal.strength, 2.0);
    assert!(
        normal.note.contains("looks like a normal map"),
        "{}",
        normal.note
    );
    assert!(normal.note.contains("slopes times 2"), "{}", normal.note);
    assert!(!normal.flip_green);
    assert_one_warning(&set, &["m.mtl:2", "looks like a normal map"]);
    assert!(set.materials[0].map(MapRole::Height).is_none());
}

#[test]
fn a_bump_map_that_holds_heights() {
    let fixture = Fixture::with_library(
        "newmtl m\nmap_Bump h.png\nnewmtl n\nmap_bump c.png\nnewmtl o\nbump g.png\n",
    );
    write_pair(&fixture, [64, 64], 0.05, |n| n);
    // Bricks: reddish, then grey in three channels with a little noise.
    fixture.rgb("c.png", |x, y| [180, (60 + (x * 5 + y * 3) % 50) as u8, 40]);
    fixture.rgb("g.png", |x, y| {
        [(x * 7 + y) as u8; 3].map(|c| c.saturating_add((y % 2) as u8))
    });
    let set = fixture.load(&["m", "n", "o"]);
    for material in &set.materials {
        assert!(material.map(MapRole::Height).is_some(), "{}", material.name);
    }
    let note = &slot(&set, MapRole::Height).note;
    assert!(note.contains("16-bit grey, 64×64"), "{note}");
    assert_one_warning(&set, &["colour picture", "c.png"]);
}

#[test]
fn norm_is_a_normal_map_unless_grey() {
    let fixture = Fixture::with_library("newmtl m\nnorm n.png\nnewmtl o\nnorm h.png\n");
    write_pair(&fixture, [64, 64], 0.05, |n| n);
    let set = fixture.load(&["m", "o"]);
    assert!(!slot(&set, MapRole::Normal).flip_green);
    assert!(set.materials[1].map(MapRole::Height).is_some());
    assert_one_warning(&set, &["m.mtl:4", "grey"]);
}

#[test]
fn a_flat_normal_map_is_one() {
    let fixture = Fixture::with_library("newmtl m\nbump n.png\n");
    fixture.rgb("n.png", |_, _| [128, 128, 255]);
    assert_eq!(
        fixture.load(&["m"]).materials[0].maps[0].role,
        MapRole::Normal
    );
    let fixture = Fixture::with_library("newmtl m\nbump n.png\n");
    fixture.rgb("n.png", |_, _| [0, 0, 255]);
    assert_eq!(
        fixture.load(&["m"]).materials[0].maps[0].role,
        MapRole::Height
    );
}

#[test]
fn green_is_told_against_the_heights() {
    for (change, flipped) in [(flip_green as fn(_) -> _, true), (|n| n, false)] {
        let fixture = Fixture::with_library("newmtl m\nmap_Bump h.png\nnorm n.png\n");
        write_pair(&fixture, [64, 64], 0.05, change);
        let set = fixture.load(&["m"]);
        let normal = slot(&set, MapRole::Normal);
        assert_eq!(normal.flip_green, flipped);
        assert_eq!(normal.note.contains("green grows downwards"), flipped);
        if flipped {
            assert_one_warning(&set, &["m.mtl:3", "green grows downwards"]);
        } else {
            assert_eq!(warnings(&set), [""; 0]);
        }
    }
}

#[test]
fn inverted_heights_do_not_pass_for_a_flipped_green() {
    // Red and green both turned: the relief is inside out, the convention is +Y up.
    let inside_out = |[r, g, b]: [u8; 3]| [255 - r, 255 - g, b];
    let fixture = Fixture::with_library("newmtl m\nmap_Bump h.png\nnorm n.png\n");
    write_pair(&fixture, [64, 64], 0.05, inside_out);
    let set = fixture.load(&["m"]);
    assert!(!slot(&set, MapRole::Normal).flip_green);
    assert_one_warning(&set, &["opposite reliefs"]);
}

#[test]
fn strangers_are_not_compared() {
    let fixture = Fixture::with_library("newmtl m\nmap_Bump h.png\nnorm n.png\n");
    write_pair(&fixture, [64, 64], 0.05, |n| n);
    // Normals of quite another relief, along u only.
    image::RgbImage::from_fn(64, 64, |x, _| {
        let s = (f64::from(x) * 0.9).sin() * 0.5;
        image::Rgb([
            (s * 127.0 + 128.0) as u8,
            128,
            ((1.0 - s * s).sqrt() * 127.0 + 128.0) as u8,
        ])
    })
    .save(fixture.path("n.png"))
    .expect("saved");
    let set = fixture.load(&["m"]);
    let normal = slot(&set, MapRole::Normal);
    assert!(!normal.flip_green);
    assert!(normal.note.contains("does not match"), "{}", normal.note);
}

#[test]
fn holes_come_from_a_mask_or_from_alpha() {
    let fixture = Fixture::with_library(
        "newmtl mask\nmap_d mask.png\nnewmtl alpha\nmap_d alpha.png\nnewmtl both\nmap_Kd leaf.png\nmap_d leaf.png\n\
         newmtl chosen\nmap_d -imfchan r leaf.png\nnewmtl solid\nmap_d solid.png\nnewmtl tr\nmap_Tr mask.png\n",
    );
    let hole = |x: u32, y: u32| {
        if (x / 8 + y / 8).is_multiple_of(2) {
            0
        } else {
            255
        }
    };
    fixture.rgb("mask.png", |x, y| [hole(x, y); 3]);
    fixture.rgb("solid.png", |_, _| [255; 3]);
    let rgba = |name: &str, color: fn(u32, u32) -> [u8; 3]| {
        let picture = image::RgbaImage::from_fn(32, 32, |x, y| {
            let [r, g, b] = color(x, y);
            image::Rgba([r, g, b, hole(x, y)])
        });
        picture.save(fixture.path(name)).expect("saved");
    };
    rgba("alpha.png", |_, _| [255; 3]);
    rgba("leaf.png", |x, y| [x as u8 * 4, y as u8 * 8, 20]);
    let set = fixture.load(&["mask", "alpha", "both", "chosen", "solid", "tr"]);
    let channels: Vec<_> = set
        .materials
        .iter()
        .map(|m| m.map(MapRole::Opacity).map(|s| (s.channel, s.invert)))
        .collect();
    let expected = [
        Some((Channel::Luma, false)),
        Some((Channel::Alpha, false)),
        Some((Channel::Alpha, false)),
        Some((Channel::R, false)),
        None,
        Some((Channel::Luma, true)),
    ];
    assert_eq!(channels, expected);
    assert!(set.materials[4].maps[0].note.contains("no holes"));
    // The red channel of the leaf stays below one half.
    assert_one_warning(&set, &["invisible"]);
}
