//! Rays that leave a convex body towards a light: none is stopped by the body itself, and none starts so far
//! away that a touching blocker is jumped over.

use glam::{DVec3, Vec3};

use super::bodies::{self, Body};
use super::placement::Placement;
use super::trees::Trees;
use super::watertight::towards;
use super::{Finding, Plan, Random, Test};
use crate::geometry::bvh::AcceptAll;
use crate::geometry::{Ray, offset_origin};
use crate::scene::Scene;
use crate::surface::{SurfaceParts, surface_at};

/// Largest gap, radii, in which a blocker would be jumped over.
const GAP_BAR: f64 = 1e-3;
/// Where `f32` has no such places left, the gap is at most this many units in the last place.
const GAP_ULPS: f64 = 16.0;
/// The light is at least this high over the surface (sine): lower, a flat triangle is not lit for certain.
const LOWEST: f64 = 1e-3;
/// Nor is it lower than this many units in the last place of `f32` over an edge: far from the origin and not
/// normalised, rounding has bent the body by so much that it is no longer convex.
const BENT_ULPS: f64 = 4.0;
/// Shortest edge of the body, radii.
const EDGE: f64 = 0.08;

/// Two lines for each placement.
pub(super) fn tests(_plan: &Plan) -> Vec<Test> {
    let mut all = Vec::new();
    for placement in Placement::all() {
        let place = placement.name();
        let name = format!("false shadow, sphere, {place}");
        all.push(Test::new("contact", name.clone(), move |plan| {
            false_shadows(plan, &name, placement)
        }));
        let name = format!("gap, sphere, {place}");
        all.push(Test::new("contact", name.clone(), move |plan| {
            gap(plan, &name, placement)
        }));
    }
    all
}

/// A ray that leaves a lit point, and what it left.
struct Leaving {
    ray: Ray,
    /// Unit normal of the triangle, outwards, in `f64`.
    normal: DVec3,
    /// A corner of the triangle.
    corner: DVec3,
}

/// A place on a placed body and where it leads.
struct Place<'a> {
    plan: &'a Plan,
    placement: Placement,
    body: Body,
    scene: Scene,
    trees: Trees,
}

impl<'a> Place<'a> {
    fn new(plan: &'a Plan, placement: Placement) -> Self {
        let body = bodies::sphere(16);
        let scene = placement.scene(&body, false);
        let trees = Trees::new(plan.kernel, &scene.bvh);
        Self {
            plan,
            placement,
            body,
            scene,
            trees,
        }
    }

    /// A ray from a point that the eye sees to a light that is up; `None` where the kernel hits nothing, or from
    /// behind.
    fn leaving(&self, random: &mut Random) -> Option<Leaving> {
        let mesh = &self.scene.mesh;
        let eye = random.direction() * random.between(1.5, 6.0);
        let eye = self.placement.internal(&self.scene.normalization, eye);
        let prim = random.below(self.body.triangles.len().min(mesh.len())) as u32;
        let [a, b, c] = mesh.corners(prim).map(|c| c.as_dvec3());
        let (u, v) = (random.unit(), random.unit());
        let (u, v) = if u + v > 1.0 {
            (1.0 - u, 1.0 - v)
        } else {
            (u, v)
        };
        let ray = towards(eye, a + (b - a) * u + (c - a) * v);
        let hit = self
            .plan
            .kernel
            .closest(self.trees.bvh(), &ray, &AcceptAll)?;
        let [a, b, c] = mesh.corners(hit.prim).map(|c| c.as_dvec3());
        let normal = (b - a).cross(c - a);
        let normal = normal / normal.length();
        if normal.dot(ray.dir.as_dvec3()) >= 0.0 {
            return None;
        }
        let surface = surface_at(mesh, &hit, &ray, SurfaceParts::Plain);
        let slant = random.pick(&[1.0, 0.1, 0.01]);
        let dir = (normal * slant + random.direction()).normalize_or(normal);
        let dir = if dir.dot(normal) < 0.0 { -dir } else { dir };
        let origin = offset_origin(
            surface.p.into(),
            surface.p_error.into(),
            Vec3::from(surface.n_geo),
            dir.as_vec3(),
            self.plan.offset_rule.origin_rule(),
        );
        let dir = dir.as_vec3();
        let bent = BENT_ULPS * self.ulp() / EDGE;
        let lit = dir.as_dvec3().dot(normal) > LOWEST.max(bent);
        lit.then_some(Leaving {
            ray: Ray { origin, dir },
            normal,
            corner: a,
        })
    }

    /// Unit in the last place of the largest coordinate, radii.
    fn ulp(&self) -> f64 {
        f64::from(f32::EPSILON) * f64::from(self.scene.bvh.reach()) / self.radius()
    }

    /// Internal units of the body's radius.
    fn radius(&self) -> f64 {
        self.placement.scale * self.scene.normalization.scale
    }
}

fn false_shadows(plan: &Plan, name: &str, placement: Placement) -> Finding {
    let place = Place::new(plan, placement);
    let mut random = plan.random(name);
    let (mut cases, mut wrong, mut disagreeing) = (0, 0, 0);
    for _ in 0..plan.effort.pick(8, 120, 3_000) {
        let leaving: Vec<_> = (0..64).filter_map(|_| place.leaving(&mut random)).collect();
        let rays: Vec<_> = leaving.iter().map(|leaving| leaving.ray).collect();
        let far = vec![f32::INFINITY; rays.len()];
        let (stopped, differ) = place.trees.shadows(&rays, &far);
        cases += rays.len() as u64;
        wrong += stopped.into_iter().filter(|stopped| *stopped).count() as u64;
        disagreeing += differ;
    }
    let note = match disagreeing {
        0 => String::new(),
        n => format!("{n} rays differ between levels"),
    };
    Finding::none_of(cases, "falsely shadowed", wrong + disagreeing).with_note(note)
}

fn gap(plan: &Plan, name: &str, placement: Placement) -> Finding {
    let place = Place::new(plan, placement);
    let mut random = plan.random(name);
    let (mut cases, mut widest) = (0, 0.0_f64);
    for _ in 0..plan.effort.pick(512, 8_000, 200_000) {
        if let Some(leaving) = place.leaving(&mut random) {
            let off = leaving.ray.origin.as_dvec3() - leaving.corner;
            widest = widest.max(off.dot(leaving.normal).abs());
            cases += 1;
        }
    }
    let bar = GAP_BAR.max(GAP_ULPS * place.ulp());
    let note = if bar > GAP_BAR {
        format!("bar: {GAP_ULPS} units in the last place of f32")
    } else {
        String::new()
    };
    Finding::worst_of(cases, "gap in radii", widest / place.radius(), Some(bar)).with_note(note)
}
