//! The innermost loops, alone: rays, triangles, texels, mapping, encoding.
//!
//! `cargo bench --bench kernels` times them; without `--bench` (as `cargo test` runs it) each runs once. Each
//! checks its result first: what is done by lanes gives the bits of what is done one by one.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use glam::{Vec2, Vec3};

use reliefscope::geometry::bvh::{AcceptAll, Bvh};
use reliefscope::geometry::simd::simd_level;
use reliefscope::geometry::triangle::Watertight;
use reliefscope::geometry::{Hit, Ray, TriangleAttributes, TriangleMesh};
use reliefscope::math::lanes::Lanes;
use reliefscope::math::{LinearRgb, SrgbEncoder, hash, srgb8_from_linear, unit_interval};
use reliefscope::measure::bench::grid_scene;
use reliefscope::measure::bench::points::{Found, POINTS, PointWork};
use reliefscope::render::{RayKind, RayList, rays_of};
use reliefscope::surface::mapping::BoundHeight;
use reliefscope::surface::mapping::relief::{ReliefField, ReliefRay, Walk};
use reliefscope::texture::{
    Addressing, Channel, ColorMap, Grid, HeightMap, HeightPyramid, NormalMap, RawImage, Samples,
    Wrap,
};

fn main() {
    divan::main();
}

/// One at a time, or as many as the machine has lanes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum How {
    Alone,
    Together,
}

const HOW: [How; 2] = [How::Alone, How::Together];

/// Reproducible numbers from 0 to 1.
fn number(seed: usize) -> f32 {
    unit_interval(hash(seed as u32))
}

/// Rays of one kind in a picture of a mesh with 20,000 triangles.
fn rays(kind: RayKind) -> (Bvh, RayList) {
    let snapshot = grid_scene(100, [64, 64]);
    (snapshot.scene.bvh.clone(), rays_of(&snapshot, kind))
}

fn closest(bvh: &Bvh, list: &RayList, how: How) -> Vec<Option<Hit>> {
    let mut hits = vec![None; list.rays.len()];
    match how {
        How::Alone => {
            for (hit, (ray, &end)) in hits.iter_mut().zip(list.rays.iter().zip(&list.t_max)) {
                *hit = bvh.intersect::<Watertight, _>(ray, end, &AcceptAll);
            }
        }
        How::Together => {
            bvh.intersect_many::<Watertight, _>(&list.rays, &list.t_max, &AcceptAll, &mut hits);
        }
    }
    hits
}

fn any(bvh: &Bvh, list: &RayList, how: How) -> Vec<bool> {
    let mut hits = vec![false; list.rays.len()];
    match how {
        How::Alone => {
            for (hit, (ray, &end)) in hits.iter_mut().zip(list.rays.iter().zip(&list.t_max)) {
                *hit = bvh.occluded::<Watertight, _>(ray, end, &AcceptAll);
            }
        }
        How::Together => {
            bvh.occluded_many::<Watertight, _>(&list.rays, &list.t_max, &AcceptAll, &mut hits);
        }
    }
    hits
}

#[divan::bench(args = HOW)]
fn closest_hit_of_camera_rays(bencher: Bencher, how: How) {
    let (bvh, list) = rays(RayKind::Camera);
    let hits = closest(&bvh, &list, how);
    assert_eq!(hits, closest(&bvh, &list, How::Alone));
    assert!(hits.iter().any(Option::is_some));
    bencher
        .counter(ItemsCount::new(list.active()))
        .bench(|| closest(&bvh, black_box(&list), how));
}

#[divan::bench(args = HOW)]
fn any_hit_of_rays_to_a_lamp(bencher: Bencher, how: How) {
    let (bvh, list) = rays(RayKind::PointShadow);
    assert_eq!(any(&bvh, &list, how), any(&bvh, &list, How::Alone));
    bencher
        .counter(ItemsCount::new(list.active()))
        .bench(|| any(&bvh, black_box(&list), how));
}

/// 64 rays against a leaf of eight triangles, without a tree around it.
#[divan::bench(args = HOW)]
fn watertight_test(bencher: Bencher, how: How) {
    let corner = |i: usize| {
        let [x, y, z] = [0, 1, 2].map(|axis| number(3 * i + axis));
        Vec3::new(x, y, 0.2 * z)
    };
    let mesh = TriangleMesh {
        positions: (0..24).map(corner).collect(),
        indices: (0..8).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        attributes: vec![TriangleAttributes::default(); 8],
        ..TriangleMesh::default()
    };
    let bvh = Bvh::build(&mesh);
    let mut list = RayList::default();
    for i in 0..64 {
        let origin = Vec3::new(number(100 + 2 * i), number(101 + 2 * i), 1.0);
        let dir = Vec3::NEG_Z;
        list.push(Some((Ray { origin, dir }, f32::INFINITY)));
    }
    let hits = closest(&bvh, &list, how);
    assert_eq!(hits, closest(&bvh, &list, How::Alone));
    assert!(hits.iter().any(Option::is_some));
    bencher
        .counter(ItemsCount::new(64 * 8_usize))
        .bench(|| closest(&bvh, black_box(&list), how));
}

/// A picture of 256 × 256 texels of noise.
fn noise() -> RawImage {
    let byte = |i: usize| (number(i) * 255.0) as u8;
    RawImage {
        width: 256,
        height: 256,
        channels: 3,
        samples: Samples::U8((0..256 * 256 * 3).map(byte).collect()),
    }
}

/// Neighbouring points, a row of pixels each, as a tile sees them.
fn points() -> [Lanes<f32, POINTS>; 2] {
    let mut points = [Lanes::splat(0.0); 2];
    for i in 0..POINTS {
        points[0].0[i] = (i % 32) as f32 * 0.011 + 0.3;
        points[1].0[i] = (i / 32) as f32 * 0.013 - 0.2;
    }
    points
}

fn at_points(bencher: Bencher, work: PointWork<'_>, how: How) {
    let points = points();
    let nothing: Found = [Lanes::splat(0.0); 3];
    let run = |found: &mut Found| match how {
        How::Alone => work.alone(&points, found),
        How::Together => work.by_lanes(simd_level(), &points, found),
    };
    let (mut found, mut alone) = (nothing, nothing);
    run(&mut found);
    work.alone(&points, &mut alone);
    assert_eq!(found, alone);
    assert_ne!(found, nothing);
    bencher
        .counter(ItemsCount::new(POINTS))
        .with_inputs(|| nothing)
        .bench_refs(|found| run(black_box(found)));
}

#[divan::bench(args = HOW)]
fn height_and_slope(bencher: Bencher, how: How) {
    let map = HeightMap::from_image(&noise(), Channel::R);
    at_points(bencher, PointWork::Height(&map), how);
}

#[divan::bench(args = HOW)]
fn stored_normal(bencher: Bencher, how: How) {
    let map = NormalMap::from_image(&noise());
    at_points(bencher, PointWork::Normal(&map), how);
}

#[divan::bench(args = HOW)]
fn srgb_color(bencher: Bencher, how: How) {
    let map = ColorMap::from_image(&noise());
    at_points(bencher, PointWork::Color(&map), how);
}

/// Rays at 45° from the top of a relief of bricks to where they meet it.
#[divan::bench(args = HOW)]
fn exact_walks(bencher: Bencher, how: How) {
    let joint = |i: u32| i % 128 < 12;
    let bricks = (0..1 << 20_u32).map(|i| {
        let (x, y) = (i % 1024, i / 1024);
        let depth = if joint(x + y / 128 * 64) || joint(y) {
            0
        } else {
            50_000
        };
        depth + (number(i as usize) * 5000.0) as u16
    });
    let heights = HeightMap::U16(Grid::new(1024, 1024, bricks.collect()));
    let addressing = Addressing {
        scale: Vec2::ONE,
        offset: Vec2::ZERO,
        wrap: Wrap::Repeat,
    };
    let pyramid = HeightPyramid::new(&heights, Wrap::Repeat);
    let height = BoundHeight::new(&heights, addressing, 0.03, -0.03);
    let field = ReliefField::new(height, &pyramid).expect("the pyramid of this map");
    let [low, high] = field.range();
    // As neighbouring pixels see them.
    let rays: Vec<ReliefRay> = (0..1024_u32)
        .map(|i| {
            let start = [
                200.3 + f64::from(i % 32) * 1.7,
                300.1 + f64::from(i / 32) * 2.3,
            ];
            ReliefRay::by_height(start, [120.0, 1024.0], high, low - (high - low) * 1e-6)
        })
        .collect();
    let walk = |how, walks: &mut Vec<Walk>| match how {
        How::Alone => {
            for (walk, ray) in walks.iter_mut().zip(&rays) {
                *walk = field.walk(ray);
            }
        }
        How::Together => field.walk_all(simd_level(), &rays, walks),
    };
    let mut walks = vec![Walk::NONE; rays.len()];
    walk(How::Alone, &mut walks);
    let alone = walks.clone();
    walk(how, &mut walks);
    assert_eq!(walks, alone);
    bencher
        .counter(ItemsCount::new(rays.len()))
        .bench_local(|| {
            walk(how, &mut walks);
            black_box(&walks);
        });
}

#[divan::bench]
fn srgb_encoding(bencher: Bencher) {
    let colors: Vec<LinearRgb> = (0..POINTS)
        .map(|i| LinearRgb::new(number(3 * i), number(3 * i + 1), 1.2 * number(3 * i + 2)))
        .collect();
    let encoder = SrgbEncoder::get();
    for &color in &colors {
        assert_eq!(encoder.encode(color), srgb8_from_linear(color));
    }
    let mut bytes = vec![[0; 3]; POINTS];
    bencher.counter(ItemsCount::new(POINTS)).bench_local(|| {
        for (bytes, &color) in bytes.iter_mut().zip(black_box(&colors)) {
            *bytes = encoder.encode(color);
        }
        black_box(&bytes)[0]
    });
}
