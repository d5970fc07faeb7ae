//! What is measured, in which order, and which part of it a shard takes.

use serde::{Deserialize, Serialize};

use super::Variant;
use super::pictures::Samples;
use crate::surface::mapping::Method;

/// A part of a plan: views `index − 1`, `index − 1 + count`, … of all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// From 1 to `count`.
    pub index: u32,
    /// Parts in all, at least 1.
    pub count: u32,
}

/// Everything that decides the errors of a sweep, but for the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Angles between the view and the surface's normal in the middle of the picture, degrees, 0…89.
    pub angles_deg: Vec<f64>,
    /// Factors on every material's amplitude, above 0.
    pub amplitudes: Vec<f64>,
    /// Methods, in order.
    pub methods: Vec<Method>,
    /// The short ladders of parameters instead of the long ones.
    pub quick: bool,
    /// Whether height maps of more bits are also measured cut down to 8.
    pub eight_bits: bool,
    /// View rays for each view.
    pub rays: u32,
    /// Columns and rows of the pictures that are compared.
    pub size: [u32; 2],
    /// Samples per pixel of every method's picture, at least 2, odd numbers rounded down. The reference's takes twice
    /// as many.
    pub samples: u32,
    /// Where these do not tell a picture's errors, it and the reference's take twice as many again and again, up to so
    /// many.
    pub most_samples: u32,
    /// Columns and rows of the frames that are timed.
    pub timed_size: [u32; 2],
    /// Frames that are timed of each cell, after one that warms up.
    pub rounds: u32,
    /// Decides where the view rays lie.
    pub seed: u32,
}

/// One view of a plan: all variants are measured in it together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Its number in the plan.
    pub index: usize,
    /// See [`Plan::angles_deg`].
    pub angle_deg: f64,
    /// See [`Plan::amplitudes`].
    pub amplitude: f64,
}

impl Plan {
    /// The plan of a whole afternoon's questions.
    #[must_use]
    pub fn full() -> Self {
        Self {
            angles_deg: vec![0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 80.0, 85.0, 89.0],
            amplitudes: vec![0.5, 1.0, 2.0],
            methods: Method::ALL.to_vec(),
            quick: false,
            eight_bits: true,
            rays: 4000,
            size: [320, 180],
            samples: 64,
            most_samples: 1024,
            timed_size: [640, 360],
            rounds: 7,
            seed: 1,
        }
    }

    /// The plan of a few minutes.
    #[must_use]
    pub fn quick() -> Self {
        Self {
            angles_deg: vec![0.0, 30.0, 45.0, 60.0, 75.0, 80.0],
            amplitudes: vec![1.0],
            quick: true,
            eight_bits: false,
            rays: 2000,
            size: [256, 144],
            samples: 16,
            most_samples: 64,
            timed_size: [320, 180],
            rounds: 5,
            ..Self::full()
        }
    }

    /// How many samples pictures take.
    pub(super) fn picture_samples(&self) -> Samples {
        Samples {
            half: (self.samples / 2).max(1),
            most: self.most_samples,
        }
    }

    /// Every view, in order.
    #[must_use]
    pub fn views(&self) -> Vec<View> {
        let pairs = self
            .amplitudes
            .iter()
            .flat_map(|&a| self.angles_deg.iter().map(move |&t| (a, t)));
        pairs
            .enumerate()
            .map(|(index, (amplitude, angle_deg))| View {
                index,
                angle_deg,
                amplitude,
            })
            .collect()
    }

    /// The views of a shard.
    #[must_use]
    pub fn views_of(&self, shard: Option<Shard>) -> Vec<View> {
        let mut views = self.views();
        if let Some(Shard { index, count }) = shard {
            views.retain(|view| view.index % count.max(1) as usize + 1 == index as usize);
        }
        views
    }

    /// Every variant, in order.
    #[must_use]
    pub fn variants(&self) -> Vec<Variant> {
        let methods = self.methods.iter();
        methods.flat_map(|&m| Variant::of(m, self.quick)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_the_views_out() {
        let plan = Plan::full();
        for count in [1, 2, 5, 40] {
            let mut seen: Vec<usize> = (1..=count)
                .flat_map(|index| plan.views_of(Some(Shard { index, count })))
                .map(|view| view.index)
                .collect();
            seen.sort_unstable();
            assert_eq!(seen, (0..plan.views().len()).collect::<Vec<_>>(), "{count}");
        }
    }
}
