//! Rounding bounds of IEEE single precision.

/// Unit roundoff of `f32` (half a unit in the last place of 1): 2⁻²⁴.
pub const EPS: f32 = f32::EPSILON * 0.5;

/// `γₙ = nε / (1 − nε)`: bound on the relative error of `n` rounded operations in a row.
///
/// Source: Higham, *Accuracy and Stability of Numerical Algorithms*; PBRT 4th ed., §6.8.1.
#[must_use]
pub const fn gamma(n: u32) -> f32 {
    let n_eps = n as f32 * EPS;
    n_eps / (1.0 - n_eps)
}

/// The next float above `x`; infinities and NaN are returned as they are.
#[must_use]
pub fn next_up(x: f32) -> f32 {
    if x.is_finite() { x.next_up() } else { x }
}

/// The next float below `x`; infinities and NaN are returned as they are.
#[must_use]
pub fn next_down(x: f32) -> f32 {
    if x.is_finite() { x.next_down() } else { x }
}
