//! The one door through which maps change a surface.

use super::relief::{
    Found, Layers, Refinement, ReliefField, cone_steps, exact, iterate, march, most_steps,
};
use super::tilt::Tilt;
use super::{BoundHeight, BoundNormal, Lookup, MappingSettings, Method};
use crate::math::{Real, V2, gamma};
use crate::surface::SurfaceInteraction;
use crate::texture::{ConeMap, HeightPyramid, HorizonMap};

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
    /// Extremes of the heights, for the exact walk and for relief that shadows itself.
    pub pyramid: Option<&'a HeightPyramid>,
    /// Horizons of the heights, for relief that shadows itself.
    pub horizons: Option<&'a HorizonMap>,
    /// Cones over the heights, for relaxed cone stepping.
    pub cones: Option<&'a ConeMap>,
}

/// How texture coordinates move.
#[derive(Debug, Clone, Copy)]
enum Shift<'a> {
    Stay,
    Parallax(BoundHeight<'a>),
    Limited(BoundHeight<'a>),
    Search(Search<'a>),
}

/// A search along the view ray.
#[derive(Debug, Clone, Copy)]
enum Search<'a> {
    Iterate(BoundHeight<'a>, u32),
    March(BoundHeight<'a>, Layers, Refinement),
    Cones(BoundHeight<'a>, &'a ConeMap, [u32; 2]),
    Exact(ReliefField<'a>),
}

/// What one material does at every point: chosen once, then run over a tile's points without asking
/// again.
#[derive(Debug, Clone, Copy)]
pub struct MaterialMapping<'a> {
    shift: Shift<'a>,
    tilt: Tilt<'a>,
    self_shadow: Option<ReliefField<'a>>,
}

impl<'a> MaterialMapping<'a> {
    /// No map is read.
    pub const NONE: Self = Self {
        shift: Shift::Stay,
        tilt: Tilt::Keep,
        self_shadow: None,
    };

    /// What `settings` ask of a material with these maps. A method whose map is missing or switched off
    /// does nothing; parallax asked to look up a normal map that is not there looks up the height map.
    #[must_use]
    pub fn choose(settings: &MappingSettings, maps: &MaterialMaps<'a>) -> Self {
        // Amplitude 0 must be the picture of `none` to the bit, so it runs the same code.
        let height = maps.height.filter(BoundHeight::moves);
        let tilting_height = height.filter(|h| settings.use_height && h.scale != 0.0);
        let bent = |n: &BoundNormal<'_>| settings.use_normal && n.strength != 0.0;
        let normal = maps.normal.filter(bent);
        let slope = maps.slope.filter(bent);

        let bump = tilting_height.map_or(Tilt::Keep, |h| Tilt::bump(h, settings.derivative));
        let by_normals = normal.map_or(Tilt::Keep, Tilt::normal);
        let tilted = |tilt| Self { tilt, ..Self::NONE };
        match settings.method {
            // Displacement is geometry: what is left to do here is nothing.
            Method::None | Method::Displacement => Self::NONE,
            Method::Bump => tilted(bump),
            Method::Slope => {
                let central = || tilting_height.map_or(Tilt::Keep, Tilt::Central);
                tilted(slope.map_or_else(central, Tilt::Slope))
            }
            Method::Normal => tilted(by_normals),
            method => {
                let shift = height
                    .filter(|_| settings.use_parallax)
                    .and_then(|h| Shift::choose(method, settings, h, maps));
                let tilt = match settings.lookup {
                    Lookup::Normal if normal.is_some() => by_normals,
                    _ => bump,
                };
                let self_shadow = match (shift, height, maps.pyramid) {
                    (Some(Shift::Search(_)), Some(height), Some(pyramid))
                        if settings.search.self_shadow =>
                    {
                        ReliefField::new(height, pyramid)
                            .map(|field| field.with_horizons(maps.horizons))
                    }
                    _ => None,
                };
                Self {
                    shift: shift.unwrap_or(Shift::Stay),
                    tilt,
                    self_shadow,
                }
            }
        }
    }

    /// The relief that shadows itself, if it does.
    #[must_use]
    pub const fn self_shadow(&self) -> Option<&ReliefField<'a>> {
        self.self_shadow.as_ref()
    }

    /// Whether the place that the eye sees is searched for.
    #[must_use]
    pub const fn searches(&self) -> bool {
        matches!(self.shift, Shift::Search(_))
    }

    /// Steps at which the search for a point gives up; `None` without a search, and for those that cannot stop
    /// short: layers end at the relief's bottom, and `iterative` always takes all its steps.
    #[must_use]
    pub fn most_steps(&self, s: &SurfaceInteraction) -> Option<f32> {
        let Shift::Search(search) = &self.shift else {
            return None;
        };
        match search {
            Search::Iterate(..) | Search::March(..) => None,
            Search::Cones(_, _, [steps, bisections]) => Some((steps + bisections) as f32),
            Search::Exact(field) => Some(most_steps(field, s)),
        }
    }

    /// The relief that is walked for every point: such points can be walked for together.
    #[must_use]
    pub const fn walks(&self) -> Option<&ReliefField<'a>> {
        match &self.shift {
            Shift::Search(Search::Exact(field)) => Some(field),
            _ => None,
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

    /// Whether normals are told in the frame that MikkTSpace makes, so that points need a
    /// [`BakedFrame`](crate::surface::BakedFrame).
    #[must_use]
    pub const fn needs_baked_frame(&self) -> bool {
        matches!(self.tilt, Tilt::Baked(_))
    }

    /// Bilinear look-ups that one point costs, beside the steps of a search.
    #[must_use]
    pub const fn fetches_per_point(&self) -> u64 {
        let shift = match self.shift {
            Shift::Stay | Shift::Search(_) => 0,
            Shift::Parallax(_) | Shift::Limited(_) => 1,
        };
        shift + self.tilt.fetches()
    }

    /// Moves the texture coordinate and tilts `n_shade` of a point, or of one in each lane. It must have
    /// texture coordinates and lie on this material. Normals stay on the front side's terms; facing the eye
    /// is decided later. Searches leave out points that are not `wanted`, and do not begin if what they would
    /// come to is `known`.
    #[inline(always)]
    pub fn apply<F: Real>(
        &self,
        s: &mut SurfaceInteraction<F>,
        wanted: F::Mask,
        known: Option<Found<F>>,
    ) {
        self.shift(s, wanted, known);
        self.tilt.apply(s);
    }

    /// Has memory bring what points that are seen around `uv` will look up soon, searches left out.
    #[inline(always)]
    pub fn prefetch<F: Real>(&self, uv: V2<F>) {
        if let Shift::Parallax(h) | Shift::Limited(h) = &self.shift {
            h.prefetch(uv);
        }
        self.tilt.prefetch(uv);
    }

    #[inline(always)]
    fn shift<F: Real>(
        &self,
        s: &mut SurfaceInteraction<F>,
        wanted: F::Mask,
        known: Option<Found<F>>,
    ) {
        let found = match (&self.shift, known) {
            (Shift::Search(search), None) => Some(search.run(s, wanted)),
            (Shift::Search(_), known) => known,
            (Shift::Stay, _) => None,
            (Shift::Parallax(h), _) => {
                s.uv = parallax(h, s);
                None
            }
            (Shift::Limited(h), _) => {
                s.uv = parallax_limited(h, s);
                None
            }
        };
        if let Some(found) = found {
            move_to(s, &found);
        }
    }

    /// [`Self::apply`] for a single point. Compiled once, not where it is called: it is as long as all methods
    /// together.
    #[inline(never)]
    pub fn apply_to_point(&self, s: &mut SurfaceInteraction) {
        self.apply(s, true, None);
    }

    /// The texture coordinate that is seen at a single point.
    #[inline(never)]
    #[must_use]
    pub fn uv_seen(&self, mut s: SurfaceInteraction) -> V2 {
        self.shift(&mut s, true, None);
        s.uv
    }

    /// How much the slopes of the relief differ over the footprint of a point that maps were applied to: the
    /// variance, the mean of both axes. 0 for maps that are read at points.
    #[inline(always)]
    #[must_use]
    pub fn slope_variance<F: Real>(&self, s: &SurfaceInteraction<F>) -> F {
        self.tilt.slope_variance(s)
    }
}

impl<'a> Shift<'a> {
    /// How a method moves texture coordinates over these heights; `None` if it lacks a map.
    fn choose(
        method: Method,
        settings: &MappingSettings,
        height: BoundHeight<'a>,
        maps: &MaterialMaps<'a>,
    ) -> Option<Self> {
        let search = &settings.search;
        let layers = Layers::fixed(search.layers);
        let bisection = Refinement::Bisection(search.bisections);
        Some(Self::Search(match method {
            Method::None | Method::Bump | Method::Slope | Method::Normal | Method::Displacement => {
                return None;
            }
            Method::Parallax => return Some(Self::Parallax(height)),
            Method::ParallaxLimited => return Some(Self::Limited(height)),
            Method::Iterative => Search::Iterate(height, search.iterations),
            Method::Steep => Search::March(height, layers, Refinement::None),
            Method::Occlusion => {
                let layers = Layers {
                    fewest: search.min_layers.min(search.layers),
                    most: search.layers,
                };
                Search::March(height, layers, Refinement::Secant)
            }
            Method::Relief => Search::March(height, layers, bisection),
            Method::RelaxedCone => {
                Search::Cones(height, maps.cones?, [search.layers, search.bisections])
            }
            Method::Exact => Search::Exact(ReliefField::new(height, maps.pyramid?)?),
        }))
    }
}

impl Search<'_> {
    #[inline(always)]
    fn run<F: Real>(&self, s: &SurfaceInteraction<F>, wanted: F::Mask) -> Found<F> {
        match self {
            Self::Iterate(height, iterations) => iterate(height, s, *iterations),
            Self::March(height, layers, refinement) => {
                march(height, s, wanted, *layers, *refinement)
            }
            Self::Cones(height, cones, [steps, bisections]) => {
                cone_steps((height, cones), s, wanted, *steps, *bisections)
            }
            Self::Exact(field) => exact(field, s, wanted),
        }
    }
}

/// Moves a point along its view ray to the place that a search found.
#[inline(always)]
fn move_to<F: Real>(s: &mut SurfaceInteraction<F>, found: &Found<F>) {
    let zero = found.z.splat(0.0);
    let cos = s.wo.dot(s.n_shade);
    let distance = found.z / cos;
    let moved = distance.is_finite() & !found.z.eq(zero);
    let distance = F::select(moved, distance, zero);
    let way = s.wo * distance;
    s.p = s.p + way;
    s.p_error = s.p_error + (way.abs() + s.p.abs()) * zero.splat(gamma(4));
    s.sunk = -(distance * s.wo.dot(s.n_geo));
    s.uv = found.uv;
    s.steps = found.steps;
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
    moved(s, above, height.displacement_over(s.uv, s.footprint) / cos)
}

/// Parallax with offset limiting (report 2.18, Welsh 2004): without the division the shift is at most
/// the height, and the relief flattens towards the horizon.
///
/// Unchanged where the eye is under the surface.
#[inline(always)]
#[must_use]
pub fn parallax_limited<F: Real>(height: &BoundHeight<'_>, s: &SurfaceInteraction<F>) -> V2<F> {
    let cos = s.wo.dot(s.n_shade);
    moved(
        s,
        cos.gt(cos.splat(0.0)),
        height.displacement_over(s.uv, s.footprint),
    )
}

#[inline(always)]
fn moved<F: Real>(s: &SurfaceInteraction<F>, above: F::Mask, along_view: F) -> V2<F> {
    let uv = s.uv + V2::new(s.wo.dot(s.grad_u), s.wo.dot(s.grad_v)) * along_view;
    V2::select(above & uv.is_finite(), uv, s.uv)
}
