//! Displacements in parts of triangles, kept for the rays that follow.

/// Parts in an entry.
const PARTS: usize = 16;

/// Entries: 4.5 MiB for each worker, whatever the scene.
const ENTRIES: usize = 1 << 15;

/// Which part of which triangle.
pub type PartKey = (u32, [i32; 3]);

/// The ranges of the sixteen parts that a part falls into; NaN where not asked for yet.
pub type Ranges = [[f32; 2]; PARTS];

/// What is known of parts that rays came by. Every answer is what would be worked out again, so that what is
/// forgotten changes no pixel.
#[derive(Debug, Default)]
pub struct RangeCache {
    /// The displacement that it belongs to.
    owner: u64,
    /// Empty until first used.
    entries: Vec<(PartKey, Ranges)>,
}

/// No triangle has as many.
const NO_KEY: PartKey = (u32::MAX, [0; 3]);

impl RangeCache {
    /// Forgets what belongs to another displacement.
    pub fn belong_to(&mut self, owner: u64) {
        if self.owner != owner {
            self.owner = owner;
            self.entries.clear();
        }
    }

    /// The entry of a part: what is known of it, or nothing.
    #[inline]
    pub fn entry(&mut self, key: PartKey) -> &mut Ranges {
        if self.entries.is_empty() {
            self.entries
                .resize(ENTRIES, (NO_KEY, [[f32::NAN; 2]; PARTS]));
        }
        let (prim, [a, b, size]) = key;
        let mut hash = prim.wrapping_mul(0x9e37_79b1);
        for part in [a, b, size] {
            hash = (hash ^ part as u32).wrapping_mul(0x85eb_ca6b);
        }
        let (known, ranges) = &mut self.entries[(hash >> 17) as usize % ENTRIES];
        if *known != key {
            *known = key;
            *ranges = [[f32::NAN; 2]; PARTS];
        }
        ranges
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_is_kept_until_another_takes_its_place_or_the_owner_changes() {
        let mut cache = RangeCache::default();
        cache.belong_to(1);
        let key = (7, [4, 8, 16]);
        cache.entry(key)[3] = [1.0, 2.0];
        assert_eq!(cache.entry(key)[3], [1.0, 2.0]);
        assert!(cache.entry((7, [4, 8, -16]))[3][0].is_nan());
        cache.belong_to(2);
        assert!(cache.entry(key)[3][0].is_nan());
    }
}
