//! A tree at every level of this machine, and rays that must find the same at each.

use super::Kernel;
use crate::geometry::bvh::{AcceptAll, Bvh};
use crate::geometry::simd::SimdLevel;
use crate::geometry::triangle::Watertight;
use crate::geometry::{Hit, Ray};

/// The levels that this machine has.
pub(super) fn levels() -> Vec<SimdLevel> {
    let all = SimdLevel::ALL.into_iter();
    all.filter(|level| level.is_available()).collect()
}

/// A tree with its twins.
#[derive(Debug)]
pub(super) struct Trees {
    kernel: Kernel,
    alone: Bvh,
    /// One a level; none for kernels that know no bundles.
    twins: Vec<Bvh>,
}

/// What bunches of rays found.
#[derive(Debug, Clone, Default)]
pub(super) struct Traced {
    /// What each found alone.
    pub hits: Vec<Option<Hit>>,
    /// Rays of which some level says something else, in closest hit or in shadow.
    pub disagreeing: u64,
}

impl Trees {
    /// The twins of a tree.
    pub fn new(kernel: Kernel, bvh: &Bvh) -> Self {
        let twin = |level| bvh.clone().with_level(level).ok();
        let twins = match kernel {
            Kernel::Watertight => levels().into_iter().filter_map(twin).collect(),
            _ => Vec::new(),
        };
        Self {
            kernel,
            alone: bvh.clone(),
            twins,
        }
    }

    /// The tree itself.
    pub const fn bvh(&self) -> &Bvh {
        &self.alone
    }

    /// Traces rays alone, and together at each level.
    pub fn trace(&self, rays: &[Ray]) -> Traced {
        let alone = |ray| self.kernel.closest(&self.alone, ray, &AcceptAll);
        let hits: Vec<_> = rays.iter().map(alone).collect();
        let far = vec![f32::INFINITY; rays.len()];
        let mut differs = vec![false; rays.len()];
        for (ray, (hit, differs)) in rays.iter().zip(hits.iter().zip(&mut differs)) {
            *differs |= self
                .kernel
                .occluded(&self.alone, ray, f32::INFINITY, &AcceptAll)
                != hit.is_some();
        }
        for twin in &self.twins {
            let mut found = vec![None; rays.len()];
            let mut occluded = vec![false; rays.len()];
            twin.intersect_many::<Watertight, _>(rays, &far, &AcceptAll, &mut found);
            twin.occluded_many::<Watertight, _>(rays, &far, &AcceptAll, &mut occluded);
            for i in 0..rays.len() {
                differs[i] |= bits(found[i]) != bits(hits[i]) || occluded[i] != hits[i].is_some();
            }
        }
        Traced {
            disagreeing: differs.iter().filter(|differs| **differs).count() as u64,
            hits,
        }
    }

    /// Whether rays that end at `t_max` are stopped: how many are, and of how many a level says something else.
    pub fn shadows(&self, rays: &[Ray], t_max: &[f32]) -> (Vec<bool>, u64) {
        let pairs = rays.iter().zip(t_max);
        let alone =
            pairs.map(|(ray, &t_max)| self.kernel.occluded(&self.alone, ray, t_max, &AcceptAll));
        let alone: Vec<_> = alone.collect();
        let mut differs = vec![false; rays.len()];
        for twin in &self.twins {
            let mut together = vec![false; rays.len()];
            twin.occluded_many::<Watertight, _>(rays, t_max, &AcceptAll, &mut together);
            for i in 0..rays.len() {
                differs[i] |= together[i] != alone[i];
            }
        }
        let disagreeing = differs.iter().filter(|differs| **differs).count() as u64;
        (alone, disagreeing)
    }
}

/// A hit that can be compared to the bit.
fn bits(hit: Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|hit| [hit.t.to_bits(), hit.prim, hit.u.to_bits(), hit.v.to_bits()])
}
