//! From a binary tree to nodes with up to eight children.

use super::build::{Content, PrimRef, Tree};
use super::node::{Block, ChildRef, Node};
use crate::geometry::TriangleMesh;
use crate::geometry::triangle::LANES;

/// A collapsed tree.
pub(super) struct Wide {
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Vec<Block>,
    pub(super) root: ChildRef,
}

/// Collapses a binary tree, children in depth-first order. Without a tree there is no root.
pub(super) fn collapse(mesh: &TriangleMesh, prims: &[PrimRef], tree: Option<&Tree>) -> Wide {
    let mut wide = Wide {
        nodes: Vec::with_capacity(mesh.len() / 32),
        blocks: Vec::with_capacity(mesh.len() / (LANES / 2) + 1),
        root: ChildRef::EMPTY,
    };
    if let Some(tree) = tree {
        wide.root = wide.add(mesh, prims, tree);
    }
    wide.nodes.shrink_to_fit();
    wide.blocks.shrink_to_fit();
    wide
}

impl Wide {
    fn add(&mut self, mesh: &TriangleMesh, prims: &[PrimRef], tree: &Tree) -> ChildRef {
        match &tree.content {
            Content::Leaf(range) => {
                let prims = prims[range.clone()].iter().map(|p| p.prim);
                self.blocks.push(Block::new(mesh, prims));
                ChildRef::block(self.blocks.len() - 1)
            }
            Content::Inner(halves) => {
                let index = self.nodes.len();
                self.nodes.push(Node::empty());
                for (lane, child) in widen(halves).into_iter().flatten().enumerate() {
                    let child_ref = self.add(mesh, prims, child);
                    self.nodes[index].set(lane, child.bounds, child_ref);
                }
                ChildRef::node(index)
            }
        }
    }
}

/// Opens the inner child with the largest surface until there are eight children or only leaves.
///
/// The largest box is the one most rays would enter next anyway.
fn widen(halves: &[Tree; 2]) -> [Option<&Tree>; LANES] {
    let mut children = [None; LANES];
    children[0] = Some(&halves[0]);
    children[1] = Some(&halves[1]);
    for free in 2..LANES {
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
        children[free] = Some(&halves[1]);
    }
    children
}
