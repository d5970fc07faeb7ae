//! [`FlatPrism::point`] for many rays, one in each vector lane: the same bits.

use super::flat::{FlatPoint, FlatPrism, ROUNDING};
use super::prism_lanes::{PrismLanes, RayRows, cross, dot};
use crate::geometry::Ray;
use crate::math::rows::{Row, load, store};
use crate::math::simd::{Kernel, Select as _, Simd, SimdBase as _, SimdFloat as _, SimdLevel};

/// The points that some of `rays` meet on a flat relief: `met` are their numbers and the distances.
pub fn points_all(
    level: SimdLevel,
    prism: &FlatPrism<'_, '_>,
    rays: &[Ray],
    met: &[(u32, f64)],
    points: &mut [FlatPoint],
) {
    if level == SimdLevel::Scalar {
        for &(i, t) in met {
            points[i as usize] = prism.point(&rays[i as usize], t);
        }
        return;
    }
    level.run_or_plain(PointsAll {
        prism,
        rays,
        met,
        points,
    });
}

struct PointsAll<'a> {
    prism: &'a FlatPrism<'a, 'a>,
    rays: &'a [Ray],
    met: &'a [(u32, f64)],
    points: &'a mut [FlatPoint],
}

impl Kernel for PointsAll<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let prism = PrismLanes::<S>::new(simd, self.prism);
        for met in self.met.chunks(S::f64s::LEN) {
            let mut rays = RayRows::NONE;
            for (lane, &(i, t)) in met.iter().enumerate() {
                rays.put(lane, &self.rays[i as usize], t);
            }
            let found = prism.points(simd, &rays);
            for (lane, &(i, _)) in met.iter().enumerate() {
                let of = |rows: &[Row; 3]| [rows[0][lane], rows[1][lane], rows[2][lane]].into();
                self.points[i as usize] = FlatPoint::new(
                    of(&found.p),
                    of(&found.rounding),
                    of(&found.normal),
                    [found.place[0][lane], found.place[1][lane]],
                );
            }
        }
    }
}

/// What was found in each lane.
struct Points {
    p: [Row; 3],
    rounding: [Row; 3],
    normal: [Row; 3],
    place: [Row; 2],
}

impl<S: Simd> PrismLanes<'_, S> {
    /// Every operation of [`FlatPrism::point`].
    #[inline(always)]
    fn points(&self, simd: S, rays: &RayRows) -> Points {
        let t = load(simd, &rays.end);
        let (o, [x, y, z]) = (rays.origin(simd), rays.dir(simd));
        let way: [S::f64s; 3] = [x * t, y * t, z * t];
        let p = [o[0] + way[0], o[1] + way[1], o[2] + way[2]];
        let rounding = [
            (o[0].abs() + way[0].abs()) * ROUNDING,
            (o[1].abs() + way[1].abs()) * ROUNDING,
            (o[2].abs() + way[2].abs()) * ROUNDING,
        ];
        let from = self.way_to(p);
        let (b1, b2) = (dot::<S>(self.rows[0], from), dot::<S>(self.rows[1], from));
        let [slope_x, slope_y] = self.prism.field.slopes(simd, self.texels(b1, b2));
        let [_, t1, t2] = self.texels;
        let [e1, e2, n] = self.along;
        let (rise1, rise2) = (
            slope_x * t1[0] + slope_y * t1[1],
            slope_x * t2[0] + slope_y * t2[1],
        );
        let along1 = [
            e1[0] + n[0] * rise1,
            e1[1] + n[1] * rise1,
            e1[2] + n[2] * rise1,
        ];
        let along2 = [
            e2[0] + n[0] * rise2,
            e2[1] + n[1] * rise2,
            e2[2] + n[2] * rise2,
        ];
        let [x, y, z] = cross::<S>(along1, along2);
        let one = S::f64s::splat(simd, 1.0);
        let per_length = one / dot::<S>([x, y, z], [x, y, z]).sqrt();
        let usable = per_length.simd_lt(f64::INFINITY) & per_length.simd_gt(0.0);
        let side = self.prism.axes.det.signum();
        let normal = [
            usable.select(x * per_length, n[0]) * side,
            usable.select(y * per_length, n[1]) * side,
            usable.select(z * per_length, n[2]) * side,
        ];
        Points {
            p: [store::<S>(p[0]), store::<S>(p[1]), store::<S>(p[2])],
            rounding: [
                store::<S>(rounding[0]),
                store::<S>(rounding[1]),
                store::<S>(rounding[2]),
            ],
            normal: [
                store::<S>(normal[0]),
                store::<S>(normal[1]),
                store::<S>(normal[2]),
            ],
            place: [store::<S>(b1), store::<S>(b2)],
        }
    }
}
