//! Vectors of two and three [`Real`]s.

use std::ops::{Add, Div, Mul, Neg, Sub};

use glam::{DVec3, Vec2, Vec3};

use super::real::{Mask, Real};

/// A pair of coordinates; with vector lanes, one pair for each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct V2<F = f32> {
    /// First.
    pub x: F,
    /// Second.
    pub y: F,
}

/// A point or direction in space; with vector lanes, one for each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct V3<F = f32> {
    /// First.
    pub x: F,
    /// Second.
    pub y: F,
    /// Third.
    pub z: F,
}

/// Angle between two directions, radians, without the loss of the arc cosine near 0.
#[must_use]
pub fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

impl<F: Real> V2<F> {
    /// From two coordinates.
    #[inline(always)]
    #[must_use]
    pub fn new(x: F, y: F) -> Self {
        Self { x, y }
    }

    /// The same pair in as many lanes as `like` has.
    #[inline(always)]
    #[must_use]
    pub fn splat(like: F, v: impl Into<V2>) -> Self {
        let v = v.into();
        Self::new(like.splat(v.x), like.splat(v.y))
    }

    /// `yes` where the mask holds, else `no`.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self::new(F::select(mask, yes.x, no.x), F::select(mask, yes.y, no.y))
    }

    /// Each coordinate times that of a pair that all lanes share.
    #[inline(always)]
    #[must_use]
    pub fn times(self, v: impl Into<V2>) -> Self {
        let v = v.into();
        Self::new(self.x * v.x, self.y * v.y)
    }

    /// Each coordinate plus that of a pair that all lanes share.
    #[inline(always)]
    #[must_use]
    pub fn plus(self, v: impl Into<V2>) -> Self {
        let v = v.into();
        Self::new(self.x + v.x, self.y + v.y)
    }

    /// Whether both coordinates are finite.
    #[inline(always)]
    pub fn is_finite(self) -> F::Mask {
        self.x.is_finite() & self.y.is_finite()
    }
}

impl<F: Real> V3<F> {
    /// From three coordinates.
    #[inline(always)]
    #[must_use]
    pub fn new(x: F, y: F, z: F) -> Self {
        Self { x, y, z }
    }

    /// The same vector in as many lanes as `like` has.
    #[inline(always)]
    #[must_use]
    pub fn splat(like: F, v: impl Into<V3>) -> Self {
        let v = v.into();
        Self::new(like.splat(v.x), like.splat(v.y), like.splat(v.z))
    }

    /// `yes` where the mask holds, else `no`.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self::new(
            F::select(mask, yes.x, no.x),
            F::select(mask, yes.y, no.y),
            F::select(mask, yes.z, no.z),
        )
    }

    /// Scalar product.
    #[inline(always)]
    #[must_use]
    pub fn dot(self, o: Self) -> F {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Vector product.
    #[inline(always)]
    #[must_use]
    pub fn cross(self, o: Self) -> Self {
        Self::new(
            self.y * o.z - self.z * o.y,
            self.z * o.x - self.x * o.z,
            self.x * o.y - self.y * o.x,
        )
    }

    /// Magnitude of each coordinate.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }

    /// Length.
    #[inline(always)]
    #[must_use]
    pub fn length(self) -> F {
        self.dot(self).sqrt()
    }

    /// Whether all coordinates are finite.
    #[inline(always)]
    pub fn is_finite(self) -> F::Mask {
        self.x.is_finite() & self.y.is_finite() & self.z.is_finite()
    }

    /// `v / |v|`, or `fallback` where the length is zero or not finite.
    #[inline(always)]
    #[must_use]
    pub fn normalize_or(self, fallback: Self) -> Self {
        let Self { x, y, z } = self.abs();
        // A sum, so that NaN anywhere is NaN.
        let magnitude = x + y + z;
        let usual = magnitude.gt(x.splat(1e-15)) & magnitude.lt(x.splat(1e15));
        if usual.all() {
            return self * (x.splat(1.0) / self.length());
        }
        // Dividing first keeps the squared length inside the range of f32 for lengths of 10^±30.
        let largest = x.larger(y).larger(z);
        let scaled = Self::select(usual, self, self / largest);
        let unit = scaled * (x.splat(1.0) / scaled.length());
        let has_direction = largest.gt(x.splat(0.0)) & self.is_finite();
        Self::select(has_direction, unit, fallback)
    }
}

macro_rules! per_coordinate {
    ($vector:ident { $($c:ident),* }) => {
        impl<F: Real> Add for $vector<F> {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                Self { $($c: self.$c + o.$c),* }
            }
        }
        impl<F: Real> Sub for $vector<F> {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                Self { $($c: self.$c - o.$c),* }
            }
        }
        impl<F: Real> Neg for $vector<F> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self { $($c: -self.$c),* }
            }
        }
        impl<F: Real> Mul<F> for $vector<F> {
            type Output = Self;
            #[inline(always)]
            fn mul(self, k: F) -> Self {
                Self { $($c: self.$c * k),* }
            }
        }
        impl<F: Real> Div<F> for $vector<F> {
            type Output = Self;
            #[inline(always)]
            fn div(self, k: F) -> Self {
                Self { $($c: self.$c / k),* }
            }
        }
    };
}
per_coordinate!(V2 { x, y });
per_coordinate!(V3 { x, y, z });

impl From<Vec2> for V2 {
    #[inline(always)]
    fn from(v: Vec2) -> Self {
        Self { x: v.x, y: v.y }
    }
}
impl From<V2> for Vec2 {
    #[inline(always)]
    fn from(v: V2) -> Self {
        Self::new(v.x, v.y)
    }
}
impl From<Vec3> for V3 {
    #[inline(always)]
    fn from(v: Vec3) -> Self {
        Self {
            x: v.x,
            y: v.y,
            z: v.z,
        }
    }
}
impl From<V3> for Vec3 {
    #[inline(always)]
    fn from(v: V3) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}
impl From<V2> for [f32; 2] {
    fn from(v: V2) -> Self {
        [v.x, v.y]
    }
}
impl From<V3> for [f32; 3] {
    fn from(v: V3) -> Self {
        [v.x, v.y, v.z]
    }
}
