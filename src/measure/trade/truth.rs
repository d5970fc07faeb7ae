//! Where a view ray really lands.
//!
//! This file alone says what is true. A better truth than the exact walk over a flat chart (a displaced surface,
//! say) becomes the reference of every figure by another [`Truth`] here.

use glam::{DVec2, DVec3};

use super::facet::Facet;
use crate::surface::mapping::relief::{ReliefField, ReliefRay};
use crate::surface::mapping::{Derivative, Lookup, MappingSettings, Method};

/// Below this cosine between normal and view nothing is measured; the searches' own limit is lower.
pub const MIN_COS: f64 = 1e-4;
/// Shadow walks start this share of the relief's thickness over it, as the renderer's do.
const LIFT: f64 = 1.0 / 1_048_576.0;

/// What everything is measured against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Truth {
    /// The relief over the tangent plane of each hit, walked in double precision: right for a flat chart; on a
    /// curved base it is the relief that every method here aims at, without the outline.
    #[default]
    Walk,
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
    /// How far the same walk begun elsewhere lands, texels: the rounding of the truth itself.
    pub doubt_texels: f64,
}

impl Truth {
    /// For reports.
    #[must_use]
    pub const fn summary(self) -> &'static str {
        match self {
            Self::Walk => {
                "the bilinear relief over the flat chart of each hit, walked in double precision (method `exact`)"
            }
        }
    }

    /// Whether its outline may differ from the mesh's, so that outlines can be compared at all.
    #[must_use]
    pub const fn moves_outlines(self) -> bool {
        match self {
            Self::Walk => false,
        }
    }

    /// The settings that render it.
    #[must_use]
    pub const fn settings(self, mapping: &MappingSettings) -> MappingSettings {
        let mut mapping = *mapping;
        mapping.method = match self {
            Self::Walk => Method::Exact,
        };
        mapping.use_parallax = true;
        mapping.use_height = true;
        mapping.lookup = Lookup::Bump;
        mapping.derivative = Derivative::Analytic;
        mapping.search.self_shadow = true;
        mapping
    }

    /// Where the ray of a facet lands on the relief over it; `None` where it looks along the surface or at its back.
    #[must_use]
    pub fn landing(self, field: &ReliefField<'_>, facet: &Facet) -> Option<Landing> {
        match self {
            Self::Walk => walked(field, facet),
        }
    }

    /// Whether the relief hides the light in the unit direction `wi` from a landing.
    #[must_use]
    pub fn is_shadowed(
        self,
        field: &ReliefField<'_>,
        facet: &Facet,
        landing: &Landing,
        wi: DVec3,
    ) -> bool {
        match self {
            Self::Walk => hidden(field, facet, landing, wi),
        }
    }
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
        doubt_texels: (place[0] - again[0]).hypot(place[1] - again[1]),
    })
}

/// Normal of the bilinear relief at a place in texels: inside a cell its height is linear in x and in y.
fn relief_normal(field: &ReliefField<'_>, facet: &Facet, [x, y]: [f64; 2]) -> DVec3 {
    let (x0, y0) = (x.floor(), y.floor());
    let slope = [
        field.displacement([x0 + 1.0, y]) - field.displacement([x0, y]),
        field.displacement([x, y0 + 1.0]) - field.displacement([x, y0]),
    ];
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
