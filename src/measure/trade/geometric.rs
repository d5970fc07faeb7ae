//! How far every view ray of a method lands from the truth: no light, no pixels, no noise.

use glam::{DVec3, Vec3};

use super::sights::{Sight, Sights};
use super::truth::{Landing, Truth, is_behind_relief};
use super::{GeometricErrors, Stats};
use crate::geometry::Ray;
use crate::geometry::triangle::Watertight;
use crate::math::{V2, V3, angle};
use crate::render::{Frame, FrameLight, FrameLightKind, Passage};
use crate::surface::mapping::relief::is_shadowed;
use crate::surface::{SurfaceInteraction, uv_at};

/// A uv error above this many texels shows another texel.
const WRONG_TEXEL: f64 = 1.0;

/// The true landings of a view's rays.
pub struct TrueView<'a> {
    frame: &'a Frame<'a>,
    truth: Truth,
    sights: Vec<(Sight, Landing)>,
    /// For each sight, which lights reach it.
    lit: Vec<Vec<bool>>,
    outline: Vec<bool>,
    /// Largest rounding of the truth itself, texels.
    pub doubt_texels: f64,
}

impl<'a> TrueView<'a> {
    /// Follows the rays of a frame that was made with the truth's settings.
    #[must_use]
    pub fn new(frame: &'a Frame<'a>, truth: Truth, sights: &Sights) -> Self {
        let mut passage = Passage::default();
        let land = |sight: &Sight| {
            let landing = truth.landing(frame, sight, &mut passage)?;
            Some((*sight, landing))
        };
        let landed: Vec<_> = sights.relief.iter().filter_map(land).collect();
        let doubt = landed.iter().map(|(_, landing)| landing.doubt_texels);
        let mut view = Self {
            frame,
            truth,
            doubt_texels: doubt.fold(0.0, f64::max),
            lit: Vec::new(),
            outline: sights.outline.clone(),
            sights: landed,
        };
        view.lit = view
            .sights
            .iter()
            .map(|seen| view.truly_lit(seen, &mut passage))
            .collect();
        view
    }

    /// Rays that are measured.
    #[must_use]
    pub const fn rays(&self) -> usize {
        self.sights.len()
    }

    /// Angles between the rays and the smooth normals, degrees, in growing order.
    #[must_use]
    pub fn angles_deg(&self) -> Vec<f64> {
        let mut angles: Vec<f64> = self.sights.iter().map(|(s, _)| s.angle_deg()).collect();
        angles.sort_by(f64::total_cmp);
        angles
    }

    /// The errors of the method that `frame` was made with, on the same rays; `outline` is what they hit by that
    /// method, where the truth has an outline of its own.
    #[must_use]
    pub fn errors(&self, frame: &Frame<'_>, outline: Option<&[bool]>) -> GeometricErrors {
        let (mut uv, mut depth, mut normal) = (Vec::new(), Vec::new(), Vec::new());
        let (mut asked, mut wrong) = (0_u64, 0_u64);
        let mut passage = Passage::default();
        for ((sight, landing), truly_lit) in self.sights.iter().zip(&self.lit) {
            let Some(field) = self.frame.materials[sight.material].field() else {
                continue;
            };
            let mut s = sight.surface;
            if frame.displaced.is_some() {
                displaced(frame, &mut s, &mut passage);
            } else {
                let material = &frame.materials[sight.material];
                material.place_baked_frame((frame.mesh, frame.tangents), &sight.hit, &mut s);
                material.mapping.apply_to_point(&mut s);
            }
            let rates = field.texels_per_uv();
            let du = (f64::from(s.uv.x) - landing.uv.x) * rates[0];
            let dv = (f64::from(s.uv.y) - landing.uv.y) * rates[1];
            uv.push(du.hypot(dv));
            let moved = Vec3::from(s.p - sight.surface.p).as_dvec3();
            let amplitude = f64::from(field.height.scale.abs());
            depth.push((moved.dot(sight.facet.normal) - landing.z).abs() / amplitude);
            let shown = Vec3::from(s.n_shade).as_dvec3();
            normal.push(angle(shown, landing.normal).to_degrees());
            for (light, &truly) in frame.lights.iter().zip(truly_lit) {
                asked += 1;
                let lit = is_lit(frame, sight.material, &s, light, &mut passage)
                    && (frame.displaced.is_some() || !self.is_behind_mesh(sight, light));
                wrong += u64::from(lit != truly);
            }
        }
        let over = uv.iter().filter(|&&e| e > WRONG_TEXEL).count();
        GeometricErrors {
            wrong_texel_share: over as f64 / uv.len().max(1) as f64,
            uv_texels: Stats::of(uv),
            depth: Stats::of(depth),
            normal_deg: Stats::of(normal),
            silhouette_iou: outline.map(|outline| outline_agreement(outline, &self.outline)),
            shadow_disagreement: (asked > 0).then(|| wrong as f64 / asked as f64),
        }
    }

    /// Which lights reach a true landing.
    fn truly_lit(&self, (sight, landing): &(Sight, Landing), passage: &mut Passage) -> Vec<bool> {
        let lit = |light: &FrameLight| {
            let wi = towards(light, landing.p);
            let micro = landing.micro.map(|micro| micro.normal.as_dvec3());
            let n_geo = micro.unwrap_or(sight.facet.n_geo);
            let faces = wi.dot(n_geo) > 0.0 && wi.dot(landing.normal) > 0.0;
            let distance = distance(light, landing.p.as_vec3());
            let hides = |passage| {
                let seen = (sight, landing);
                self.truth
                    .is_shadowed(self.frame, seen, (wi, distance), passage)
            };
            faces && !(self.frame.shadows && hides(&mut *passage))
        };
        self.frame.lights.iter().map(lit).collect()
    }

    /// Whether the mesh keeps a light from a place on it. Over flat charts nobody asks: the truth there knows of no
    /// other parts of the mesh.
    fn is_behind_mesh(&self, sight: &Sight, light: &FrameLight) -> bool {
        if !self.truth.moves_outlines() || !self.frame.shadows {
            return false;
        }
        let s = &sight.surface;
        let p = Vec3::from(s.p);
        let wi = towards(light, p.as_dvec3()).as_vec3();
        let bound = s.n_geo.abs().dot(s.p_error);
        let ray = Ray::leaving((p, bound, s.n_geo.into()), wi);
        let solid = |prim: u32, u: f32, v: f32| self.frame.is_solid(prim, u, v);
        let bvh = self.frame.bvh;
        bvh.occluded::<Watertight, _>(&ray, distance(light, p), &solid)
    }
}

/// Whether a light reaches the place that a method shows, the mesh's own shadows left out.
fn is_lit(
    frame: &Frame<'_>,
    material: usize,
    s: &SurfaceInteraction,
    light: &FrameLight,
    passage: &mut Passage,
) -> bool {
    let wi = V3::from(towards(light, Vec3::from(s.p).as_dvec3()).as_vec3());
    if !(wi.dot(s.n_geo) > 0.0 && wi.dot(s.n_shade) > 0.0) {
        return false;
    }
    if frame.displaced.is_some() {
        let (p, n) = (Vec3::from(s.p), Vec3::from(s.n_geo));
        let point = (p, n, s.n_geo.abs().dot(s.p_error));
        let light = (wi.into(), distance(light, p));
        return !(frame.shadows && is_behind_relief(frame, point, light, passage));
    }
    let Some(field) = frame.materials[material].mapping.self_shadow() else {
        return true;
    };
    let at = (s.uv, [s.grad_u, s.grad_v], s.n_smooth);
    !(frame.shadows && is_shadowed(field, None, true, at, wi).0)
}

/// Moves a point to where its view ray meets the displaced surface.
fn displaced(frame: &Frame<'_>, s: &mut SurfaceInteraction, passage: &mut Passage) {
    let ray = Ray {
        origin: frame.camera.origin,
        dir: (-s.wo).into(),
    };
    if let Some(hit) = passage.closest(frame, &ray, f32::INFINITY) {
        let [b1, b2] = hit.weights;
        s.uv = V2::from(uv_at(frame.mesh, hit.prim, b1, b2));
        hit.replace_point(s);
        s.n_shade = s.n_geo;
    }
}

/// How far away a light is.
fn distance(light: &FrameLight, p: Vec3) -> f32 {
    match light.kind {
        FrameLightKind::Directional(_) => f32::INFINITY,
        FrameLightKind::Point(place, _) => place.distance(p),
    }
}

/// Unit direction to a light.
fn towards(light: &FrameLight, p: DVec3) -> DVec3 {
    match light.kind {
        FrameLightKind::Directional(wi) => wi.as_dvec3(),
        FrameLightKind::Point(place, _) => (place.as_dvec3() - p).normalize_or_zero(),
    }
}

impl Stats {
    /// Of errors in any order; zeros if there are none.
    #[must_use]
    pub fn of(mut errors: Vec<f64>) -> Self {
        let squares: f64 = errors.iter().map(|e| e * e).sum();
        let rms = (squares / errors.len().max(1) as f64).sqrt();
        errors.sort_by(f64::total_cmp);
        Self {
            rms,
            p50: quantile(&errors, 0.5),
            p95: quantile(&errors, 0.95),
        }
    }
}

/// The smallest of the sorted values that at least the share `q` of them does not exceed; 0 without values.
#[must_use]
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let rank = (sorted.len() as f64 * q).ceil() as usize;
    sorted.get(rank.saturating_sub(1)).copied().unwrap_or(0.0)
}

/// Intersection over union of two outlines, each a list of what is covered; 1 if nothing is.
///
/// # Panics
/// If the lists differ in length.
#[must_use]
pub fn outline_agreement(a: &[bool], b: &[bool]) -> f64 {
    assert_eq!(a.len(), b.len(), "outlines of one picture");
    let both = a.iter().zip(b).filter(|(a, b)| **a && **b).count();
    let any = a.iter().zip(b).filter(|(a, b)| **a || **b).count();
    if any == 0 {
        1.0
    } else {
        both as f64 / any as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stats_of_known_errors() {
        let errors: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        let stats = Stats::of(errors);
        assert_eq!((stats.p50, stats.p95), (50.0, 95.0));
        // (1² + … + 100²) / 100 = 101 · 201 / 6.
        assert!((stats.rms - (101.0_f64 * 201.0 / 6.0).sqrt()).abs() < 1e-12);
        assert_eq!(Stats::of(Vec::new()), Stats::default());
        assert_eq!(Stats::of(vec![3.0]).p95, 3.0);
    }

    #[test]
    fn small_angles_are_not_lost() {
        let tilted = DVec3::new(1e-9, 0.0, 1.0);
        let small = angle(DVec3::Z, tilted);
        assert!((small - 1e-9).abs() < 1e-15, "{small}");
        assert!((angle(DVec3::Z, -DVec3::Z) - std::f64::consts::PI).abs() < 1e-12);
    }

    #[test]
    fn outlines() {
        let (t, f) = (true, false);
        assert_eq!(outline_agreement(&[t, t, f, f], &[t, f, t, f]), 1.0 / 3.0);
        assert_eq!(outline_agreement(&[t, f], &[t, f]), 1.0);
        assert_eq!(outline_agreement(&[t, f], &[f, t]), 0.0);
        assert_eq!(outline_agreement(&[f], &[f]), 1.0);
    }
}
