//! Horizons against the exact walk: what they spare must have nothing in its way.

use glam::Vec2;
use reliefscope::math::V2;
use reliefscope::surface::mapping::BoundHeight;
use reliefscope::surface::mapping::relief::{ReliefField, rising_ray};
use reliefscope::texture::{Addressing, Grid, HeightMap, HeightPyramid, HorizonMap, Wrap};

use super::Random;

/// Rays over one map.
const RAYS: u32 = 30_000;

/// A map of the fractions that `height` gives for a texel.
fn map([w, h]: [u32; 2], height: impl Fn(u32, u32) -> f64) -> HeightMap {
    let texels = (0..h).flat_map(|y| (0..w).map(move |x| (x, y)));
    let stored = texels.map(|(x, y)| (height(x, y) * 65_535.0 + 0.5) as u16);
    HeightMap::U16(Grid::new(w, h, stored.collect()))
}

fn noise(x: u32, y: u32) -> f64 {
    let mixed =
        (x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77)).wrapping_mul(0xC2B2_AE3D);
    f64::from(mixed >> 8) / f64::from(1 << 24)
}

fn bricks(x: u32, y: u32) -> f64 {
    let x = (x + y / 16 * 16) % 32;
    let ramp = |at: u32| f64::from(at.min(4)) / 4.0;
    ramp(x).min(ramp(y % 16))
}

/// Maps of even and odd sizes, and the least of their rays that no walk should be needed for.
fn maps() -> Vec<(&'static str, HeightMap, f64)> {
    let waves =
        |x: u32, y: u32| 0.5 + 0.3 * (f64::from(x) * 0.2).sin() * (f64::from(y) * 0.1).cos();
    let spike = |x: u32, y: u32| f64::from(u8::from(x % 13 == 5 && y % 11 == 3));
    let steps = |x: u32, y: u32| 0.5 + (noise(x, y) * 5.0).floor() / 65_535.0;
    let float = |(x, y): (u32, u32)| (noise(x / 3, y / 3) * 40.0 - 900.0) as f32;
    let floats = (0..33).flat_map(|y| (0..50).map(move |x| float((x, y))));
    vec![
        ("noise", map([64, 64], noise), 0.05),
        ("spikes", map([65, 33], spike), 0.3),
        ("constant", map([8, 8], |_, _| 0.5), 1.0),
        ("one texel", map([1, 1], |_, _| 0.5), 1.0),
        ("bricks", map([64, 64], bricks), 0.3),
        ("waves", map([315, 127], waves), 0.4),
        ("few steps", map([31, 40], steps), 0.05),
        ("a line", map([300, 1], noise), 0.05),
        (
            "floats",
            HeightMap::F32(Grid::new(50, 33, floats.collect())),
            0.2,
        ),
    ]
}

#[test]
fn what_a_horizon_spares_has_nothing_in_its_way() {
    let mut random = Random::new(0x0C1E);
    for (name, height, least) in maps() {
        let [lowest, highest] = height.extremes();
        let size = [height.width(), height.height()].map(f64::from);
        let pyramid = HeightPyramid::new(&height, Wrap::Repeat);
        for turned_over in [false, true] {
            let horizons = HorizonMap::new(&height, turned_over);
            // Texels from the lowest to the highest.
            for relief in [0.1_f32, 3.0, 40.0] {
                let range = (highest - lowest).max(1e-3);
                let scale = relief / range * if turned_over { -1.0 } else { 1.0 };
                // Far from where texture coordinates are, too: what cancels out is rounded.
                let shift = if relief == 3.0 { 3000.0 } else { 0.2 };
                let addressing = Addressing {
                    scale: Vec2::new(1.5, -0.5),
                    offset: Vec2::new(shift, 3.0),
                    wrap: Wrap::Repeat,
                };
                let bound = BoundHeight::new(&height, addressing, scale, -scale * lowest);
                let field = ReliefField::new(bound, &pyramid)
                    .expect("the pyramid of this map")
                    .with_horizons(Some(&horizons));
                let mut spared = 0;
                for _ in 0..RAYS {
                    let [u, v] = [0; 2].map(|_| random.between(-20.0, 20.0));
                    let uv = [(u - f64::from(shift) / 1.5) as f32, v as f32];
                    // Half as steep as what lies in the way may be to twenty times.
                    let steep = f64::from(relief).max(1.0) * 10_f64.powf(random.between(-2.0, 1.0));
                    let (sin, cos) = random.between(0.0, std::f64::consts::TAU).sin_cos();
                    let direction = if random.between(0.0, 1.0) < 0.1 {
                        [cos.signum(), sin.signum() * f64::from(u8::from(sin > 0.0))]
                    } else {
                        [cos, sin]
                    };
                    let per_uv = [1.5 * size[0], -0.5 * size[1]];
                    let per_z = [0, 1].map(|k| (direction[k] / steep / per_uv[k]) as f32);
                    let in_lanes =
                        field.is_clear(V2::new(uv[0], uv[1]), V2::new(per_z[0], per_z[1]));
                    let ray = rising_ray(&field, None, uv, per_z);
                    let alone = ray.as_ref().is_some_and(|ray| field.is_clear_along(ray));
                    spared += u32::from(in_lanes);
                    if let Some(ray) = ray.filter(|_| in_lanes || alone) {
                        let walk = field.walk(&ray);
                        assert!(
                            walk.at.is_none(),
                            "{name}, {relief}, {turned_over}: {in_lanes} {alone} {ray:?} {walk:?}"
                        );
                    }
                }
                let share = f64::from(spared) / f64::from(RAYS);
                assert!(
                    share >= least || shift > 1.0,
                    "{name}, {relief}, {turned_over}: {share}"
                );
            }
        }
    }
}
