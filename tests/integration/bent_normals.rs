//! What each treatment of bent normals promises: on random directions, and in pictures.

use glam::{DVec3, Vec3};
use reliefscope::math::{V3, hash, unit_interval};
use reliefscope::render::{Snapshot, probe};
use reliefscope::scene::BentNormals;
use reliefscope::shading::{Light, LightKind, mirror_direction, reflect, softened_horizon};
use reliefscope::surface::mapping::Method;
use reliefscope::texture::{MapRole, RawImage, Samples};

use crate::support::{QuadScene, bits, edited, picture, plain_float};

/// Random unit vectors.
struct Directions(u32);

impl Directions {
    fn number(&mut self) -> f32 {
        self.0 += 1;
        2.0 * unit_interval(hash(self.0)) - 1.0
    }

    fn any(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(self.number(), self.number(), self.number());
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize_or_zero();
            }
        }
    }

    /// On the side of `n`, by at least this cosine.
    fn above(&mut self, n: Vec3, cos: f32) -> Vec3 {
        loop {
            let v = self.any();
            if v.dot(n) > cos {
                return v;
            }
        }
    }
}

#[test]
fn lifted_mirror_rays_leave_the_surface_and_the_others_are_not_touched() {
    let mut random = Directions(0);
    let mut lifted = 0;
    for case in 0..100_000 {
        let n_geo = random.any();
        let n_shade = random.above(n_geo, 0.01);
        let wo = random.above(n_geo, 0.001);
        let textbook = Vec3::from(reflect(V3::from(n_shade), wo.into()));
        let found = Vec3::from(mirror_direction(V3::from(n_shade), n_geo.into(), wo.into()));
        if textbook.dot(n_geo) > 0.0 {
            assert_eq!(found, textbook, "case {case}");
            continue;
        }
        lifted += 1;
        assert!(found.dot(n_geo) > 0.0, "case {case}: {found}");
        assert!((found.length() - 1.0).abs() < 1e-5, "case {case}");
    }
    // A third of all tilts asks for it, or nothing was tested.
    assert!(lifted > 10_000, "{lifted}");
}

/// Lifting starts where it is needed: a ray that just runs in is turned by about its hundredth.
#[test]
fn lifting_begins_without_a_leap() {
    let n_geo = Vec3::Z;
    let mut leaps: Vec<f32> = Vec::new();
    for tilt_deg in [10.0_f32, 20.0, 40.0] {
        let (sin, cos) = tilt_deg.to_radians().sin_cos();
        let n_shade = Vec3::new(sin, 0.0, cos);
        // The eye whose mirror image lies just under the horizon on the side that the normal leans to.
        let below = (-0.001_f32).sin_cos();
        let image = V3::from(Vec3::new(below.1, 0.0, below.0));
        let wo = reflect(V3::from(n_shade), image);
        let found = Vec3::from(mirror_direction(n_shade.into(), n_geo.into(), wo));
        leaps.push((found - Vec3::from(image)).length());
    }
    assert!(leaps.iter().all(|leap| *leap < 0.02), "{leaps:?}");
}

#[test]
fn softened_light_is_a_share_that_ends_at_the_horizon() {
    let mut random = Directions(5);
    for case in 0..100_000 {
        let n_geo = random.any();
        let n_shade = random.above(n_geo, 0.01);
        let wi = loop {
            let wi = random.above(n_geo, 1e-4);
            if wi.dot(n_shade) > 1e-4 {
                break wi;
            }
        };
        let share = |n: Vec3| softened_horizon(V3::from(n_geo), n.into(), wi.into());
        let found = share(n_shade);
        assert!((0.0..=1.0).contains(&found), "case {case}: {found}");
        assert!(
            share(n_geo) > 1.0 - 1e-5,
            "case {case}: an unbent normal keeps all"
        );
        // Nearer to the horizon there is less.
        let lower = (wi - n_geo * (0.5 * wi.dot(n_geo))).normalize_or_zero();
        if lower.dot(n_shade) >= wi.dot(n_shade) {
            let less = softened_horizon(V3::from(n_geo), n_shade.into(), lower.into());
            assert!(less <= found + 1e-5, "case {case}: {less} over {found}");
        }
    }
}

/// A quad of one normal, leaning 30° towards +x, under a sun in the plane of both at `elevation_deg`.
fn leaning(elevation_deg: f64, bent: BentNormals) -> f32 {
    let n = Vec3::new(0.5, 0.0, 0.75_f32.sqrt());
    let stored = n.to_array().map(|c| 0.5 + 0.5 * c);
    let mut scene = QuadScene::new().with_map(MapRole::Normal, plain_float(1, 1, stored));
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    let sun = LightKind::Directional {
        direction: -DVec3::new(cos, 0.0, sin),
    };
    scene.settings.lights = vec![Light::new("sun", sun, 1.0)];
    scene.settings.mapping.method = Method::Normal;
    scene.settings.shading.bent_normals = bent;
    scene.settings.shading.shadows = false;
    scene.settings.materials[0].kd = reliefscope::math::LinearRgb::WHITE;
    let story = probe(&scene.snapshot(), [20, 30]).expect("inside");
    story.color.g * std::f32::consts::PI
}

#[test]
fn only_softened_light_has_no_edge_at_the_horizon() {
    let steps = |bent| {
        let lit: Vec<f32> = (-20..60)
            .map(|i| leaning(0.1 * f64::from(i), bent))
            .collect();
        let most = lit
            .windows(2)
            .map(|w| (w[1] - w[0]).abs())
            .fold(0.0, f32::max);
        (lit, most)
    };
    // A tenth of a degree changes the light on a plain surface by as much as this.
    let plain = 0.1_f32.to_radians();
    let (textbook, edge) = steps(BentNormals::Textbook);
    let (lifted, _) = steps(BentNormals::Lifted);
    let (softened, ramp) = steps(BentNormals::Softened);
    assert_eq!(textbook, lifted, "lifting is about mirrors");
    // sin 30° of light begins all at once.
    assert!((edge - 0.5).abs() < 0.01, "{edge}");
    assert!(ramp <= 2.0 * plain, "{ramp} over {plain}");
    assert!(softened.iter().zip(&textbook).all(|(s, t)| s <= t));
    // High above the horizon of the surface nothing is taken away.
    let high = [BentNormals::Textbook, BentNormals::Softened].map(|bent| leaning(75.0, bent));
    assert_eq!(high[0], high[1]);
}

/// A mirror with waves steep enough to send rays into itself.
fn wavy_mirror() -> Snapshot {
    let side = 64;
    let mut samples = Vec::new();
    for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
        let turn = std::f32::consts::TAU / side as f32;
        let slope = Vec3::new((x as f32 * turn * 2.0).cos(), (y as f32 * turn).sin(), 0.0);
        let n = (Vec3::Z - slope).normalize_or_zero();
        samples.extend(n.to_array().map(|c| 0.5 + 0.5 * c));
    }
    let image = RawImage {
        width: side,
        height: side,
        channels: 3,
        samples: Samples::F32(samples),
    };
    let mut scene = QuadScene::new().with_map(MapRole::Normal, image);
    scene.settings.mapping.method = Method::Normal;
    scene.settings.materials[0].reflectivity = 0.6;
    scene.settings.camera.eye = DVec3::new(0.3, -2.5, 0.8);
    scene.snapshot()
}

/// Cosine of each mirror ray with the geometric normal it leaves from, and how far it is from the mirror
/// image.
fn mirror_rays(snapshot: &Snapshot) -> Vec<(f32, f32)> {
    let [width, height] = snapshot.size;
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let rays = pixels.filter_map(|pixel| {
        let story = probe(snapshot, pixel).expect("inside");
        let hit = story.bounces[0].hit.as_ref()?;
        let dir = Vec3::from(story.bounces.get(1)?.dir);
        let wo = -Vec3::from(story.bounces[0].dir);
        let image = Vec3::from(reflect(V3::from(Vec3::from(hit.n_shade)), wo.into()));
        Some((dir.dot(Vec3::from(hit.n_geo)), (dir - image).length()))
    });
    rays.collect()
}

#[test]
fn mirror_rays_run_into_the_surface_only_by_the_textbook() {
    let snapshot = wavy_mirror();
    let rays = |bent| mirror_rays(&edited(&snapshot, |s| s.shading.bent_normals = bent));
    let textbook = rays(BentNormals::Textbook);
    assert!(textbook.iter().all(|(_, off)| *off < 1e-6));
    let inside = textbook.iter().filter(|(cos, _)| *cos <= 0.0).count();
    assert!(
        inside * 10 > textbook.len(),
        "{inside} of {}",
        textbook.len()
    );
    for bent in [BentNormals::Lifted, BentNormals::Softened] {
        let treated = rays(bent);
        assert_eq!(treated.len(), textbook.len());
        assert!(treated.iter().all(|(cos, _)| *cos > 0.0), "{}", bent.name());
        let same = treated
            .iter()
            .zip(&textbook)
            .filter(|(t, b)| b.0 > 0.0 && t == b)
            .count();
        assert_eq!(
            same,
            textbook.len() - inside,
            "{}: the others are as they were",
            bent.name()
        );
    }
}

#[test]
fn without_bent_normals_they_are_one_picture() {
    let mut scene = QuadScene::new();
    scene.settings.materials[0].reflectivity = 0.4;
    let snapshot = scene.snapshot();
    let film = |bent| {
        bits(&picture(&edited(&snapshot, |s| {
            s.shading.bent_normals = bent
        })))
    };
    let textbook = film(BentNormals::Textbook);
    assert_eq!(textbook, film(BentNormals::Lifted));
    assert_eq!(textbook, film(BentNormals::Softened));
}
