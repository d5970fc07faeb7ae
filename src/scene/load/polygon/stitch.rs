//! Gives corners back that ear clipping leaves out.

use std::collections::HashMap;

/// Directed edges of triangles and the triangle each belongs to.
type Edges = HashMap<[u32; 2], usize>;

/// Puts back the corners that lie straight between their neighbours.
///
/// Ear clipping drops a corner once it has no area to contribute. Its neighbours in the mesh still have
/// an edge that ends there, and rays would slip through between two edges that only nearly agree. So a
/// triangle's edge that nothing else shares is cut at the corners of missing edges along it. Works on
/// corner numbers; corners that coincide are different corners.
pub(super) fn restore_left_out(triangles: &mut Vec<[u32; 3]>, flat: &[[f64; 2]]) {
    let corners = flat.len() as u32;
    let mut edges: Edges = HashMap::with_capacity(triangles.len() * 3);
    for (i, triangle) in triangles.iter().enumerate() {
        insert(&mut edges, *triangle, i);
    }
    let outline = |[a, b]: [u32; 2]| b == (a + 1) % corners;
    let mut lonely: Vec<[u32; 2]> = edges
        .keys()
        .copied()
        .filter(|&[a, b]| !outline([a, b]) && !edges.contains_key(&[b, a]))
        .collect();
    // The map's order is random; the result must not be.
    lonely.sort_unstable();
    let mut missing: HashMap<u32, Vec<u32>> = HashMap::new();
    let unused = (0..corners)
        .map(|a| [a, (a + 1) % corners])
        .filter(|edge| !edges.contains_key(edge));
    for [a, b] in unused.chain(lonely.iter().map(|&[a, b]| [b, a])) {
        missing.entry(a).or_default().push(b);
    }
    for edge in lonely {
        let Some(&owner) = edges.get(&edge) else {
            continue;
        };
        if let Some(path) = path_along(edge, &missing, flat) {
            cut(triangles, &mut edges, owner, &path);
        }
    }
}

fn insert(edges: &mut Edges, [a, b, c]: [u32; 3], triangle: usize) {
    for edge in [[a, b], [b, c], [c, a]] {
        edges.insert(edge, triangle);
    }
}

/// Corners from one end of the edge to the other over missing edges that lie on it.
fn path_along(
    [from, to]: [u32; 2],
    missing: &HashMap<u32, Vec<u32>>,
    flat: &[[f64; 2]],
) -> Option<Vec<u32>> {
    let [start, end] = [from, to].map(|i| flat[i as usize]);
    let along = [end[0] - start[0], end[1] - start[1]];
    let length2 = along[0] * along[0] + along[1] * along[1];
    let place = |i: u32| {
        let p = flat[i as usize];
        let offset = [p[0] - start[0], p[1] - start[1]];
        let aside = along[0] * offset[1] - along[1] * offset[0];
        let on_edge = aside.abs() <= 1e-9 * length2;
        on_edge.then(|| (along[0] * offset[0] + along[1] * offset[1]) / length2)
    };
    let mut path = vec![from];
    let (mut at, mut passed) = (from, 0.0);
    while at != to {
        let (next, place) = missing
            .get(&at)?
            .iter()
            .filter(|&&next| [at, next] != [from, to])
            .filter_map(|&next| Some((next, place(next)?)))
            .find(|&(_, place)| place >= passed && place <= 1.0)?;
        path.push(next);
        (at, passed) = (next, place);
        if path.len() > flat.len() {
            return None;
        }
    }
    (path.len() > 2).then_some(path)
}

/// Replaces the triangle that owns the edge between the path's ends by a fan around its third corner.
fn cut(triangles: &mut Vec<[u32; 3]>, edges: &mut Edges, owner: usize, path: &[u32]) {
    let [from, to] = [path[0], path[path.len() - 1]];
    let Some(apex) = triangles[owner].into_iter().find(|&c| c != from && c != to) else {
        return;
    };
    edges.remove(&[from, to]);
    for (i, step) in path.windows(2).enumerate() {
        let triangle = [step[0], step[1], apex];
        let index = if i == 0 { owner } else { triangles.len() };
        if i == 0 {
            triangles[owner] = triangle;
        } else {
            triangles.push(triangle);
        }
        insert(edges, triangle, index);
    }
}
