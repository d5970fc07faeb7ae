//! The one door through which maps change a surface.

use super::{BoundHeight, BoundNormal, Derivative, Lookup, MappingSettings, Method};
use crate::math::{Real, V2, V3};
use crate::surface::SurfaceInteraction;

/// Below this cosine between normal and view, plain parallax does not shift: the division by it would
/// throw the coordinate more than 10⁴ heights away.
const MIN_PARALLAX_COS: f32 = 1e-4;

/// The maps of one material that mapping may use; `None` for what it lacks.
#[derive(Debug, Clone, Copy, Default)]
pub struct MaterialMaps<'a> {
    /// Heights.
    pub height: Option<BoundHeight<'a>>,
    /// Tangent-space normals.
    pub normal: Option<BoundNormal<'a>>,
    /// Slopes in red and green.
    pub slope: Option<BoundNormal<'a>>,
}

/// How texture coordinates move.
#[derive(Debug, Clone, Copy)]
enum Shift<'a> {
    Stay,
    Parallax(BoundHeight<'a>),
    Limited(BoundHeight<'a>),
}

/// How the normal tilts.
#[derive(Debug, Clone, Copy)]
enum Tilt<'a> {
    Keep,
    Analytic(BoundHeight<'a>),
    Central(BoundHeight<'a>),
    Normal(BoundNormal<'a>),
    Slope(BoundNormal<'a>),
}

/// What one material does at every point: chosen once, then run over a tile's points without asking
/// again.
#[derive(Debug, Clone, Copy)]
pub struct MaterialMapping<'a> {
    shift: Shift<'a>,
    tilt: Tilt<'a>,
}

impl<'a> MaterialMapping<'a> {
    /// No map is read.
    pub const NONE: Self = Self {
        shift: Shift::Stay,
        tilt: Tilt::Keep,
    };

    /// What `settings` ask of a material with these maps. A method whose map is missing or switched off
    /// does nothing; parallax asked to look up a normal map that is not there looks up the height map.
    #[must_use]
    pub fn choose(settings: &MappingSettings, maps: &MaterialMaps<'a>) -> Self {
        // Amplitude 0 must be the picture of `none` to the bit, so it runs the same code.
        let height = maps.height.filter(|h| h.scale != 0.0 || h.offset != 0.0);
        let tilting_height = height.filter(|h| settings.use_height && h.scale != 0.0);
        let bent = |n: &BoundNormal<'_>| settings.use_normal && n.strength != 0.0;
        let normal = maps.normal.filter(bent);
        let slope = maps.slope.filter(bent);

        let bump = tilting_height.map_or(Tilt::Keep, |h| match settings.derivative {
            Derivative::Analytic => Tilt::Analytic(h),
            Derivative::Central => Tilt::Central(h),
        });
        let normal = normal.map_or(Tilt::Keep, Tilt::Normal);
        match settings.method {
            Method::None => Self::NONE,
            Method::Bump => Self {
                shift: Shift::Stay,
                tilt: bump,
            },
            Method::Slope => {
                let tilt = slope.map_or_else(
                    || tilting_height.map_or(Tilt::Keep, Tilt::Central),
                    Tilt::Slope,
                );
                Self {
                    shift: Shift::Stay,
                    tilt,
                }
            }
            Method::Normal => Self {
                shift: Shift::Stay,
                tilt: normal,
            },
            Method::Parallax | Method::ParallaxLimited => {
                let shift = match height.filter(|_| settings.use_parallax) {
                    None => Shift::Stay,
                    Some(h) if settings.method == Method::Parallax => Shift::Parallax(h),
                    Some(h) => Shift::Limited(h),
                };
                let tilt = match (settings.lookup, normal) {
                    (Lookup::Normal, Tilt::Normal(_)) => normal,
                    _ => bump,
                };
                Self { shift, tilt }
            }
        }
    }

    /// Whether any map is read; if not, no texture coordinate is needed for mapping.
    #[must_use]
    pub const fn is_active(&self) -> bool {
        !matches!((&self.shift, &self.tilt), (Shift::Stay, Tilt::Keep))
    }

    /// Whether texture coordinates move.
    #[must_use]
    pub const fn shifts(&self) -> bool {
        !matches!(self.shift, Shift::Stay)
    }

    /// Bilinear look-ups that one point costs.
    #[must_use]
    pub const fn fetches_per_point(&self) -> u64 {
        let shift = match self.shift {
            Shift::Stay => 0,
            Shift::Parallax(_) | Shift::Limited(_) => 1,
        };
        let tilt = match self.tilt {
            Tilt::Keep => 0,
            Tilt::Analytic(_) | Tilt::Normal(_) | Tilt::Slope(_) => 1,
            Tilt::Central(_) => 4,
        };
        shift + tilt
    }

    /// Moves the texture coordinate and tilts `n_shade` of a point, or of one in each lane. It must have
    /// texture coordinates and lie on this material. Normals stay on the front side's terms; facing the eye
    /// is decided later.
    #[inline(always)]
    pub fn apply<F: Real>(&self, s: &mut SurfaceInteraction<F>) {
        match &self.shift {
            Shift::Stay => {}
            Shift::Parallax(h) => s.uv = parallax(h, s),
            Shift::Limited(h) => s.uv = parallax_limited(h, s),
        }
        match &self.tilt {
            Tilt::Keep => {}
            Tilt::Analytic(h) => s.n_shade = bumped(s, h.analytic_slope(s.uv)),
            Tilt::Central(h) => s.n_shade = bumped(s, h.central_slope(s.uv)),
            Tilt::Normal(n) => s.n_shade = normal_mapped(n, s),
            Tilt::Slope(n) => s.n_shade = slope_mapped(n, s),
        }
    }
}

/// Where the eye really lands, by the height at the point it looks at (report 2.17, Kaneko 2001).
///
/// `Δuv = d · (V·∇u, V·∇v) / (V·N)` with the displacement `d` in the same length unit as the gradients:
/// the report's tangent-space form without inverting any matrix, for sheared and mirrored charts alike.
/// Unchanged where the eye is under the surface or nearly in its plane.
#[inline(always)]
#[must_use]
pub fn parallax<F: Real>(height: &BoundHeight<'_>, s: &SurfaceInteraction<F>) -> V2<F> {
    let cos = s.wo.dot(s.n_shade);
    let above = cos.gt(cos.splat(MIN_PARALLAX_COS));
    moved(s, above, height.displacement(s.uv) / cos)
}

/// Parallax with offset limiting (report 2.18, Welsh 2004): without the division the shift is at most
/// the height, and the relief flattens towards the horizon.
///
/// Unchanged where the eye is under the surface.
#[inline(always)]
#[must_use]
pub fn parallax_limited<F: Real>(height: &BoundHeight<'_>, s: &SurfaceInteraction<F>) -> V2<F> {
    let cos = s.wo.dot(s.n_shade);
    moved(s, cos.gt(cos.splat(0.0)), height.displacement(s.uv))
}

#[inline(always)]
fn moved<F: Real>(s: &SurfaceInteraction<F>, above: F::Mask, along_view: F) -> V2<F> {
    let uv = s.uv + V2::new(s.wo.dot(s.grad_u), s.wo.dot(s.grad_v)) * along_view;
    V2::select(above & uv.is_finite(), uv, s.uv)
}

/// `N' = normalize(N − d_u ∇u − d_v ∇v)` for a displacement with these derivatives by u and v.
///
/// Source: Blinn 1978 in the surface-gradient form of Mikkelsen 2010; report 2.16 in physical units.
#[inline(always)]
#[must_use]
pub fn bumped<F: Real>(s: &SurfaceInteraction<F>, slope: V2<F>) -> V3<F> {
    (s.n_shade - s.grad_u * slope.x - s.grad_v * slope.y).normalize_or(s.n_shade)
}

/// `N' = normalize(m_z N + k (m_x T + m_y B))`: a tangent-space normal `m` with its slopes scaled by k.
///
/// T follows +u on the triangle, made perpendicular to the smooth normal; B completes the frame on the
/// side of +v. Where the texture has no area the normal stays.
#[inline(always)]
#[must_use]
pub fn normal_mapped<F: Real>(map: &BoundNormal<'_>, s: &SurfaceInteraction<F>) -> V3<F> {
    tilted(s, map.stored(s.uv), map.strength)
}

/// `N' = normalize(N − k (h_x T + h_y B))` with slopes from red and green (report 2.4.2 and 2.16).
#[inline(always)]
#[must_use]
pub fn slope_mapped<F: Real>(map: &BoundNormal<'_>, s: &SurfaceInteraction<F>) -> V3<F> {
    let stored = map.stored(s.uv);
    let up = stored.z.splat(1.0);
    tilted(s, V3::new(-stored.x, -stored.y, up), map.strength)
}

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
