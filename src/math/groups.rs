//! Which of many things hang together: union-find.

/// Numbers from 0 on, in groups that grow together. Kept from use to use, so that the steady state allocates nothing.
#[derive(Debug, Clone, Default)]
pub struct Groups {
    /// A lower number of the same group, or the number itself where it is the lowest.
    parents: Vec<u32>,
}

impl Groups {
    /// `count` groups of one.
    #[must_use]
    pub fn new(count: usize) -> Self {
        let mut groups = Self::default();
        groups.restart(count);
        groups
    }

    /// Forgets all: `count` groups of one.
    pub fn restart(&mut self, count: usize) {
        self.parents.clear();
        self.parents.extend(0..count as u32);
    }

    /// The lowest number of the group that `i` is in, whatever the order in which groups were joined.
    ///
    /// # Panics
    /// If there is no such number.
    pub fn root(&mut self, mut i: u32) -> u32 {
        while self.parents[i as usize] != i {
            // Halving the path keeps it short.
            let above = self.parents[self.parents[i as usize] as usize];
            self.parents[i as usize] = above;
            i = above;
        }
        i
    }

    /// Makes one group of two.
    ///
    /// # Panics
    /// If there are no such numbers.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::Groups;

    #[test]
    fn joined_numbers_share_the_lowest_of_their_group() {
        let mut groups = Groups::new(6);
        groups.join(4, 2);
        groups.join(5, 4);
        groups.join(0, 3);
        let roots: Vec<_> = (0..6).map(|i| groups.root(i)).collect();
        assert_eq!(roots, [0, 1, 2, 0, 2, 2]);
    }
}
