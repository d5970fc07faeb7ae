//! Where a view ray really lands.
//!
//! This file alone says what is true.

use glam::{DVec2, DVec3, Vec3};

use super::facet::Facet;
use super::sights::Sight;
use super::subject::with_mapping;
use crate::geometry::Ray;
use crate::render::{Frame, Passage, Snapshot};
use crate::surface::displaced::SurfaceHit;
use crate::surface::mapping::relief::{LIFT, ReliefField, ReliefRay};
use crate::surface::mapping::{Derivative, Lookup, MappingSettings, Method};
use crate::texture::Wrap;

/// Below this cosine between normal and view nothing is measured; the searches' own limit is lower.
pub const MIN_COS: f64 = 1e-4;

/// What everything is measured against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Truth {
    /// The relief over the tangent plane of each hit, walked in double precision: right for a flat chart; on a
    /// curved base it is the relief that every method here aims at, without the outline.
    #[default]
    Walk,
    /// The displaced surface with its outline and the shadows that it throws on itself, each point followed to the
    /// surface between the micro-triangles in double precision.
    Displaced,
}

/// A place on the relief, internal units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landing {
    /// Texture coordinate.
    pub uv: DVec2,
    /// Displacement along the smooth normal.
    pub z: f64,
    /// The point.
    pub p: DVec3,
    /// Unit normal of the bilinear relief there.
    pub normal: DVec3,
    /// The point of the micro-triangle there, where the surface is displaced: shadow rays meet micro-triangles, and so
    /// they start from them. From the surface in between they would start under those of every hollow.
    pub micro: Option<SurfaceHit>,
    /// How far the same walk begun elsewhere lands, texels: the rounding of the truth itself.
    pub doubt_texels: f64,
}

impl Truth {
    /// What suits a scene: the walk where all of its reliefs lie on flat charts.
    #[must_use]
    pub fn suiting(snapshot: &Snapshot) -> Self {
        let mapping = Self::Displaced.settings(&snapshot.settings.mapping);
        let displaced = with_mapping(snapshot, mapping);
        let frame = Frame::new(&displaced);
        let kinds = frame.displaced.as_ref().map(|d| d.displacement.kinds());
        match kinds {
            Some([_, fine]) if fine > 0 => Self::Displaced,
            _ => Self::Walk,
        }
    }

    /// For reports.
    #[must_use]
    pub const fn summary(self) -> &'static str {
        match self {
            Self::Walk => {
                "the bilinear relief over the flat chart of each hit, walked in double precision (method `exact`)"
            }
            Self::Displaced => {
                "the displaced surface with its outline, followed in double precision (method `displacement`)"
            }
        }
    }

    /// Whether its outline may differ from the mesh's, so that outlines can be compared at all.
    #[must_use]
    pub const fn moves_outlines(self) -> bool {
        match self {
            Self::Walk => false,
            Self::Displaced => true,
        }
    }

    /// The settings that render it.
    #[must_use]
    pub fn settings(self, mapping: &MappingSettings) -> MappingSettings {
        let mut mapping = *mapping;
        mapping.method = match self {
            Self::Walk => Method::Exact,
            Self::Displaced => Method::Displacement,
        };
        mapping.use_parallax = true;
        mapping.use_height = true;
        mapping.lookup = Lookup::Bump;
        mapping.derivative = Derivative::Analytic;
        mapping.search.self_shadow = true;
        mapping
    }

    /// Where a view ray lands; `None` where it looks along the surface or at its back, or passes the true surface.
    #[must_use]
    pub fn landing(
        self,
        frame: &Frame<'_>,
        sight: &Sight,
        passage: &mut Passage,
    ) -> Option<Landing> {
        let field = frame.materials[sight.material].field()?;
        match self {
            Self::Walk => walked(field, &sight.facet),
            Self::Displaced => displaced(frame, field, sight, passage),
        }
    }

    /// Whether anything that the truth knows of hides the light in the unit direction `wi`, `distance` away, from a
    /// landing: the relief, and where that is displaced all of the surface.
    #[must_use]
    pub fn is_shadowed(
        self,
        frame: &Frame<'_>,
        (sight, landing): (&Sight, &Landing),
        (wi, distance): (DVec3, f32),
        passage: &mut Passage,
    ) -> bool {
        match self {
            Self::Walk => {
                let field = frame.materials[sight.material].field();
                field.is_some_and(|field| hidden(field, &sight.facet, landing, wi))
            }
            Self::Displaced => landing.micro.is_some_and(|micro| {
                let point = (micro.p, micro.normal, micro.bound);
                is_behind_relief(frame, point, (wi.as_vec3(), distance), passage)
            }),
        }
    }
}

/// Whether the displaced surface keeps a light from a point of it, given with its normal and the bound of its rounding
/// along that.
pub fn is_behind_relief(
    frame: &Frame<'_>,
    (p, n, bound): (Vec3, Vec3, f32),
    (wi, distance): (Vec3, f32),
    passage: &mut Passage,
) -> bool {
    passage.is_blocked(frame, &Ray::leaving((p, bound, n), wi), distance)
}

/// The view ray against the displaced surface, then on to the surface between its micro-triangles.
fn displaced(
    frame: &Frame<'_>,
    field: &ReliefField<'_>,
    sight: &Sight,
    passage: &mut Passage,
) -> Option<Landing> {
    let facet = &sight.facet;
    let mesh = frame.displaced.as_ref()?.mesh(frame.mesh);
    let ray = Ray {
        origin: frame.camera.origin,
        dir: (-sight.surface.wo).into(),
    };
    let hit = passage.closest(frame, &ray, f32::INFINITY)?;
    let found = mesh.smooth_hit(&ray, &hit)?;
    let mut uv = found.point.uv;
    let turns = field.height.addressing.scale.as_dvec2();
    if field.height.addressing.wrap == Wrap::Repeat && turns.x * turns.y != 0.0 {
        // Of all coordinates of this place the nearest: across a seam a turn is no distance.
        uv -= ((uv - facet.uv) * turns).round() / turns;
    }
    Some(Landing {
        uv,
        z: (found.point.p - facet.p).dot(facet.normal),
        p: found.point.p,
        normal: found.normal,
        micro: Some(hit),
        doubt_texels: found.doubt_texels,
    })
}

/// Texels per internal unit of z along a direction.
fn texels_per_z(field: &ReliefField<'_>, facet: &Facet, dir: DVec3) -> [f64; 2] {
    let cos = dir.dot(facet.normal);
    let rates = field.texels_per_uv();
    [0, 1].map(|k| dir.dot(facet.gradients[k]) / cos * rates[k])
}

fn walked(field: &ReliefField<'_>, facet: &Facet) -> Option<Landing> {
    let cos = facet.cos();
    if !(cos > MIN_COS) {
        return None;
    }
    let [low, high] = field.range();
    let per_z = texels_per_z(field, facet, facet.wo);
    let from = |top: f64| {
        let [x, y] = field.texels_from_uv(facet.uv.to_array());
        let start = [x + per_z[0] * top, y + per_z[1] * top];
        // A little further, so that rounding cannot end the walk above the lowest height.
        let z_end = low - LIFT * (high - low);
        let ray = ReliefRay::by_height(start, per_z, top, z_end);
        let walk = field.walk(&ray);
        let z = walk.at.map_or(low, |tau| ray.z_at(tau).clamp(low, high));
        (z, [x + per_z[0] * z, y + per_z[1] * z])
    };
    let (z, place) = from(high);
    let (_, again) = from(high + 0.37 * (high - low));
    let per_uv = [0, 1].map(|k| facet.wo.dot(facet.gradients[k]) / cos);
    Some(Landing {
        uv: facet.uv + DVec2::from_array(per_uv) * z,
        z,
        p: facet.p + facet.wo * (z / cos),
        normal: relief_normal(field, facet, place),
        micro: None,
        doubt_texels: (place[0] - again[0]).hypot(place[1] - again[1]),
    })
}

/// Normal of the bilinear relief at a place in texels.
fn relief_normal(field: &ReliefField<'_>, facet: &Facet, place: [f64; 2]) -> DVec3 {
    let slope = field.slope(place);
    let rates = field.texels_per_uv();
    let tilt = |k: usize| facet.gradients[k] * (slope[k] * rates[k]);
    (facet.normal - tilt(0) - tilt(1)).normalize_or(facet.normal)
}

fn hidden(field: &ReliefField<'_>, facet: &Facet, landing: &Landing, wi: DVec3) -> bool {
    if wi.dot(facet.normal) <= 1e-6 {
        return true;
    }
    let [low, high] = field.range();
    let start = field.texels_from_uv(landing.uv.to_array());
    let z_start = field.displacement(start) + LIFT * (high - low);
    let per_z = texels_per_z(field, facet, wi);
    let ray = ReliefRay::by_height(start, per_z, z_start, high);
    z_start < high && field.walk(&ray).at.is_some()
}
