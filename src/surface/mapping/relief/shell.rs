//! The layer over a surface that a relief fills, and a view ray through it.

use super::Found;
use crate::math::{Real, V2};
use crate::surface::SurfaceInteraction;
use crate::surface::mapping::BoundHeight;

/// Below this cosine between normal and view nothing is searched: the ray leaves the layer sideways, more
/// than 10⁶ heights away.
pub const MIN_COS: f32 = 1e-6;

/// A view ray by its displacement z over the tangent plane: `uv(z) = uv₀ + z·(V·∇u, V·∇v)/(V·N)`.
///
/// The surface-gradient form holds for sheared, scaled and mirrored charts alike.
#[derive(Debug, Clone, Copy)]
pub struct Shell<F: Real> {
    uv: V2<F>,
    per_z: V2<F>,
    /// Cosine between view and normal.
    pub cos: F,
    /// Where the search means something.
    pub usable: F::Mask,
    /// Largest displacement of the map.
    pub top: f32,
    /// Smallest.
    pub bottom: f32,
}

impl<F: Real> Shell<F> {
    /// The layer of a relief over a surface point.
    #[inline(always)]
    pub fn new(height: &BoundHeight<'_>, s: &SurfaceInteraction<F>) -> Self {
        let cos = s.wo.dot(s.n_shade);
        let per_z = V2::new(s.wo.dot(s.grad_u), s.wo.dot(s.grad_v)) * (cos.splat(1.0) / cos);
        let [bottom, top] = height.range();
        Self {
            uv: s.uv,
            per_z,
            cos,
            // A chart without area has nowhere to look.
            usable: cos.gt(cos.splat(MIN_COS))
                & per_z.is_finite()
                & !s.handedness.eq(cos.splat(0.0)),
            top,
            bottom,
        }
    }

    /// Texture coordinate at a displacement.
    #[inline(always)]
    pub fn uv(&self, z: F) -> V2<F> {
        self.uv + self.per_z * z
    }

    /// Change of the texture coordinate per unit of z.
    #[inline(always)]
    pub fn per_z(&self) -> V2<F> {
        self.per_z
    }

    /// Between top and bottom.
    #[inline(always)]
    pub fn thickness(&self) -> F {
        self.cos.splat(self.top - self.bottom)
    }

    /// The point of the ray at displacement `z`; where the search means nothing, the surface itself.
    #[inline(always)]
    pub fn found(&self, s: &SurfaceInteraction<F>, z: F, steps: F) -> Found<F> {
        let uv = self.uv(z);
        let usable = self.usable & uv.is_finite() & z.is_finite();
        let zero = z.splat(0.0);
        Found {
            uv: V2::select(usable, uv, s.uv),
            z: F::select(usable, z, zero),
            steps: F::select(usable, steps, zero),
        }
    }
}
