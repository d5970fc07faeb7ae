//! All micro-triangles of a displaced surface at once, in a tree of their own: they are traced like any mesh.
//!
//! What a ray meets is what it meets where micro-triangles are made on the way, to the bit: the same corners, the same
//! test, the same winner among equals.

use glam::Vec3;
use rayon::prelude::*;

use super::fine::{MicroHit, PartKey, Patch};
use super::parts::{self, PARTS};
use super::{DisplacedMesh, Displacement};
use crate::geometry::Hit;
use crate::geometry::bvh::Bvh;
use crate::geometry::triangle::{Corners8, LANES};
use crate::math::simd::{Kernel, Simd, SimdLevel};

/// Groups of eight micro-triangles in a part with four segments.
const GROUPS: usize = PARTS / LANES;

/// Parts whose micro-triangles are made in one go.
const TOGETHER: usize = 64;

/// The micro-triangles of all pieces that are cut up.
#[derive(Debug)]
pub struct MicroMesh {
    /// Sixteen triangles for each leaf.
    bvh: Bvh,
    /// Parts with four segments, in growing order.
    leaves: Vec<PartKey>,
}

impl MicroMesh {
    /// Heap bytes that it would take, about.
    #[must_use]
    pub fn bytes_for(displacement: &Displacement) -> usize {
        let leaves: usize = displacement
            .cuts()
            .map(|(_, cut)| parts::leaf_count(cut))
            .sum();
        leaves * size_of::<PartKey>() + Bvh::bytes_of_groups(leaves * GROUPS)
    }

    /// Makes all micro-triangles on the current rayon pool, the same for any pool size. `None` once `stop` says so.
    #[must_use]
    pub fn new(
        mesh: DisplacedMesh<'_, '_>,
        level: SimdLevel,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Option<Self> {
        let leaves: Vec<PartKey> = mesh
            .displacement
            .cuts()
            .flat_map(|(piece, cut)| {
                parts::leaves(cut)
                    .into_iter()
                    .map(move |leaf| (piece, leaf))
            })
            .collect();
        let mut groups = vec![[[[0.0; LANES]; 3]; 3]; leaves.len() * GROUPS];
        let parts = leaves.par_chunks(TOGETHER);
        parts
            .zip(groups.par_chunks_mut(TOGETHER * GROUPS))
            .for_each(|(leaves, groups)| {
                if !stop() {
                    level.run_or_plain(Fill {
                        mesh,
                        leaves,
                        groups,
                    });
                }
            });
        let watch = |_| if stop() { Err(()) } else { Ok(()) };
        let reach = mesh.displacement.reach();
        let bvh = Bvh::of_groups(groups.into_par_iter(), reach, &watch).ok()?;
        Some(Self {
            bvh: bvh.with_level(level).ok()?,
            leaves,
        })
    }

    /// The tree of the micro-triangles.
    #[must_use]
    pub const fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// How many micro-triangles there are; some may have no area.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.leaves.len() * PARTS
    }

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.leaves.is_empty()
    }

    /// Corners of a micro-triangle.
    ///
    /// # Panics
    /// If `index` is not below [`Self::len`].
    #[must_use]
    pub fn corners(&self, index: u32) -> [Vec3; 3] {
        self.bvh.group_corners(index)
    }

    /// Heap bytes.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        self.bvh.bytes() + size_of_val(self.leaves.as_slice())
    }

    /// The micro-triangle of a hit in the tree.
    #[inline]
    pub(super) fn micro(&self, hit: &Hit) -> MicroHit {
        MicroHit {
            leaf: self.leaves[hit.prim as usize / PARTS],
            part: (hit.prim as usize % PARTS) as u8,
            corners: self.bvh.group_corners(hit.prim),
            weights: [hit.u, hit.v],
        }
    }
}

/// Makes the micro-triangles of a few parts.
struct Fill<'a, 'm> {
    mesh: DisplacedMesh<'a, 'm>,
    leaves: &'a [PartKey],
    groups: &'a mut [Corners8],
}

impl Kernel for Fill<'_, '_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let DisplacedMesh {
            mesh,
            reliefs,
            displacement,
            ..
        } = self.mesh;
        let door = (&reliefs, displacement);
        let mut last = None;
        for (&(piece, leaf), groups) in self.leaves.iter().zip(self.groups.chunks_mut(GROUPS)) {
            if last.is_none_or(|(known, _)| known != piece) {
                last = Patch::new(mesh, door, piece).map(|patch| (piece, patch));
            }
            if let Some((_, patch)) = &last {
                groups.copy_from_slice(&patch.leaf_corners(simd, &reliefs, leaf));
            }
        }
    }
}
