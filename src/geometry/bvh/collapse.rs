//! From a binary tree to nodes with up to eight children.

use super::build::{Content, Tree};
use super::node::{ChildRef, Node};
use crate::geometry::triangle::LANES;

/// Nodes of a collapsed tree, children in depth-first order, and its root. `block_of` says where the block of a leaf
/// is, leaves counted from left to right. Without a tree there is no root.
pub(super) fn collapse(
    tree: Option<&Tree>,
    leaves: usize,
    block_of: &dyn Fn(usize) -> usize,
) -> (Vec<Node>, ChildRef) {
    let mut wide = Wide {
        // Grids have 0.29 nodes a leaf, scans and buildings up to 0.4.
        nodes: Vec::with_capacity(leaves / 2),
        leaves: 0,
        block_of,
    };
    let root = tree.map_or(ChildRef::EMPTY, |tree| wide.add(tree));
    wide.nodes.shrink_to_fit();
    (wide.nodes, root)
}

struct Wide<'a> {
    nodes: Vec<Node>,
    /// Leaves met so far.
    leaves: usize,
    block_of: &'a dyn Fn(usize) -> usize,
}

impl Wide<'_> {
    fn add(&mut self, tree: &Tree) -> ChildRef {
        match &tree.content {
            Content::Leaf(_) => {
                self.leaves += 1;
                ChildRef::block((self.block_of)(self.leaves - 1))
            }
            Content::Inner(halves) => {
                let index = self.nodes.len();
                self.nodes.push(Node::empty());
                for (lane, child) in widen(halves).into_iter().flatten().enumerate() {
                    let child_ref = self.add(child);
                    self.nodes[index].set(lane, child.bounds, child_ref);
                }
                ChildRef::node(index)
            }
        }
    }
}

/// Opens the inner child with the largest surface until there are eight children or only leaves. They
/// come from left to right.
///
/// The largest box is the one most rays would enter next anyway.
fn widen(halves: &[Tree; 2]) -> [Option<&Tree>; LANES] {
    let mut children = [None; LANES];
    children[0] = Some(&halves[0]);
    children[1] = Some(&halves[1]);
    for count in 2..LANES {
        let mut largest: Option<(usize, f32, &[Tree; 2])> = None;
        for (lane, child) in children.iter().flatten().enumerate() {
            let area = child.bounds.half_area();
            if let Content::Inner(halves) = &child.content
                && largest.is_none_or(|(_, most, _)| area > most)
            {
                largest = Some((lane, area, halves));
            }
        }
        let Some((lane, _, halves)) = largest else {
            break;
        };
        children[lane] = Some(&halves[0]);
        children[lane + 1..=count].rotate_right(1);
        children[lane + 1] = Some(&halves[1]);
    }
    children
}
