//! Which vector instructions the kernels use: the one door to `fearless_simd`.

use std::fmt;
use std::sync::atomic::{AtomicU8, Ordering};

use fearless_simd::Level;

pub(crate) use fearless_simd::{Bytes, Select, Simd, SimdBase, SimdFloat, SimdMask};
pub(crate) use fearless_simd::{ExtractToken, SimdCvtFloat, SimdNarrow, SimdWiden, f32x8};

/// The token of plain code, which every machine runs.
pub(crate) const PLAIN: fearless_simd::Fallback = fearless_simd::Fallback::new();

/// A set of vector instructions. All give the same bits; they differ in speed alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SimdLevel {
    /// One ray at a time: the plain kernel that the others are measured against.
    Scalar,
    /// Four lanes, on any x86-64 since 2008.
    Sse42,
    /// Eight lanes.
    Avx2,
    /// Sixteen lanes, on processors from Ice Lake and Zen 4 on.
    Avx512,
    /// Four lanes, on any 64-bit ARM.
    Neon,
}

/// A level that this machine lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("this machine does not have {0}")]
pub struct UnsupportedLevel(pub SimdLevel);

/// What [`force_level`] chose: its place in [`SimdLevel::ALL`], or [`NOT_FORCED`].
static FORCED: AtomicU8 = AtomicU8::new(NOT_FORCED);
const NOT_FORCED: u8 = u8::MAX;

/// The level of trees built from now on: the forced one, otherwise the best of this machine.
#[must_use]
pub fn simd_level() -> SimdLevel {
    let forced = SimdLevel::ALL.get(usize::from(FORCED.load(Ordering::Relaxed)));
    forced.copied().unwrap_or_else(SimdLevel::best)
}

/// Chooses the level of all trees that this process builds from now on; for comparisons.
///
/// # Errors
/// If this machine lacks it; then nothing changes.
pub fn force_level(level: SimdLevel) -> Result<(), UnsupportedLevel> {
    if !level.is_available() {
        return Err(UnsupportedLevel(level));
    }
    FORCED.store(level as u8, Ordering::Relaxed);
    Ok(())
}

impl SimdLevel {
    /// All levels of all machines.
    pub const ALL: [Self; 5] = [
        Self::Scalar,
        Self::Sse42,
        Self::Avx2,
        Self::Avx512,
        Self::Neon,
    ];

    /// Name on the command line and in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Sse42 => "sse4.2",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Neon => "neon",
        }
    }

    /// The level of that [`Self::name`].
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|level| level.name() == name)
    }

    /// The fastest that this machine has.
    #[must_use]
    pub fn best() -> Self {
        let available = Self::ALL
            .into_iter()
            .rev()
            .find(|level| level.is_available());
        available.unwrap_or(Self::Scalar)
    }

    /// Whether this machine has it.
    #[must_use]
    pub fn is_available(self) -> bool {
        self == Self::Scalar || self.token().is_some()
    }

    /// Runs a kernel compiled for this level; `false` if there is none, as for [`Self::Scalar`].
    #[inline]
    pub(crate) fn run(self, kernel: impl Kernel) -> bool {
        let Some(token) = self.token() else {
            return false;
        };
        launch(token, kernel);
        true
    }

    /// [`Self::run`]; for levels without instructions, the kernel in plain code.
    #[inline]
    pub(crate) fn run_or_plain(self, kernel: impl Kernel) {
        let token = self.token().unwrap_or_else(Level::fallback);
        launch(token, kernel);
    }

    /// The proof that the processor has the instructions.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    fn token(self) -> Option<Level> {
        let best = Level::new();
        match self {
            Self::Scalar | Self::Neon => None,
            Self::Sse42 => best.as_sse4_2().map(Level::Sse4_2),
            Self::Avx2 => best.as_avx2().map(Level::Avx2),
            Self::Avx512 => best.as_avx512().map(Level::Avx512),
        }
    }

    /// The proof that the processor has the instructions.
    #[cfg(target_arch = "aarch64")]
    fn token(self) -> Option<Level> {
        (self == Self::Neon)
            .then(|| Level::new().as_neon().map(Level::Neon))
            .flatten()
    }

    /// Elsewhere there is only the plain kernel.
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64")))]
    fn token(self) -> Option<Level> {
        None
    }
}

/// Whether `max` and `min` of these instructions give the second number where one is NaN or both are zeros, as
/// `if a > b { a } else { b }` does. Those of x86 do; others take a comparison and a choice for that.
#[inline(always)]
fn second_wins<S: Simd>(simd: S) -> bool {
    match simd.level() {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Sse4_2(_) | Level::Avx2(_) | Level::Avx512(_) => true,
        _ => false,
    }
}

/// Whether vectors of these instructions are filled from many places by one of them.
#[inline(always)]
pub(super) fn gathers<S: Simd>(simd: S) -> bool {
    match simd.level() {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Avx2(_) | Level::Avx512(_) => true,
        _ => false,
    }
}

/// The larger of each pair; the second where one is NaN, and of two zeros.
#[inline(always)]
pub(crate) fn larger<S: Simd, V: SimdFloat<S>>(a: V, b: V) -> V {
    if second_wins(a.token()) {
        a.max(b)
    } else {
        a.simd_gt(b).select(a, b)
    }
}

/// The smaller, likewise.
#[inline(always)]
pub(crate) fn smaller<S: Simd, V: SimdFloat<S>>(a: V, b: V) -> V {
    if second_wins(a.token()) {
        a.min(b)
    } else {
        a.simd_lt(b).select(a, b)
    }
}

/// `new` where the mask holds, elsewhere `old`, for what goes back to the place that `old` came from.
///
/// With AVX2 as a choice between bytes: the compiler makes a masked store of one between numbers, which takes AMD's
/// processors twelve times as long as a plain store.
#[inline(always)]
pub(crate) fn merged<S, V>(mask: V::Mask, new: V, old: V) -> V
where
    S: Simd,
    V: SimdBase<S, ByteVector = S::u8s>,
    V::Mask: SimdMask<S> + Select<V>,
    <V::Mask as SimdMask<S>>::Ints: SimdBase<S, ByteVector = S::u8s>,
{
    match new.token().level() {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Avx2(_) => {
            let bytes: S::i8s = mask.to_vector().bitcast();
            let mask = S::mask8s::from_vector(bytes);
            let chosen: S::u8s = mask.select(new.bitcast(), old.bitcast());
            chosen.bitcast()
        }
        _ => mask.select(new, old),
    }
}

/// Compiles a kernel once for every kind of token that a [`SimdLevel`] may hold.
#[inline]
fn launch(token: Level, kernel: impl Kernel) {
    match token {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Sse4_2(simd) => simd.vectorize(
            #[inline(always)]
            || kernel.run(simd),
        ),
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Avx2(simd) => simd.vectorize(
            #[inline(always)]
            || kernel.run(simd),
        ),
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Avx512(simd) => simd.vectorize(
            #[inline(always)]
            || kernel.run(simd),
        ),
        #[cfg(target_arch = "aarch64")]
        Level::Neon(simd) => simd.vectorize(
            #[inline(always)]
            || kernel.run(simd),
        ),
        Level::Fallback(simd) => simd.vectorize(
            #[inline(always)]
            || kernel.run(simd),
        ),
        _ => unreachable!("no level has another token"),
    }
}

impl fmt::Display for SimdLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Code that is compiled once for each level.
///
/// Everything that `run` calls with a [`Simd`] must be `#[inline(always)]` and free of closures over
/// vectors: a function that is left standing alone is compiled without the level's instructions.
pub(crate) trait Kernel {
    /// The work.
    fn run<S: Simd>(self, simd: S);
}
