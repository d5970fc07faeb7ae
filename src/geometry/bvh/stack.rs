//! Nodes still to be visited.

use super::node::ChildRef;

/// A child to visit and the distance at which the ray enters its box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) near: f32,
    pub(super) child: ChildRef,
}

/// Entries that fit without an allocation; trees of 10⁶ triangles need about 30.
const INLINE: usize = 64;

/// A stack that lives in registers and cache while it is small and on the heap beyond: it cannot overflow.
pub(super) struct Stack {
    entries: [Entry; INLINE],
    len: usize,
    /// What came after the inline entries were full.
    spilled: Vec<Entry>,
}

impl Stack {
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self {
            entries: [Entry {
                near: 0.0,
                child: ChildRef::EMPTY,
            }; INLINE],
            len: 0,
            spilled: Vec::new(),
        }
    }

    /// Empties it.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.len = 0;
        self.spilled.clear();
    }

    #[inline(always)]
    pub(super) fn push(&mut self, entry: Entry) {
        if let Some(slot) = self.entries.get_mut(self.len) {
            *slot = entry;
            self.len += 1;
        } else {
            self.spill(entry);
        }
    }

    /// Position of the next entry, for [`Self::insert_sorted`].
    #[inline(always)]
    pub(super) const fn len(&self) -> usize {
        self.len
    }

    /// Pushes so that the entries from position `first` on stay sorted, the nearest on top.
    ///
    /// Spilled entries are not sorted; that costs time, never an answer.
    #[inline(always)]
    pub(super) fn insert_sorted(&mut self, first: usize, entry: Entry) {
        let mut at = self.len;
        self.push(entry);
        while at > first
            && let Some([below, above]) = self.entries.get_mut(at - 1..=at)
            && below.near < above.near
        {
            std::mem::swap(below, above);
            at -= 1;
        }
    }

    #[cold]
    fn spill(&mut self, entry: Entry) {
        self.spilled.push(entry);
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Entry> {
        if self.len == INLINE
            && let Some(entry) = self.spilled.pop()
        {
            return Some(entry);
        }
        self.len = self.len.checked_sub(1)?;
        self.entries.get(self.len).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pops_in_reverse_far_beyond_the_inline_entries() {
        let mut stack = Stack::new();
        for i in 0..1000 {
            stack.push(Entry {
                near: i as f32,
                child: ChildRef::node(i),
            });
        }
        for i in (0..1000).rev() {
            assert_eq!(stack.pop().map(|e| e.child), Some(ChildRef::node(i)));
        }
        assert!(stack.pop().is_none());
    }
}
