//! What maps do to a surface: 2.15–2.18 on charts of any size, turned and mirrored.

use glam::{DVec2, DVec3, Vec2, Vec3};
use reliefscope::geometry::{Hit, Ray};
use reliefscope::measure::report_equations as report;
use reliefscope::surface::mapping::{
    BoundHeight, BoundNormal, Derivative, MappingSettings, MaterialMapping, MaterialMaps, Method,
};
use reliefscope::surface::{SurfaceInteraction, SurfaceParts, surface_at};
use reliefscope::texture::{Addressing, Grid, HeightMap, MapRole, MapSlot, NormalMap, Wrap};

use super::{Random, RandomDirections, one_triangle};

/// A flat place on which a tile of the texture is `tile` units wide along u and v.
struct Chart {
    tangent: DVec3,
    bitangent: DVec3,
    normal: DVec3,
    tile: DVec2,
}

impl Chart {
    fn random(random: &mut Random, tile: DVec2) -> Self {
        let turn = random.rotation();
        let mirrored = random.bits() & 1 == 1;
        Self {
            tangent: turn * DVec3::X,
            bitangent: turn * if mirrored { DVec3::NEG_Y } else { DVec3::Y },
            normal: turn * DVec3::Z,
            tile,
        }
    }

    /// The fast code's record, through its own gradients: from a triangle that lies in the chart.
    fn point(&self, uv: DVec2, wo: DVec3) -> SurfaceInteraction {
        let place =
            |uv: DVec2| self.tangent * (uv.x * self.tile.x) + self.bitangent * (uv.y * self.tile.y);
        let mut uvs = [DVec2::ZERO, DVec2::new(2.0, 0.5), DVec2::new(-0.5, 1.5)];
        if self.tangent.cross(self.bitangent).dot(self.normal) < 0.0 {
            // Counter-clockwise seen from the front.
            uvs.swap(1, 2);
        }
        let hit = Hit {
            t: 1.0,
            prim: 0,
            sub: 0,
            u: 0.25,
            v: 0.5,
        };
        let ray = Ray {
            origin: Vec3::ZERO,
            dir: -wo.as_vec3(),
        };
        let mesh = one_triangle(uvs.map(place), uvs);
        let mut s = surface_at(&mesh, &hit, &ray, SurfaceParts::Gradients);
        s.uv = uv.as_vec2().into();
        s
    }

    fn world_from_tangent(&self, m: DVec3) -> DVec3 {
        self.tangent * m.x + self.bitangent * m.y + self.normal * m.z
    }

    fn tangent_from_world(&self, w: DVec3) -> DVec3 {
        DVec3::new(
            w.dot(self.tangent),
            w.dot(self.bitangent),
            w.dot(self.normal),
        )
    }
}

fn apply(
    settings: MappingSettings,
    maps: MaterialMaps<'_>,
    mut s: SurfaceInteraction,
) -> SurfaceInteraction {
    MaterialMapping::choose(&settings, &maps).apply_to_point(&mut s);
    s
}

fn random_heights(random: &mut Random, wrap: Wrap) -> (HeightMap, Addressing) {
    let [w, h] = [(); 2].map(|()| 1 + (random.bits() % 40) as u32);
    let texels = (0..w * h).map(|_| random.bits() as u16).collect();
    let slot = MapSlot {
        wrap,
        ..MapSlot::new(0, MapRole::Height)
    };
    (
        HeightMap::U16(Grid::new(w, h, texels)),
        Addressing::from_slot(&slot),
    )
}

/// Texture coordinate of a texel's centre; row 0 lies at v = 1.
fn texel_centre(map: &HeightMap, x: u32, y: u32) -> DVec2 {
    DVec2::new(
        (f64::from(x) + 0.5) / f64::from(map.width()),
        1.0 - (f64::from(y) + 0.5) / f64::from(map.height()),
    )
}

/// 2.15–2.16: at texel centres, bump by central differences is the report's normal with heights counted
/// in texels; every wrap rule, odd sizes, stretched and mirrored charts.
#[test]
fn bump_by_central_differences_is_the_reports_normal() {
    let mut random = Random::new(4);
    for case in 0..3_000 {
        let wrap = Wrap::ALL[case % 3];
        let (map, addressing) = random_heights(&mut random, wrap);
        let amplitude = random.between(0.0, 0.1);
        let tile = DVec2::new(random.between(0.5, 2.0), random.between(0.5, 2.0));
        let chart = Chart::random(&mut random, tile);
        let [x, y] = [map.width(), map.height()].map(|n| (random.bits() % u64::from(n)) as u32);
        let height = |x: i64, y: i64| {
            let (x, y) = (wrap.index(x, map.width()), wrap.index(y, map.height()));
            f64::from(map.texel(x, y))
        };
        let per_texel = report::central_differences(height, i64::from(x), i64::from(y));
        let texel = tile / DVec2::new(f64::from(map.width()), f64::from(map.height()));
        // Rows of the picture grow downwards, v upwards.
        let slopes = DVec2::new(per_texel.x, -per_texel.y) * amplitude / texel;
        let expected = chart
            .world_from_tangent(report::normal_from_slopes(slopes))
            .normalize();
        let maps = MaterialMaps {
            height: Some(BoundHeight::new(
                &map,
                addressing,
                amplitude as f32,
                -amplitude as f32,
            )),
            ..MaterialMaps::default()
        };
        let settings = MappingSettings {
            method: Method::Bump,
            derivative: Derivative::Central,
            ..MappingSettings::default()
        };
        let wo = random.direction_above(chart.normal, 0.1);
        let s = chart.point(texel_centre(&map, x, y), wo);
        let found = Vec3::from(apply(settings, maps, s).n_shade).as_dvec3();
        let off = (found - expected).length();
        assert!(off < 3e-5, "case {case}: {found} is not {expected}");
    }
}

/// 2.4.2 with 2.16: a slope map's red and green are `h_x` and `h_y`.
#[test]
fn a_slope_map_is_the_reports_normal() {
    let mut random = Random::new(5);
    for case in 0..2_000 {
        let texel = [(); 3].map(|()| random.between(0.0, 1.0) as f32);
        let map = NormalMap::F32(Grid::new(1, 1, vec![texel]));
        let chart = Chart::random(&mut random, DVec2::splat(1.0));
        let strength = random.between(0.1, 2.0);
        let slopes = DVec2::new(f64::from(texel[0]), f64::from(texel[1])) * 2.0 - 1.0;
        let expected = chart
            .world_from_tangent(report::normal_from_slopes(slopes * strength))
            .normalize();
        let maps = MaterialMaps {
            slope: Some(BoundNormal {
                strength: strength as f32,
                ..BoundNormal::new(
                    &map,
                    Addressing::from_slot(&MapSlot::new(0, MapRole::Slope)),
                )
            }),
            ..MaterialMaps::default()
        };
        let settings = MappingSettings {
            method: Method::Slope,
            ..MappingSettings::default()
        };
        let wo = random.direction_above(chart.normal, 0.1);
        let found = apply(settings, maps, chart.point(DVec2::splat(0.3), wo)).n_shade;
        assert!(
            (Vec3::from(found).as_dvec3() - expected).length() < 2e-6,
            "case {case}"
        );
    }
}

/// 2.17 and 2.18: shifts on charts of any size, turned and mirrored, with the midlevel taken off.
#[test]
fn parallax_shifts_as_the_report_says() {
    let mut random = Random::new(6);
    for case in 0..4_000 {
        let (map, addressing) = random_heights(&mut random, Wrap::Repeat);
        let width = random.between(0.25, 4.0);
        let chart = Chart::random(&mut random, DVec2::splat(width));
        let amplitude = random.between(0.0, 0.2) * width;
        let midlevel = random.between(0.0, 1.0);
        let [x, y] = [map.width(), map.height()].map(|n| (random.bits() % u64::from(n)) as u32);
        let uv = texel_centre(&map, x, y);
        let wo = random.direction_above(chart.normal, 0.05);
        let view = chart.tangent_from_world(wo);
        let height = amplitude * (f64::from(map.texel(x, y)) - midlevel) / width;
        for method in [Method::Parallax, Method::ParallaxLimited] {
            let expected = match method {
                Method::Parallax => report::parallax(uv, height, view),
                _ => report::parallax_limited(uv, height, view),
            };
            let maps = MaterialMaps {
                height: Some(BoundHeight::new(
                    &map,
                    addressing,
                    amplitude as f32,
                    (-amplitude * midlevel) as f32,
                )),
                ..MaterialMaps::default()
            };
            let settings = MappingSettings {
                method,
                ..MappingSettings::default()
            };
            let found = Vec2::from(apply(settings, maps, chart.point(uv, wo)).uv).as_dvec2();
            let off = (found - expected).length();
            // At a cosine of 0.05 the division magnifies rounding twenty times.
            assert!(off < 1e-4, "case {case}, {}: off by {off}", method.name());
        }
    }
}
