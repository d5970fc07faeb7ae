//! Doubles of vector lanes in memory: where lanes are filled and looked at one by one.

use super::simd::{Simd, SimdBase as _};

/// Most doubles that a vector of any machine has.
pub const MAX_LANES: usize = 8;

/// A double for each lane.
pub type Row = [f64; MAX_LANES];

/// Lanes from memory.
#[inline(always)]
pub fn load<S: Simd>(simd: S, row: &Row) -> S::f64s {
    S::f64s::from_slice(simd, &row[..S::f64s::LEN])
}

/// Lanes to memory.
#[inline(always)]
pub fn store<S: Simd>(x: S::f64s) -> Row {
    let mut row = [0.0; MAX_LANES];
    x.store_slice(&mut row[..S::f64s::LEN]);
    row
}
