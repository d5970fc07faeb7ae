//! Is the tree right? Walks all of it; for tests and `inspect`.

use super::Bvh;
use super::node::{Child, ChildRef};
use crate::geometry::{Aabb, TriangleMesh};

/// What the walk has seen so far.
struct Walk<'a> {
    mesh: &'a TriangleMesh,
    seen: Vec<bool>,
    blocks: usize,
    nodes: usize,
}

impl Bvh {
    /// Checks that every box holds what is below it, and that every triangle of `mesh` is in exactly one
    /// leaf, with its own corners.
    ///
    /// # Errors
    /// Says what is wrong first.
    pub fn validate(&self, mesh: &TriangleMesh) -> Result<(), String> {
        let mut walk = Walk {
            mesh,
            seen: vec![false; mesh.len()],
            blocks: 0,
            nodes: 0,
        };
        if self.root != ChildRef::EMPTY {
            self.check(&mut walk, self.bounds, self.root.unpack())?;
        }
        if let Some(lost) = walk.seen.iter().position(|seen| !seen) {
            return Err(format!("triangle {lost} is in no leaf"));
        }
        let reached = (walk.nodes, walk.blocks);
        let stored = (self.nodes.len(), self.blocks.len());
        if reached == stored {
            Ok(())
        } else {
            Err(format!(
                "{reached:?} nodes and leaves reached of {stored:?}"
            ))
        }
    }

    fn check(&self, walk: &mut Walk, bounds: Aabb, child: Child) -> Result<(), String> {
        match child {
            Child::Node(index) => {
                let node = self.nodes.get(index).ok_or("a child points nowhere")?;
                walk.nodes += 1;
                for (inner, child) in node.children() {
                    if !contains(bounds, inner) {
                        return Err(format!("node {index}: {inner:?} leaves {bounds:?}"));
                    }
                    self.check(walk, inner, child)?;
                }
                Ok(())
            }
            Child::Block(index) => {
                let block = self.blocks.get(index).ok_or("a child points nowhere")?;
                walk.blocks += 1;
                block
                    .triangles()
                    .try_for_each(|(prim, corners)| walk.check_triangle(bounds, prim, corners))
            }
        }
    }
}

impl Walk<'_> {
    fn check_triangle(
        &mut self,
        bounds: Aabb,
        prim: u32,
        corners: [glam::Vec3; 3],
    ) -> Result<(), String> {
        let seen = self
            .seen
            .get_mut(prim as usize)
            .ok_or_else(|| format!("triangle {prim} does not exist"))?;
        if std::mem::replace(seen, true) {
            return Err(format!("triangle {prim} is there twice"));
        }
        if corners != self.mesh.corners(prim) {
            return Err(format!("triangle {prim} has other corners"));
        }
        if !contains(bounds, Aabb::from_points(corners)) {
            return Err(format!("triangle {prim} leaves its box {bounds:?}"));
        }
        Ok(())
    }
}

fn contains(outer: Aabb, inner: Aabb) -> bool {
    inner.min.cmpge(outer.min).all() && inner.max.cmple(outer.max).all()
}
