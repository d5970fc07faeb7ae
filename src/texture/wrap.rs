//! What lies beyond the edge of a picture.

use serde::{Deserialize, Serialize};

/// How texel addresses outside the picture are brought back in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Wrap {
    /// The picture repeats.
    #[default]
    Repeat,
    /// The border texel goes on for ever.
    Clamp,
    /// Every other copy is mirrored.
    Mirror,
}

impl Wrap {
    /// Every rule, for menus and tests.
    pub const ALL: [Self; 3] = [Self::Repeat, Self::Clamp, Self::Mirror];

    /// Name in scene files and menus.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Repeat => "repeat",
            Self::Clamp => "clamp",
            Self::Mirror => "mirror",
        }
    }

    /// Texel index `i` of a line of `n` texels (`n > 0`) brought into `0..n`.
    #[must_use]
    pub fn index(self, i: i64, n: u32) -> u32 {
        let n = i64::from(n);
        let wrapped = match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Clamp => i.clamp(0, n - 1),
            Self::Mirror => {
                let j = i.rem_euclid(2 * n);
                if j < n { j } else { 2 * n - 1 - j }
            }
        };
        wrapped as u32
    }
}
