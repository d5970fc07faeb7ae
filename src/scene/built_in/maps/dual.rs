//! Numbers that carry their exact derivatives by u and v.

use std::ops::{Add, Mul, Neg, Sub};

use super::exact::{exp_neg, floor, sin_cos_turns};

/// A value with its partial derivatives by the two texture coordinates (forward-mode dual number).
///
/// Sums, products and the functions below carry the derivatives by the chain rule, so a height written
/// once yields its slopes without differences. At a kink (`min`, `max`, `fract`) the derivative is that
/// of the branch taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual {
    /// The value.
    pub value: f64,
    /// Derivative by u.
    pub du: f64,
    /// Derivative by v.
    pub dv: f64,
}

impl Dual {
    /// A number that depends on neither coordinate.
    #[must_use]
    pub const fn constant(value: f64) -> Self {
        Self::new(value, 0.0, 0.0)
    }

    /// The coordinate u itself.
    #[must_use]
    pub const fn u(value: f64) -> Self {
        Self::new(value, 1.0, 0.0)
    }

    /// The coordinate v itself.
    #[must_use]
    pub const fn v(value: f64) -> Self {
        Self::new(value, 0.0, 1.0)
    }

    const fn new(value: f64, du: f64, dv: f64) -> Self {
        Self { value, du, dv }
    }

    /// `f(self)`, given that value and `f'(self)`.
    #[must_use]
    pub fn chain(self, value: f64, slope: f64) -> Self {
        Self::new(value, self.du * slope, self.dv * slope)
    }

    /// `f(x, y)`, given that value and its two partial derivatives.
    #[must_use]
    pub fn chain2(x: Self, y: Self, [value, dx, dy]: [f64; 3]) -> Self {
        Self::new(value, x.du * dx + y.du * dy, x.dv * dx + y.dv * dy)
    }

    /// The square.
    #[must_use]
    pub fn squared(self) -> Self {
        self * self
    }

    /// The root. The argument must be positive: at 0 the slope is infinite.
    #[must_use]
    pub fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }

    /// One over a number that is not 0.
    #[must_use]
    pub fn recip(self) -> Self {
        let r = 1.0 / self.value;
        self.chain(r, -r * r)
    }

    /// Cosine of an angle in turns.
    #[must_use]
    pub fn cos_turns(self) -> Self {
        let (sin, cos) = sin_cos_turns(self.value);
        self.chain(cos, -std::f64::consts::TAU * sin)
    }

    /// Sine of an angle in turns.
    #[must_use]
    pub fn sin_turns(self) -> Self {
        let (sin, cos) = sin_cos_turns(self.value);
        self.chain(sin, std::f64::consts::TAU * cos)
    }

    /// `e^−x` for `x ≥ 0`.
    #[must_use]
    pub fn exp_neg(self) -> Self {
        let e = exp_neg(self.value);
        self.chain(e, -e)
    }

    /// The part above the next lower whole number, in `[0, 1)`.
    #[must_use]
    pub fn fract(self) -> Self {
        self.chain(self.value - floor(self.value) as f64, 1.0)
    }

    /// The smaller one.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        if self.value <= other.value {
            self
        } else {
            other
        }
    }

    /// The larger one.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        if self.value >= other.value {
            self
        } else {
            other
        }
    }

    /// Limited to `[low, high]`; flat outside.
    #[must_use]
    pub fn clamp(self, low: f64, high: f64) -> Self {
        self.max(Self::constant(low)).min(Self::constant(high))
    }

    /// 0 up to `low`, 1 from `high`, twice continuously differentiable between (Perlin 2002's quintic).
    #[must_use]
    pub fn smoothstep(self, low: f64, high: f64) -> Self {
        let scale = 1.0 / (high - low);
        let t = ((self.value - low) * scale).clamp(0.0, 1.0);
        let rise = 30.0 * t * t * (t - 1.0) * (t - 1.0);
        self.chain(t * t * t * (t * (t * 6.0 - 15.0) + 10.0), rise * scale)
    }

    /// The smaller one with its kink rounded over differences up to `k`: continuously differentiable.
    #[must_use]
    pub fn smooth_min(self, other: Self, k: f64) -> Self {
        let t = (other.value - self.value) * (0.5 / k) + 0.5;
        if t >= 1.0 {
            return self;
        }
        if t <= 0.0 {
            return other;
        }
        // ∂/∂t cancels in the quadratic blend, which leaves the plain mean of the slopes.
        let blend = |a: f64, b: f64| b + (a - b) * t;
        Self::new(
            blend(self.value, other.value) - k * t * (1.0 - t),
            blend(self.du, other.du),
            blend(self.dv, other.dv),
        )
    }

    /// `self` where `t` is 0, `other` where it is 1.
    #[must_use]
    pub fn lerp(self, other: Self, t: Self) -> Self {
        self + (other - self) * t
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self::new(self.value + o.value, self.du + o.du, self.dv + o.dv)
    }
}
impl Sub for Dual {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self::new(self.value - o.value, self.du - o.du, self.dv - o.dv)
    }
}
impl Mul for Dual {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self::new(
            self.value * o.value,
            self.du * o.value + self.value * o.du,
            self.dv * o.value + self.value * o.dv,
        )
    }
}
impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.value, -self.du, -self.dv)
    }
}
impl Add<f64> for Dual {
    type Output = Self;
    fn add(self, k: f64) -> Self {
        Self::new(self.value + k, self.du, self.dv)
    }
}
impl Sub<f64> for Dual {
    type Output = Self;
    fn sub(self, k: f64) -> Self {
        Self::new(self.value - k, self.du, self.dv)
    }
}
impl Mul<f64> for Dual {
    type Output = Self;
    fn mul(self, k: f64) -> Self {
        Self::new(self.value * k, self.du * k, self.dv * k)
    }
}
impl Sub<Dual> for f64 {
    type Output = Dual;
    fn sub(self, d: Dual) -> Dual {
        -d + self
    }
}
