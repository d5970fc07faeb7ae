//! Perturbs one surface point by every method: `cargo run --release --example perturb_one_normal`.
//!
//! The relief is a ramp that rises with u, so all answers can be checked by hand: amplitude 0.5 across one
//! tile of width 1 is a slope of 1/2, and the normal must tilt by atan(1/2) = 26.57 degrees against it.
#![expect(clippy::print_stdout, reason = "an example shows its results")]

use glam::{Vec2, Vec3};
use reliefscope::math::normalize_or;
use reliefscope::surface::SurfaceInteraction;
use reliefscope::surface::mapping::{
    BoundHeight, BoundNormal, MappingSettings, MaterialMapping, MaterialMaps, Method,
};
use reliefscope::texture::{
    Addressing, ConeMap, Grid, HeightMap, HeightPyramid, MapRole, MapSlot, NormalMap, Wrap,
};

const AMPLITUDE: f32 = 0.5;
const MIDLEVEL: f32 = 1.0;

fn main() {
    // A ramp that gains 1 over 256 texels, and its slope as a normal and as a slope map: both store
    // (n + 1) / 2.
    let ramp = (0..256_u16).map(|i| i * 256).collect();
    let heights = HeightMap::U16(Grid::new(256, 1, ramp));
    let normal = normalize_or(Vec3::new(-AMPLITUDE, 0.0, 1.0), Vec3::Z);
    let stored = |v: Vec3| NormalMap::F32(Grid::new(1, 1, vec![(v * 0.5 + 0.5).to_array()]));
    let normals = stored(normal);
    let slopes = stored(Vec3::new(AMPLITUDE, 0.0, 1.0));

    let addressing = |role| Addressing::from_slot(&MapSlot::new(0, role));
    let bound_normal = |map, role| BoundNormal::new(map, addressing(role));
    let pyramid = HeightPyramid::new(&heights, Wrap::Repeat);
    let cones = ConeMap::new(&heights, Wrap::Repeat, false);
    let maps = MaterialMaps {
        height: Some(BoundHeight::new(
            &heights,
            addressing(MapRole::Height),
            AMPLITUDE,
            -AMPLITUDE * MIDLEVEL,
        )),
        normal: Some(bound_normal(&normals, MapRole::Normal)),
        slope: Some(bound_normal(&slopes, MapRole::Slope)),
        pyramid: Some(&pyramid),
        horizons: None,
        cones: Some(&cones),
    };

    println!("method             normal                 tilt   uv");
    for method in Method::ALL {
        let settings = MappingSettings {
            method,
            ..MappingSettings::default()
        };
        let mut s = flat_point();
        MaterialMapping::choose(&settings, &maps).apply_to_point(&mut s);
        let (normal, uv) = (Vec3::from(s.n_shade), Vec2::from(s.uv));
        let tilt_deg = normal.angle_between(Vec3::Z).to_degrees();
        println!(
            "{:<18} {:<22} {tilt_deg:5.2}°  {uv:.4}",
            method.name(),
            format!("{normal:.4}"),
        );
    }
}

/// The middle of a flat tile of width 1, seen from 45 degrees along u.
fn flat_point() -> SurfaceInteraction {
    SurfaceInteraction {
        p: Vec3::ZERO.into(),
        p_error: Vec3::ZERO.into(),
        n_geo: Vec3::Z.into(),
        n_shade: Vec3::Z.into(),
        wo: normalize_or(Vec3::new(1.0, 0.0, 1.0), Vec3::Z).into(),
        uv: Vec2::splat(0.5).into(),
        grad_u: Vec3::X.into(),
        grad_v: Vec3::Y.into(),
        dp_du: Vec3::X.into(),
        handedness: 1.0,
        n_smooth: Vec3::Z.into(),
        footprint: 0.0,
        sunk: 0.0,
        steps: 0.0,
    }
}
