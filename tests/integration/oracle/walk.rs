//! The exact walk against a plain walk over every cell in double precision.

use reliefscope::math::V2;
use reliefscope::math::simd::SimdLevel;
use reliefscope::surface::mapping::BoundHeight;
use reliefscope::surface::mapping::relief::{ReliefField, ReliefRay, Side, Walk};
use reliefscope::texture::{Addressing, Grid, HeightMap, HeightPyramid, Wrap};

use super::Random;

/// Rays over one map: more with `RELIEFSCOPE_RAYS`.
fn ray_count() -> u32 {
    let asked = std::env::var("RELIEFSCOPE_RAYS").ok();
    asked.and_then(|n| n.parse().ok()).unwrap_or(20_000)
}

const SIZE: u32 = 64;
/// Texels from stored 0 to stored 1.
const AMPLITUDE: f32 = 6.0;

fn map(value: impl Fn(u32, u32) -> f32) -> HeightMap {
    let texels = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y)));
    let stored = |(x, y)| (value(x, y) * 65_535.0 + 0.5) as u16;
    HeightMap::U16(Grid::new(SIZE, SIZE, texels.map(stored).collect()))
}

/// Random, one-texel spikes, constant, bricks.
fn maps() -> Vec<(&'static str, HeightMap)> {
    let noise = |x: u32, y: u32| {
        let h =
            (x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77)).wrapping_mul(0xC2B2_AE3D);
        (h >> 8) as f32 / (1 << 24) as f32
    };
    let spike = |x: u32, y: u32| if x % 13 == 5 && y % 11 == 3 { 1.0 } else { 0.0 };
    let brick = |x: u32, y: u32| {
        let row = y / 16;
        let x = (x + row * 16) % 32;
        if x < 2 || y % 16 < 2 { 0.0 } else { 1.0 }
    };
    vec![
        ("random", map(noise)),
        ("spikes", map(spike)),
        ("constant", map(|_, _| 0.5)),
        ("bricks", map(brick)),
    ]
}

/// Marches cell by cell with its own arithmetic; the first place not above the patch.
fn plain_walk(height: &HeightMap, wrap: Wrap, ray: &ReliefRay, offset: f64) -> Option<f64> {
    let length = ray.end;
    let at = |tau: f64| [0, 1].map(|k| ray.start[k] + ray.rate[k] * tau);
    // Every parameter at which a texel line is crossed.
    let mut cuts = vec![0.0, length];
    for k in 0..2 {
        let (a, b) = (at(0.0)[k], at(length)[k]);
        let (low, high) = (a.min(b).ceil() as i64, a.max(b).floor() as i64);
        let rate = ray.rate[k];
        if rate != 0.0 {
            cuts.extend(
                (low..=high).map(|line| ((line as f64 - ray.start[k]) / rate).clamp(0.0, length)),
            );
        }
    }
    cuts.sort_by(f64::total_cmp);
    let texel = |x: i64, y: i64| {
        let (x, y) = (wrap.index(x, SIZE), wrap.index(y, SIZE));
        let stored = (f64::from(height.texel(x, y)) * 65_535.0).round() / 65_535.0;
        stored * f64::from(AMPLITUDE) + offset
    };
    for pair in cuts.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let middle = at((from + to) * 0.5);
        let (i, j) = (middle[0].floor(), middle[1].floor());
        let (x, y) = (i as i64, j as i64);
        let [a, b, c, d] = [
            texel(x, y),
            texel(x + 1, y),
            texel(x, y + 1),
            texel(x + 1, y + 1),
        ];
        let gap = |tau: f64| {
            let [px, py] = at(tau);
            let (fx, fy) = (px - i, py - j);
            let patch = (a * (1.0 - fx) + b * fx) * (1.0 - fy) + (c * (1.0 - fx) + d * fx) * fy;
            ray.z_at(tau) - patch
        };
        if let Some(tau) = first_crossing(&gap, from, to) {
            return Some(ray.z_at(tau));
        }
    }
    None
}

/// The first parameter at which a parabola is not above 0: by its lowest point, then bisection.
fn first_crossing(gap: &impl Fn(f64) -> f64, from: f64, to: f64) -> Option<f64> {
    if gap(from) <= 0.0 {
        return Some(from);
    }
    let (f0, f1, f2) = (gap(from), gap((from + to) * 0.5), gap(to));
    let curve = f0 - 2.0 * f1 + f2;
    let mut end = to;
    if curve > 0.0 {
        let vertex = 0.5 - (f2 - f0) / (4.0 * curve);
        if (0.0..1.0).contains(&vertex) && gap(from + (to - from) * vertex) <= 0.0 {
            end = from + (to - from) * vertex;
        }
    }
    if gap(end) > 0.0 {
        return None;
    }
    let (mut above, mut below) = (from, end);
    for _ in 0..200 {
        let middle = (above + below) * 0.5;
        if gap(middle) > 0.0 {
            above = middle
        } else {
            below = middle
        }
    }
    Some(below)
}

fn field<'a>(height: &'a HeightMap, pyramid: &'a HeightPyramid, wrap: Wrap) -> ReliefField<'a> {
    let addressing = Addressing {
        scale: glam::Vec2::ONE,
        offset: glam::Vec2::ZERO,
        wrap,
    };
    let height = BoundHeight::new(height, addressing, AMPLITUDE, -AMPLITUDE);
    ReliefField::new(height, pyramid).expect("the pyramid of this map")
}

#[test]
fn the_exact_walk_finds_what_a_walk_over_every_cell_finds() {
    let mut random = Random::new(0x0DD5);
    for (name, height) in maps() {
        for wrap in Wrap::ALL {
            let pyramid = HeightPyramid::new(&height, wrap);
            let field = field(&height, &pyramid, wrap);
            let [low, high] = field.range();
            let thickness = (high - low).max(1e-3);
            for _ in 0..ray_count() / 3 {
                // As many rays in every ten degrees, and a tenth between 80 and 89.9.
                let angle = (random.between(0.0, 1.0) * 89.9).to_radians();
                let (sin, cos) = (random.between(0.0, 1.0) * std::f64::consts::TAU).sin_cos();
                let per_z = [cos, sin].map(|c| c * angle.tan());
                let start =
                    [0; 2].map(|_| (random.between(0.0, 1.0) * 4.0 - 1.5) * f64::from(SIZE));
                let ray = ReliefRay::by_height(start, per_z, high, low - thickness * 1e-6);
                let walk = field.walk(&ray);
                assert!(!walk.capped, "{name}, {wrap:?}: {ray:?}");
                let expected = plain_walk(&height, wrap, &ray, f64::from(-AMPLITUDE));
                let found = ray.z_at(walk.at.expect("sinking rays hit"));
                let expected = expected.expect("in the oracle too");
                // A ray that grazes a crest by less than rounding may go either way: compare heights there.
                let error = (found - expected).abs() * angle.tan().max(1.0);
                assert!(
                    error < 1e-6 || grazes(&field, &ray, found.max(expected)),
                    "{name}, {wrap:?}: {found} is not {expected} on {ray:?}"
                );
            }
        }
    }
}

/// Whether the ray touches the relief at this displacement, to rounding.
fn grazes(field: &ReliefField<'_>, ray: &ReliefRay, z: f64) -> bool {
    let place = [0, 1].map(|k| ray.start[k] + ray.rate[k] * (z - ray.z) / ray.z_rate);
    (field.displacement(place) - z).abs() < 1e-9
}

#[test]
fn rising_rays_are_shadowed_where_a_walk_over_every_cell_says_so() {
    let mut random = Random::new(0x5AD0);
    for (name, height) in maps() {
        let pyramid = HeightPyramid::new(&height, Wrap::Repeat);
        let field = field(&height, &pyramid, Wrap::Repeat);
        let [_, high] = field.range();
        for _ in 0..ray_count() / 4 {
            let angle = (random.between(0.0, 1.0) * 89.0).to_radians();
            let (sin, cos) = (random.between(0.0, 1.0) * std::f64::consts::TAU).sin_cos();
            let start = [0; 2].map(|_| random.between(0.0, 1.0) * f64::from(SIZE));
            let per_z = [cos, sin].map(|c| c * angle.tan());
            let z_start = field.displacement(start) + 1e-5;
            if z_start >= high {
                continue;
            }
            let ray = ReliefRay::by_height(start, per_z, z_start, high);
            let walk = field.walk(&ray);
            let expected = plain_walk(&height, Wrap::Repeat, &ray, f64::from(-AMPLITUDE));
            assert!(!walk.capped, "{name}: {ray:?}");
            let found = walk.at.map(|tau| ray.z_at(tau));
            let same = found.is_some() == expected.is_some();
            let z = found.or(expected).unwrap_or(high);
            assert!(
                same || grazes(&field, &ray, z),
                "{name}: {walk:?} is not {expected:?} on {ray:?}"
            );
        }
    }
}

/// A ray between two random points in and around the layer: rising, sinking, level, upright, from either
/// side.
fn any_ray(field: &ReliefField<'_>, random: &mut Random) -> ReliefRay {
    let [low, high] = field.range();
    let mut point = || {
        let [x, y] = [0; 2].map(|_| (random.between(0.0, 1.0) * 3.0 - 1.0) * f64::from(SIZE));
        [
            x,
            y,
            low + (high - low) * (random.between(0.0, 1.0) * 1.4 - 0.2),
        ]
    };
    let (from, mut to) = (point(), point());
    match random.between(0.0, 10.0) as u32 {
        0 => to[2] = from[2],
        1 => to[0] = from[0],
        2 => (to[0], to[1]) = (from[0], from[1]),
        _ => {}
    }
    let end = random.between(0.5, 90.0);
    let [dx, dy, dz] = [0, 1, 2].map(|k| (to[k] - from[k]) / end);
    let above = from[2] > field.displacement([from[0], from[1]]);
    ReliefRay {
        start: [from[0], from[1]],
        rate: [dx, dy],
        z: from[2],
        z_rate: dz,
        end,
        side: if above { Side::Above } else { Side::Below },
    }
}

#[test]
fn walks_from_either_side_meet_the_relief_where_a_fine_march_crosses_it() {
    let mut random = Random::new(0x51DE);
    for (name, height) in maps() {
        let pyramid = HeightPyramid::new(&height, Wrap::Repeat);
        let field = field(&height, &pyramid, Wrap::Repeat);
        for _ in 0..ray_count() / 40 {
            let ray = any_ray(&field, &mut random);
            let walk = field.walk(&ray);
            assert!(!walk.capped, "{name}: {ray:?}");
            let gap = |tau: f64| {
                let place = [0, 1].map(|k| ray.start[k] + ray.rate[k] * tau);
                let gap = ray.z_at(tau) - field.displacement(place);
                if ray.side == Side::Above { gap } else { -gap }
            };
            let reached = walk.at.unwrap_or(ray.end);
            if let Some(at) = walk.at {
                assert!(
                    gap(at).abs() < 1e-9,
                    "{name}: {} at {at} of {ray:?}",
                    gap(at)
                );
            }
            for i in 0..2000 {
                let tau = reached * f64::from(i) / 2000.0;
                assert!(
                    gap(tau) > -1e-9,
                    "{name}: passed through at {tau} of {ray:?}: {walk:?}"
                );
            }
        }
    }
}

#[test]
fn walks_in_lanes_come_to_what_walks_alone_come_to() {
    let mut random = Random::new(0x1A9E);
    for (name, height) in maps() {
        for wrap in Wrap::ALL {
            let pyramid = HeightPyramid::new(&height, wrap);
            let field = field(&height, &pyramid, wrap);
            let mut rays: Vec<_> = (0..3000).map(|_| any_ray(&field, &mut random)).collect();
            rays[17].end = 1e13;
            let alone: Vec<_> = rays.iter().map(|ray| field.walk(ray)).collect();
            for level in SimdLevel::ALL.into_iter().filter(|l| l.is_available()) {
                for count in [0, 1, 5, 3000] {
                    let mut walks = vec![Walk::NONE; count];
                    field.walk_all(level, &rays[..count], &mut walks);
                    assert_eq!(walks, alone[..count], "{name}, {wrap:?}, {level}");
                }
            }
        }
    }
}

#[test]
fn ranges_over_triangles_hold_every_height_in_them() {
    let mut random = Random::new(0x4A6E);
    for (name, height) in maps() {
        for wrap in Wrap::ALL {
            let pyramid = HeightPyramid::new(&height, wrap);
            let field = field(&height, &pyramid, wrap);
            let [lowest, highest] = field.range().map(|d| d as f32);
            let mut narrower = 0;
            for case in 0..2000 {
                let size = 10.0_f64.powf(random.between(-3.0, 0.5));
                let at = [0; 2].map(|_| random.between(-2.0, 3.0));
                let corner = |random: &mut Random| {
                    let [u, v] = at.map(|c| (c + random.between(-size, size)) as f32);
                    V2::new(u, v)
                };
                let corners = [0; 3].map(|_| corner(&mut random));
                let [low, high] = field.ranges_near(corners);
                narrower += u32::from(high - low < 0.9 * (highest - lowest));
                for _ in 0..20 {
                    let (a, b) = (random.between(0.0, 1.0), random.between(0.0, 1.0));
                    let (a, b) = if a + b > 1.0 {
                        (1.0 - a, 1.0 - b)
                    } else {
                        (a, b)
                    };
                    let [p, q, r] = corners;
                    let (a, b) = (a as f32, b as f32);
                    let place = p + (q - p) * a + (r - p) * b;
                    let d = field.height.displacement(place);
                    assert!(
                        (low..=high).contains(&d),
                        "{name}, {wrap:?}, case {case}: {d} is not in {low}..{high} at {place:?}"
                    );
                }
            }
            let is_large = height.width().min(height.height()) > 8;
            let is_constant = highest - lowest < 1e-6;
            // Beyond the border of a mirrored picture nothing is known.
            let enough = if wrap == Wrap::Mirror { 0 } else { 200 };
            assert!(
                narrower > enough || !is_large || is_constant,
                "{name}, {wrap:?}: {narrower} are of use"
            );
        }
    }
}

#[test]
fn displacement_at_a_place_is_the_bilinear_height() {
    let mut random = Random::new(7);
    for (_, height) in maps() {
        for wrap in Wrap::ALL {
            let pyramid = HeightPyramid::new(&height, wrap);
            let field = field(&height, &pyramid, wrap);
            for _ in 0..200 {
                let uv = [0; 2].map(|_| (random.between(0.0, 1.0) * 6.0 - 3.0) as f32);
                let there = field.texels_from_uv(uv.map(f64::from));
                let exact = field.displacement(there);
                let plain: f32 = field.height.displacement(V2::new(uv[0], uv[1]));
                assert!(
                    (exact - f64::from(plain)).abs() < 1e-3,
                    "{exact} {plain} at {uv:?}"
                );
            }
        }
    }
}
