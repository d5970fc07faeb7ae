//! Joins corners that agree in position, texture coordinate and normal.

/// Slots near a position's number that are tried before hashing.
///
/// Files list neighbours together, so these are in the cache; a hash would be anywhere. Few, because one
/// position with thousands of texture coordinates must not become a walk.
const NEAR: usize = 8;

/// Open-addressing table of vertex keys. Large models ask it for every corner, which a general hash map
/// answers several times slower.
pub(super) struct VertexTable {
    /// Vertex number plus 1, or 0; the length is a power of two and more than twice that of `keys`.
    slots: Vec<u32>,
    keys: Vec<[u32; 3]>,
}

impl VertexTable {
    /// Room for some vertices before it has to grow.
    pub fn with_capacity(vertices: usize) -> Self {
        Self {
            slots: vec![0; (2 * vertices + 16).next_power_of_two()],
            keys: Vec::with_capacity(vertices),
        }
    }

    /// Number of the vertex with this key, new or known.
    pub fn index_of(&mut self, key: [u32; 3]) -> u32 {
        if 2 * self.keys.len() >= self.slots.len() {
            self.grow();
        }
        let slot = self.find(&key);
        match self.slots[slot] {
            0 => {
                self.keys.push(key);
                self.slots[slot] = self.keys.len() as u32;
                self.slots[slot] - 1
            }
            known => known - 1,
        }
    }

    /// Keys by vertex number.
    pub fn into_keys(self) -> Vec<[u32; 3]> {
        self.keys
    }

    /// The slot that holds the key, or the empty one where it belongs.
    fn find(&self, key: &[u32; 3]) -> usize {
        let mask = self.slots.len() - 1;
        let is_it = |slot: usize| match self.slots[slot] {
            0 => true,
            known => self.keys[known as usize - 1] == *key,
        };
        let near = 2 * key[0] as usize;
        if let Some(slot) = (near..near + NEAR).map(|s| s & mask).find(|&s| is_it(s)) {
            return slot;
        }
        let mut slot = hash(key) as usize & mask;
        while !is_it(slot) {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn grow(&mut self) {
        self.slots = vec![0; self.slots.len() * 2];
        for i in 0..self.keys.len() {
            let slot = self.find(&self.keys[i]);
            self.slots[slot] = i as u32 + 1;
        }
    }
}

/// Two rounds of the multiply and shift of splitmix64 (Steele et al. 2014).
fn hash(&[v, vt, vn]: &[u32; 3]) -> u64 {
    let mix = |x: u64| {
        let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x ^ (x >> 29)
    };
    mix(mix(u64::from(v) << 32 | u64::from(vt)).wrapping_add(u64::from(vn)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keys_in_order_and_finds_them_again() {
        let mut table = VertexTable::with_capacity(0);
        let key = |i: u32| [i / 7, i % 7, i.wrapping_mul(31) % 3];
        for round in 0..2 {
            for i in 0..2_000 {
                assert_eq!(table.index_of(key(i)), i, "round {round}");
            }
        }
        assert_eq!(table.into_keys().len(), 2_000);
    }
}
