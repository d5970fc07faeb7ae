//! Random simple polygons keep their area, their corners and their outline.

use std::collections::HashSet;
use std::f64::consts::TAU;

use glam::{DQuat, DVec2, DVec3};

use super::*;

/// Splitmix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A star: radii at random around the origin.
fn star(random: &mut Random) -> Vec<DVec2> {
    let n = 5 + random.below(40);
    (0..n)
        .map(|i| {
            let angle = TAU * (i as f64 + 0.8 * random.unit()) / n as f64;
            DVec2::from_angle(angle) * (0.1 + random.unit())
        })
        .collect()
}

/// A comb with teeth of random length, on whole numbers: many exactly straight corners.
fn comb(random: &mut Random) -> Vec<DVec2> {
    let teeth = 1 + random.below(8);
    let mut points = vec![];
    for i in 0..teeth {
        let (x, height) = (2.0 * i as f64, 1.0 + random.below(3) as f64);
        points.extend([
            (x, 1.0),
            (x, 1.0 + height),
            (x + 1.0, 1.0 + height),
            (x + 1.0, 1.0),
        ]);
    }
    let right = 2.0 * teeth as f64 - 1.0;
    points.extend([(right, 0.0), (right * 0.5, 0.0), (0.0, 0.0)]);
    points.into_iter().rev().map(DVec2::from).collect()
}

/// A spiral corridor.
fn spiral(random: &mut Random) -> Vec<DVec2> {
    let n = 10 + random.below(60);
    let turns = 1.0 + 3.0 * random.unit();
    let arm = |i: u64, width: f64| {
        let s = i as f64 / n as f64;
        DVec2::from_angle(TAU * turns * s) * (1.0 + s * turns + width)
    };
    let out = (0..=n).map(|i| arm(i, 0.0));
    let back = (0..=n).rev().map(|i| arm(i, 0.4));
    // Outwards on the inside is clockwise.
    out.chain(back).rev().collect()
}

/// A ring joined to its hole by a bridge that is walked twice.
fn keyhole(random: &mut Random) -> Vec<DVec2> {
    let n = 3 + random.below(12);
    let m = 3 + random.below(12);
    let circle = |n: u64, radius: f64| {
        (0..=n).map(move |i| DVec2::from_angle(TAU * (i % n) as f64 / n as f64) * radius)
    };
    let inner: Vec<_> = circle(m, 0.2).collect();
    circle(n, 1.0).chain(inner.into_iter().rev()).collect()
}

fn check(flat: &[DVec2], turn: DQuat, shift: DVec3) {
    let corners: Vec<_> = flat.iter().map(|p| turn * p.extend(0.0) + shift).collect();
    let expected: f64 = 0.5
        * (0..flat.len())
            .map(|i| flat[i].perp_dot(flat[(i + 1) % flat.len()]))
            .sum::<f64>();
    assert!(expected > 0.0, "the test's polygon is counter-clockwise");
    let mut triangulator = Triangulator::default();
    let Triangulated {
        triangles,
        area_vector,
        crossed,
    } = triangulator.triangulate(&corners);
    let context = || format!("{flat:?}");
    assert!(!crossed, "{}", context());
    let normal = turn * DVec3::Z;
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * expected;
    assert!(close(area_vector.dot(normal), expected), "{}", context());
    let mut area = 0.0;
    for t in triangles {
        let [a, b, c] = t.map(|i| corners[i as usize]);
        let part = 0.5 * (b - a).cross(c - a).dot(normal);
        assert!(
            part >= -1e-9 * expected,
            "a triangle turned over: {}",
            context()
        );
        area += part.abs();
    }
    assert!(
        close(area, expected),
        "area {area}, not {expected}: {}",
        context()
    );
    assert_eq!(triangles.len(), corners.len() - 2, "{}", context());
    let edges: HashSet<_> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .collect();
    for a in 0..corners.len() as u32 {
        let edge = [a, (a + 1) % corners.len() as u32];
        assert!(edges.contains(&edge), "outline lost at {a}: {}", context());
    }
}

#[test]
fn random_simple_polygons_keep_area_and_outline() {
    let mut random = Random(20_261_121);
    for i in 0..10_000 {
        let polygon = match i % 4 {
            0 => star(&mut random),
            1 => comb(&mut random),
            2 => spiral(&mut random),
            _ => keyhole(&mut random),
        };
        let (turn, shift) = if i % 3 == 0 {
            (DQuat::IDENTITY, DVec3::ZERO)
        } else {
            let axis = DVec3::new(random.unit(), random.unit() - 0.5, random.unit() - 0.5);
            let turn = DQuat::from_axis_angle(axis.normalize_or(DVec3::X), TAU * random.unit());
            (turn, axis * 100.0)
        };
        check(&polygon, turn, shift);
    }
}

#[test]
fn straight_corners_stay_on_the_outline() {
    // A square with three extra corners on every side, from each first corner.
    let mut square: Vec<_> = (0..16)
        .map(|i| {
            let s = f64::from(i % 4);
            match i / 4 {
                0 => DVec2::new(s, 0.0),
                1 => DVec2::new(4.0, s),
                2 => DVec2::new(4.0 - s, 4.0),
                _ => DVec2::new(0.0, 4.0 - s),
            }
        })
        .collect();
    for _ in 0..16 {
        check(&square, DQuat::IDENTITY, DVec3::ZERO);
        square.rotate_left(1);
    }
}

#[test]
fn quads_are_cut_inside_and_short() {
    let cut = |points: [[f64; 2]; 4]| {
        let corners = points.map(|[x, y]| DVec3::new(x, y, 0.0));
        Triangulator::default()
            .triangulate(&corners)
            .triangles
            .to_vec()
    };
    let along_02 = vec![[0, 1, 2], [0, 2, 3]];
    let along_13 = vec![[0, 1, 3], [1, 2, 3]];
    // A kite: the short diagonal, from either first corner.
    assert_eq!(cut([[0., 0.], [1., -3.], [2., 0.], [1., 3.]]), along_02);
    assert_eq!(cut([[1., -3.], [2., 0.], [1., 3.], [0., 0.]]), along_13);
    // A dart: the diagonal at the reflex corner, though it is the longer one.
    assert_eq!(cut([[0., 0.], [2., -1.], [1.5, 0.], [2., 1.]]), along_02);
    assert_eq!(cut([[2., -1.], [1.5, 0.], [2., 1.], [0., 0.]]), along_13);
    // A triangle with a corner in the middle of a side: never along that side.
    assert_eq!(cut([[0., 0.], [1., 0.], [2., 0.], [1., 9.]]), along_13);
}

#[test]
fn strange_polygons_give_something_and_say_so() {
    let nan = DVec3::NAN;
    let p = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let mut t = Triangulator::default();
    assert!(t.triangulate(&[]).triangles.is_empty());
    assert_eq!(t.triangulate(&[nan; 6]).triangles.len(), 4);
    assert_eq!(t.triangulate(&[p(1.0, 1.0); 7]).triangles.len(), 5);
    let huge = [
        p(1e308, 0.0),
        p(0.0, 1e308),
        p(-1e308, 0.0),
        p(0.0, -1e308),
        p(1e307, -1e307),
    ];
    assert_eq!(t.triangulate(&huge).triangles.len(), 3);
    let pentagram: Vec<_> = (0..5)
        .map(|i| DVec2::from_angle(TAU * f64::from(i * 2) / 5.0).extend(0.0))
        .collect();
    assert!(t.triangulate(&pentagram).crossed);
    let bowtie = [p(0.0, 0.0), p(1.0, 1.0), p(1.0, 0.0), p(0.0, 1.0)];
    assert!(t.triangulate(&bowtie).crossed);
    let thin = [p(0.0, 0.0), p(1.0, 0.0), p(2.0, 0.0), p(1.0, 0.0)];
    assert!(!t.triangulate(&thin).crossed);
}

#[test]
fn twenty_thousand_corners_take_reasonable_time() {
    // A comb of 5,000 teeth: an ear clipper without an index would need 10⁸ tests or more.
    let mut points = vec![];
    for i in 0..5_000 {
        let x = f64::from(2 * i);
        let height = 2.0 + f64::from(i * 7919 % 13);
        points.extend([(x, 1.0), (x, height), (x + 1.0, height), (x + 1.0, 1.0)]);
    }
    points.extend([(9_999.0, 0.0), (0.0, 0.0)]);
    let flat: Vec<_> = points.into_iter().rev().map(DVec2::from).collect();
    check(&flat, DQuat::IDENTITY, DVec3::ZERO);
}
