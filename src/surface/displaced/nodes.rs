//! Boxes around parts of displaced triangles, kept for the rays that follow.

use crate::math::lanes::Lanes;

/// Parts that a part falls into.
pub const PARTS: usize = 16;

/// A number for each part.
pub type Row = Lanes<f32, PARTS>;

/// Boxes of the parts that a part falls into: `[axis][lower, upper]`.
pub type Boxes = [[Row; 2]; 3];

/// What is known of the sixteen parts that a part falls into.
#[derive(Debug, Clone, Copy)]
pub struct Node {
    /// Their boxes: as wide as the whole part's heights ask for, or their own where `refined` says so.
    pub boxes: Boxes,
    /// Smallest and largest displacement in each; of those that are refined and fall into further parts.
    pub ranges: [Row; 2],
    /// Parts whose boxes are their own, as bits.
    pub refined: u64,
}

/// Which part of which triangle: anchor and signed size in segments.
pub type PartKey = (u32, [i32; 3]);

/// No triangle has as many.
const NO_KEY: PartKey = (u32::MAX, [0; 3]);

/// Entries to begin with.
const FEW: usize = 1 << 8;

/// Nodes that rays came by. Each is what would be worked out again, so that what is forgotten changes no pixel.
#[derive(Debug, Default)]
pub struct NodeCache {
    /// The displacement that it belongs to.
    owner: u64,
    /// Empty until first used, then a power of two.
    entries: Vec<(PartKey, Node)>,
    /// Entries filled since the table grew.
    filled: usize,
}

impl NodeCache {
    /// Forgets what belongs to another displacement, and what takes more than `budget` bytes; a few boxes are always
    /// kept.
    pub fn prepare(&mut self, owner: u64, budget: usize) {
        if self.owner != owner || self.bytes() > budget && self.entries.len() > FEW {
            *self = Self {
                owner,
                ..Self::default()
            };
        }
    }

    /// Heap bytes.
    pub const fn bytes(&self) -> usize {
        self.entries.capacity() * size_of::<(PartKey, Node)>()
    }

    /// Where a part's node is, if it is known.
    #[inline(always)]
    pub fn find(&self, key: PartKey) -> Option<usize> {
        let index = place(key, self.entries.len());
        let (at, _) = self.entries.get(index)?;
        (*at == key).then_some(index)
    }

    /// The node at a place, good until the next is put.
    #[inline(always)]
    pub fn at(&mut self, index: usize) -> &mut Node {
        &mut self.entries[index].1
    }

    /// Keeps a part's node, perhaps in the place of another's, in at most `budget` bytes; returns where.
    #[inline(never)]
    pub fn put(&mut self, key: PartKey, node: &Node, budget: usize) -> usize {
        // Growing is worth its while once about half of the places have been taken.
        if 2 * self.filled >= self.entries.len() {
            let size = (2 * self.entries.len()).max(FEW);
            if size == FEW || size * size_of::<(PartKey, Node)>() <= budget {
                let empty = (NO_KEY, Node::EMPTY);
                let old = std::mem::replace(&mut self.entries, vec![empty; size]);
                self.filled = 0;
                for (key, node) in old {
                    if key != NO_KEY {
                        self.entries[place(key, size)] = (key, node);
                        self.filled += 1;
                    }
                }
            }
        }
        let entry = place(key, self.entries.len());
        self.entries[entry] = (key, *node);
        self.filled += 1;
        entry
    }
}

impl Node {
    const EMPTY: Self = Self {
        boxes: [[Row::splat(0.0); 2]; 3],
        ranges: [Row::splat(0.0); 2],
        refined: 0,
    };
}

/// Where a part is kept among `entries`.
#[inline(always)]
const fn place((prim, [a, b, size]): PartKey, entries: usize) -> usize {
    let mut hash = prim.wrapping_mul(0x9e37_79b1);
    hash = (hash ^ a as u32).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ b as u32).wrapping_mul(0xc2b2_ae35);
    hash = (hash ^ size as u32).wrapping_mul(0x27d4_eb2f);
    (hash ^ hash >> 15) as usize & entries.wrapping_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MUCH: usize = 1 << 24;

    fn node(refined: u64) -> Node {
        Node {
            refined,
            ..Node::EMPTY
        }
    }

    #[test]
    fn nodes_are_kept_until_others_take_their_place_or_the_owner_changes() {
        let mut cache = NodeCache::default();
        cache.prepare(1, MUCH);
        let key = (7, [4, 8, 16]);
        assert_eq!(cache.find(key), None);
        let index = cache.put(key, &node(3), MUCH);
        assert_eq!(cache.find(key), Some(index));
        assert_eq!(cache.at(index).refined, 3);
        assert_eq!(cache.find((7, [4, 8, -16])), None);
        cache.prepare(1, MUCH);
        assert_eq!(cache.find(key), Some(index));
        cache.prepare(2, MUCH);
        assert_eq!(cache.find(key), None);
    }

    #[test]
    fn it_grows_as_far_as_the_budget_allows_and_answers_rightly_beyond() {
        let budget = 1 << 20;
        let mut cache = NodeCache::default();
        cache.prepare(1, budget);
        for round in 0..2 {
            for i in 0..20_000_u32 {
                let key = (i, [0, 0, 16]);
                if let Some(index) = cache.find(key) {
                    assert_eq!(cache.at(index).refined, u64::from(i), "round {round}");
                }
                let index = cache.put(key, &node(u64::from(i)), budget);
                assert_eq!(cache.find(key), Some(index));
            }
        }
        assert!(cache.bytes() <= budget && cache.bytes() > budget / 4);
        cache.prepare(1, budget / 8);
        assert_eq!(cache.bytes(), 0);
    }
}
