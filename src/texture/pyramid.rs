//! Smallest and largest heights over squares of a height map: what a walk may skip without looking.

use super::{HeightMap, Wrap};

/// The extremes of a height map over squares of 2^level cells.
///
/// A *cell* (i, j) lies between the centres of texels i…i+1 and j…j+1; over it the bilinear height stays
/// between its corners. Level 0 holds the extremes of single cells, every further level those of up to
/// 2 × 2 nodes below, until one node is left. 16-bit heights take 5.3 bytes a texel, floats 10.7.
///
/// Source: max mipmaps, Tevs et al. 2008; with minima for bounds of displaced triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightPyramid {
    levels: Vec<Level>,
    nodes: Nodes,
}

/// All levels in one piece.
#[derive(Debug, Clone, PartialEq)]
enum Nodes {
    U16(Vec<[u16; 2]>),
    F32(Vec<[f32; 2]>),
}

/// Where the nodes of a level lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level {
    /// Index of its first node.
    pub start: usize,
    /// Nodes in a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
}

/// A map and its pyramid in the numbers that both store.
#[derive(Debug, Clone, Copy)]
pub enum StoredHeights<'a> {
    /// Fractions of 65535: texels and `[smallest, largest]` of the nodes.
    U16(&'a [u16], &'a [[u16; 2]]),
    /// Floats.
    F32(&'a [f32], &'a [[f32; 2]]),
}

impl HeightPyramid {
    /// The pyramid of a map that goes on beyond its border by `wrap`.
    #[must_use]
    pub fn new(map: &HeightMap, wrap: Wrap) -> Self {
        let size = [map.width(), map.height()];
        let levels = levels(size);
        let nodes = match map {
            HeightMap::U16(grid) => {
                let texel = |x, y| grid.at(x, y);
                Nodes::U16(build(&levels, wrap, texel))
            }
            HeightMap::F32(grid) => {
                let texel = |x, y| grid.at(x, y);
                Nodes::F32(build(&levels, wrap, texel))
            }
        };
        Self { levels, nodes }
    }

    /// Texels of `map`, which this is the pyramid of, and nodes; `None` if it is of another map.
    #[must_use]
    pub fn stored<'a>(&'a self, map: &'a HeightMap) -> Option<StoredHeights<'a>> {
        let Level { columns, rows, .. } = self.levels[0];
        if [columns, rows] != [map.width(), map.height()] {
            return None;
        }
        match (map, &self.nodes) {
            (HeightMap::U16(grid), Nodes::U16(nodes)) => {
                Some(StoredHeights::U16(grid.texels(), nodes))
            }
            (HeightMap::F32(grid), Nodes::F32(nodes)) => {
                Some(StoredHeights::F32(grid.texels(), nodes))
            }
            _ => None,
        }
    }

    /// All levels, the finest first.
    #[must_use]
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// The level with a single node.
    #[must_use]
    pub fn top(&self) -> u32 {
        self.levels.len() as u32 - 1
    }

    /// Smallest and largest stored height over the square of level `level` that cell (i, j) of the picture
    /// lies in.
    ///
    /// # Panics
    /// If the cell is outside the picture or the level above [`top`](Self::top).
    #[must_use]
    #[inline]
    pub fn extremes(&self, level: u32, [i, j]: [u32; 2]) -> [f32; 2] {
        let Level { start, columns, .. } = self.levels[level as usize];
        let index = start + (j >> level) as usize * columns as usize + (i >> level) as usize;
        match &self.nodes {
            Nodes::U16(nodes) => nodes[index].map(super::height_map::fraction),
            Nodes::F32(nodes) => nodes[index],
        }
    }

    /// Smallest and largest stored height of the whole map.
    #[must_use]
    pub fn range(&self) -> [f32; 2] {
        self.extremes(self.top(), [0, 0])
    }

    /// Heap bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let nodes = match &self.nodes {
            Nodes::U16(nodes) => size_of_val(nodes.as_slice()),
            Nodes::F32(nodes) => size_of_val(nodes.as_slice()),
        };
        nodes + size_of_val(self.levels.as_slice())
    }
}

fn levels([mut columns, mut rows]: [u32; 2]) -> Vec<Level> {
    let (mut levels, mut start) = (Vec::new(), 0);
    loop {
        levels.push(Level {
            start,
            columns,
            rows,
        });
        if columns == 1 && rows == 1 {
            return levels;
        }
        start += columns as usize * rows as usize;
        (columns, rows) = (columns.div_ceil(2), rows.div_ceil(2));
    }
}

fn build<T: Copy + PartialOrd>(
    levels: &[Level],
    wrap: Wrap,
    texel: impl Fn(u32, u32) -> T,
) -> Vec<[T; 2]> {
    let Level { columns, rows, .. } = levels[0];
    let next = |i: u32, n| wrap.index(i64::from(i) + 1, n);
    let mut nodes = Vec::new();
    for j in 0..rows {
        let below = next(j, rows);
        for i in 0..columns {
            let right = next(i, columns);
            let corners = [(i, j), (right, j), (i, below), (right, below)];
            nodes.push(extremes(corners.map(|(x, y)| [texel(x, y); 2]).into_iter()));
        }
    }
    for pair in levels.windows(2) {
        let (fine, coarse) = (pair[0], pair[1]);
        for j in 0..coarse.rows {
            for i in 0..coarse.columns {
                let children = (2 * j..(2 * j + 2).min(fine.rows)).flat_map(|y| {
                    (2 * i..(2 * i + 2).min(fine.columns))
                        .map(move |x| fine.start + y as usize * fine.columns as usize + x as usize)
                });
                let node = extremes(children.map(|index| nodes[index]));
                nodes.push(node);
            }
        }
    }
    nodes
}

/// The extremes of at least one pair of extremes.
fn extremes<T: Copy + PartialOrd>(mut pairs: impl Iterator<Item = [T; 2]>) -> [T; 2] {
    // Every square has a corner; the maps hold no NaN.
    let [mut low, mut high] = pairs.next().unwrap_or_else(|| unreachable!());
    for [a, b] in pairs {
        low = if a < low { a } else { low };
        high = if b > high { b } else { high };
    }
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::Grid;

    #[test]
    fn every_node_holds_the_extremes_of_its_cells() {
        for (w, h) in [(1, 1), (2, 2), (5, 3), (8, 8), (7, 1)] {
            let value = |x: u32, y: u32| ((x * 7919 + y * 104_729) % 1000) as u16;
            let texels = (0..h).flat_map(|y| (0..w).map(move |x| value(x, y)));
            let map = HeightMap::U16(Grid::new(w, h, texels.collect()));
            for wrap in Wrap::ALL {
                let pyramid = HeightPyramid::new(&map, wrap);
                for level in 0..=pyramid.top() {
                    check_level(&map, wrap, &pyramid, level);
                }
                assert_eq!(
                    pyramid.range(),
                    pyramid.extremes(pyramid.top(), [w - 1, h - 1])
                );
            }
        }
    }

    fn check_level(map: &HeightMap, wrap: Wrap, pyramid: &HeightPyramid, level: u32) {
        let (w, h) = (map.width(), map.height());
        for (i, j) in (0..h).flat_map(|j| (0..w).map(move |i| (i, j))) {
            let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
            let span =
                |k: u32, n| (k >> level << level)..((k >> level << level) + (1 << level)).min(n);
            for (x, y) in span(j, h).flat_map(|y| span(i, w).map(move |x| (x, y))) {
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let column = wrap.index(i64::from(x) + dx, w);
                    let texel = map.texel(column, wrap.index(i64::from(y) + dy, h));
                    (low, high) = (low.min(texel), high.max(texel));
                }
            }
            assert_eq!(
                pyramid.extremes(level, [i, j]),
                [low, high],
                "{wrap:?} {level}"
            );
        }
    }
}
