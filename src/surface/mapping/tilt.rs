//! How maps tilt normals.

use super::{BoundHeight, BoundNormal, Derivative};
use crate::math::{Real, V2, V3};
use crate::surface::SurfaceInteraction;
use crate::texture::NormalSpace;

/// How the normal tilts.
#[derive(Debug, Clone, Copy)]
pub(super) enum Tilt<'a> {
    Keep,
    Analytic(BoundHeight<'a>),
    Central(BoundHeight<'a>),
    Normal(BoundNormal<'a>),
    Baked(BoundNormal<'a>),
    Object(BoundNormal<'a>),
    Slope(BoundNormal<'a>),
}

impl<'a> Tilt<'a> {
    /// By the slopes of heights.
    pub(super) const fn bump(height: BoundHeight<'a>, derivative: Derivative) -> Self {
        match derivative {
            Derivative::Analytic => Self::Analytic(height),
            Derivative::Central => Self::Central(height),
        }
    }

    /// By a normal map.
    pub(super) const fn normal(map: BoundNormal<'a>) -> Self {
        match map.space {
            NormalSpace::Tangent => Self::Normal(map),
            NormalSpace::MikkTSpace => Self::Baked(map),
            NormalSpace::Object => Self::Object(map),
        }
    }

    /// Bilinear look-ups that one point costs.
    pub(super) const fn fetches(&self) -> u64 {
        match self {
            Self::Keep => 0,
            Self::Central(_) => 4,
            _ => 1,
        }
    }

    /// Variance of the slopes over the footprint of a point, the mean of both axes; 0 where nothing was made to
    /// tell it.
    #[inline(always)]
    pub(super) fn slope_variance<F: Real>(&self, s: &SurfaceInteraction<F>) -> F {
        match self {
            Self::Keep => s.footprint.splat(0.0),
            Self::Analytic(h) | Self::Central(h) => {
                h.slope_variance(s.uv, s.footprint, [s.grad_u, s.grad_v])
            }
            Self::Normal(n) | Self::Baked(n) | Self::Object(n) => {
                n.normal_variance(s.uv, s.footprint)
            }
            Self::Slope(n) => n.slope_variance(s.uv, s.footprint),
        }
    }

    /// Has memory bring what will be looked up at `uv` soon.
    #[inline(always)]
    pub(super) fn prefetch<F: Real>(&self, uv: V2<F>) {
        match self {
            Self::Keep => {}
            Self::Analytic(h) | Self::Central(h) => h.prefetch(uv),
            Self::Normal(n) | Self::Baked(n) | Self::Object(n) | Self::Slope(n) => n.prefetch(uv),
        }
    }

    #[inline(always)]
    pub(super) fn apply<F: Real>(&self, s: &mut SurfaceInteraction<F>) {
        match self {
            Self::Keep => {}
            Self::Analytic(h) => s.n_shade = bumped(s, h.analytic_slope(s.uv, s.footprint)),
            Self::Central(h) => s.n_shade = bumped(s, h.central_slope(s.uv, s.footprint)),
            // One look-up for all kinds of vectors: it is longer than what follows.
            Self::Normal(n) | Self::Baked(n) | Self::Object(n) | Self::Slope(n) => {
                let m = n.stored(s.uv, s.footprint);
                s.n_shade = match self {
                    Self::Baked(_) => baked_normal_mapped(m, n.strength, s),
                    Self::Object(_) => object_normal_mapped(m, n.strength, s),
                    Self::Slope(_) => slope_mapped(m, n.strength, s),
                    _ => tilted(s, m, n.strength),
                };
            }
        }
    }
}

/// `N' = normalize(N − d_u ∇u − d_v ∇v)` for a displacement with these derivatives by u and v.
///
/// Source: Blinn 1978 in the surface-gradient form of Mikkelsen 2010; report 2.16 in physical units.
#[inline(always)]
#[must_use]
pub fn bumped<F: Real>(s: &SurfaceInteraction<F>, slope: V2<F>) -> V3<F> {
    (s.n_shade - s.grad_u * slope.x - s.grad_v * slope.y).normalize_or(s.n_shade)
}

/// The same in the frame that MikkTSpace makes, which [`BakedFrame`](crate::surface::BakedFrame) has put in
/// the place of the surface's own: interpolated, neither normalised nor made perpendicular, because bakers
/// invert exactly that.
///
/// Source: the reference implementation's notes on pixel shaders, mikktspace.com.
#[inline(always)]
fn baked_normal_mapped<F: Real>(m: V3<F>, strength: f32, s: &SurfaceInteraction<F>) -> V3<F> {
    let n = s.n_shade;
    let zero = m.x.splat(0.0);
    let bitangent = n.cross(s.dp_du) * s.handedness;
    let tilted = n * m.z + (s.dp_du * m.x + bitangent * m.y) * zero.splat(strength);
    V3::select(!s.handedness.eq(zero), tilted.normalize_or(n), n)
}

/// `N' = normalize(m + (k − 1) (m − (m·N) N))`: a normal in the axes of the model's file, its tilt against the
/// smooth normal scaled by k. For k = 1 exactly what is stored.
///
/// Needs no frame, so that charts may be mirrored or without area.
#[inline(always)]
fn object_normal_mapped<F: Real>(m: V3<F>, strength: f32, s: &SurfaceInteraction<F>) -> V3<F> {
    let n = s.n_shade;
    let across = m - n * n.dot(m);
    (m + across * m.x.splat(strength - 1.0)).normalize_or(n)
}

/// `N' = normalize(N − k (h_x T + h_y B))` with slopes from red and green (report 2.4.2 and 2.16).
#[inline(always)]
fn slope_mapped<F: Real>(stored: V3<F>, strength: f32, s: &SurfaceInteraction<F>) -> V3<F> {
    let up = stored.z.splat(1.0);
    tilted(s, V3::new(-stored.x, -stored.y, up), strength)
}

/// `N' = normalize(m_z N + k (m_x T + m_y B))`: a tangent-space normal `m` with its slopes scaled by k.
///
/// T follows +u on the triangle, made perpendicular to the smooth normal; B completes the frame on the
/// side of +v. Where the texture has no area the normal stays.
#[inline(always)]
fn tilted<F: Real>(s: &SurfaceInteraction<F>, m: V3<F>, strength: f32) -> V3<F> {
    let n = s.n_shade;
    let zero = s.handedness.splat(0.0);
    let none = V3::new(zero, zero, zero);
    let tangent = (s.dp_du - n * n.dot(s.dp_du)).normalize_or(none);
    let bitangent = n.cross(tangent) * s.handedness;
    let tilted = n * m.z + (tangent * m.x + bitangent * m.y) * zero.splat(strength);
    let has_frame = tangent.dot(tangent).gt(zero) & !s.handedness.eq(zero);
    V3::select(has_frame, tilted.normalize_or(n), n)
}
