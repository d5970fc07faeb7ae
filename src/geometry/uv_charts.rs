//! Charts: what hangs together on a texture.

use std::collections::HashMap;
use std::sync::OnceLock;

use glam::{DVec2, Vec2, Vec3};

use super::TriangleMesh;
use super::uv_outline::UvOutline;
use crate::math::{Groups, V2};

/// A chart: where on the texture its triangles lie.
#[derive(Debug)]
pub struct UvChart {
    /// The rectangle around it.
    pub around: UvBox,
    /// Its shape, if it is not that rectangle.
    outline: Option<UvOutline>,
}

impl UvChart {
    /// Whether a texture coordinate is in it, its border included. NaN is not.
    #[must_use]
    pub fn contains(&self, uv: V2) -> bool {
        let is_inside =
            |outline: &UvOutline| outline.contains(DVec2::new(f64::from(uv.x), f64::from(uv.y)));
        self.around.contains(uv) && self.outline.as_ref().is_none_or(is_inside)
    }

    /// How far a ray that starts inside at `uv` and changes by `rate` stays in it; infinite if it does not move. Beyond
    /// `most` nobody wants to know: then this may be anything beyond.
    #[must_use]
    pub fn exit(&self, uv: [f32; 2], rate: [f32; 2], most: f64) -> f64 {
        let end = self.around.exit(uv, rate);
        let Some(outline) = &self.outline else {
            return end;
        };
        let [from, way] = [uv, rate].map(|v| DVec2::from_array(v.map(f64::from)));
        let asked = end.min(most);
        let left = outline.exit(from, way, asked);
        if left < asked { left } else { end }
    }
}

/// The charts of a mesh. Triangles with a common corner, the same place with the same texture coordinate, are of
/// one chart.
#[derive(Debug)]
pub struct UvCharts {
    /// The chart of each triangle.
    of: Vec<u32>,
    charts: Vec<UvChart>,
}

/// A rectangle of texture coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UvBox {
    /// Smallest u and v.
    pub low: Vec2,
    /// Largest.
    pub high: Vec2,
}

impl UvBox {
    const EMPTY: Self = Self {
        low: Vec2::INFINITY,
        high: Vec2::NEG_INFINITY,
    };

    /// Whether a texture coordinate is in it, its border included. NaN is not.
    #[must_use]
    pub fn contains(&self, uv: V2) -> bool {
        let Self { low, high } = self;
        (low.x..=high.x).contains(&uv.x) && (low.y..=high.y).contains(&uv.y)
    }

    /// How far a ray that starts inside at `uv` and changes by `rate` stays in it; infinite if it does not move.
    #[must_use]
    pub fn exit(&self, uv: [f32; 2], rate: [f32; 2]) -> f64 {
        let (low, high) = (self.low.to_array(), self.high.to_array());
        let mut end = f64::INFINITY;
        for k in 0..2 {
            let border = if rate[k] > 0.0 { high[k] } else { low[k] };
            if rate[k] != 0.0 {
                let way = (f64::from(border) - f64::from(uv[k])) / f64::from(rate[k]);
                end = end.min(way.max(0.0));
            }
        }
        end
    }
}

impl UvCharts {
    /// Finds the charts of a mesh.
    #[must_use]
    pub fn new(mesh: &TriangleMesh) -> Self {
        let corners = corners(mesh);
        let mut groups = Groups::new(mesh.positions.len());
        for triangle in &mesh.indices {
            let [a, b, c] = triangle.map(|vertex| corners[vertex as usize]);
            groups.join(a, b);
            groups.join(a, c);
        }
        let mut numbers = HashMap::new();
        let mut charts: Vec<Vec<([u32; 3], [Vec2; 3])>> = Vec::new();
        let mut of = Vec::with_capacity(mesh.len());
        for triangle in &mesh.indices {
            let chart = *numbers
                .entry(groups.root(corners[triangle[0] as usize]))
                .or_insert_with(|| {
                    charts.push(Vec::new());
                    charts.len() - 1
                });
            let uv = triangle.map(|vertex| mesh.uvs[vertex as usize]);
            charts[chart].push((triangle.map(|vertex| corners[vertex as usize]), uv));
            of.push(chart as u32);
        }
        let charts = charts.iter().map(|triangles| {
            let uvs = triangles.iter().flat_map(|(_, uv)| uv);
            let around = uvs.fold(UvBox::EMPTY, |UvBox { low, high }, uv| UvBox {
                low: low.min(*uv),
                high: high.max(*uv),
            });
            UvChart {
                outline: UvOutline::new(&around, triangles),
                around,
            }
        });
        Self {
            charts: charts.collect(),
            of,
        }
    }

    /// The chart of a triangle.
    #[must_use]
    pub fn chart(&self, prim: u32) -> &UvChart {
        &self.charts[self.of[prim as usize] as usize]
    }

    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.charts.len()
    }

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.charts.is_empty()
    }

    fn bytes(&self) -> usize {
        let outlines = self.charts.iter().filter_map(|c| c.outline.as_ref());
        size_of_val(self.of.as_slice())
            + size_of_val(self.charts.as_slice())
            + outlines.map(UvOutline::bytes).sum::<usize>()
    }
}

/// For each vertex the first one in the same place with the same texture coordinate.
fn corners(mesh: &TriangleMesh) -> Vec<u32> {
    let mut known = HashMap::with_capacity(mesh.positions.len());
    let bits = |p: Vec3, uv: Vec2| {
        // −0 is the same as 0.
        let (p, uv) = (p + Vec3::ZERO, uv + Vec2::ZERO);
        [p.x, p.y, p.z, uv.x, uv.y].map(f32::to_bits)
    };
    let vertices = mesh.positions.iter().zip(&mesh.uvs).zip(0..);
    vertices
        .map(|((p, uv), vertex)| *known.entry(bits(*p, *uv)).or_insert(vertex))
        .collect()
}

/// Charts of a mesh that are found once somebody asks.
#[derive(Debug, Default)]
pub struct UvChartCell(OnceLock<UvCharts>);

impl UvChartCell {
    /// Those of the mesh that the cell belongs to.
    pub fn get(&self, mesh: &TriangleMesh) -> &UvCharts {
        self.0.get_or_init(|| UvCharts::new(mesh))
    }

    /// Heap bytes, 0 as long as nobody asked.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.0.get().map_or(0, UvCharts::bytes)
    }
}

impl Clone for UvChartCell {
    fn clone(&self) -> Self {
        Self::default()
    }
}
