//! No ray leaves a closed body that is truly displaced: rays from inside, aimed at corners and edges of its
//! micro-triangles, many of which lie on edges and corners of the mesh under them.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::board::grey16;
use super::placement::Placement;
use super::trees::levels;
use super::watertight::{BUNCH, point_on_edges, towards};
use super::{Finding, Plan, Random, Test, bodies};
use crate::geometry::Ray;
use crate::math::simd::SimdLevel;
use crate::scene::built_in::meshes::{Vertex, WorldMesh};
use crate::surface::displaced::{
    DisplacedMesh, Displacement, MicroMesh, Reliefs, Search, SurfaceHit, Tracer,
};
use crate::surface::mapping::BoundHeight;
use crate::surface::mapping::relief::ReliefField;
use crate::texture::{Addressing, Channel, HeightMap, HeightPyramid, Wrap};

/// Texels a side of the bricks.
const TEXELS: u32 = 32;
/// From stored 0 to stored 1, radii.
const AMPLITUDE: f64 = 0.06;
/// Of so many bunches one is traced in every way, the others in two.
const THOROUGH: usize = 8;

/// A closed mesh with charts, of radius about 1.
#[derive(Clone, Copy)]
struct Shape {
    name: &'static str,
    mesh: fn() -> WorldMesh,
    /// A point well inside.
    inside: fn(&mut Random) -> DVec3,
}

const SHAPES: [Shape; 3] = [
    Shape {
        name: "displaced sphere",
        mesh: sphere,
        inside: |random| random.cube() * 0.4,
    },
    Shape {
        name: "displaced torus",
        mesh: torus,
        inside: |random| {
            let (sin, cos) = (random.unit() * TAU).sin_cos();
            DVec3::new(cos, sin, 0.0) + random.cube() * 0.1
        },
    },
    Shape {
        name: "displaced cube with hard edges",
        mesh: cube,
        inside: |random| random.cube() * 0.5,
    },
];

/// A line for each shape and placement.
pub(super) fn tests(_plan: &Plan) -> Vec<Test> {
    let mut all = Vec::new();
    for shape in SHAPES {
        for placement in Placement::extremes() {
            let name = format!("{}, {}", shape.name, placement.name());
            all.push(Test::new("watertight", name.clone(), move |plan| {
                leaks(plan, &name, shape, placement)
            }));
        }
    }
    all
}

/// How many rays get out, or are seen differently in some way.
fn leaks(plan: &Plan, name: &str, shape: Shape, placement: Placement) -> Finding {
    let scene = placement.place((shape.mesh)(), shape.name);
    let map = bricks();
    let pyramid = HeightPyramid::new(&map, Wrap::Repeat);
    let amplitude = (AMPLITUDE * placement.scale * scene.normalization.scale) as f32;
    let addressing = Addressing {
        scale: Vec2::ONE,
        offset: Vec2::ZERO,
        wrap: Wrap::Repeat,
    };
    let height = BoundHeight::new(&map, addressing, amplitude, -0.5 * amplitude);
    let reliefs = Reliefs {
        fields: &[ReliefField::new(height, &pyramid)],
        weld_seams: true,
    };
    let displacement = Displacement::new(&scene.mesh, &reliefs);
    let made_on_the_way = DisplacedMesh {
        mesh: &scene.mesh,
        reliefs,
        displacement: &displacement,
        micro: None,
    };
    let best = SimdLevel::best();
    let Some(micro) = MicroMesh::new(made_on_the_way, best, &|| false) else {
        return Finding::none_of(0, "leaks", 0).with_note("no micro-triangles".to_owned());
    };
    let made_before = DisplacedMesh {
        micro: Some(&micro),
        ..made_on_the_way
    };
    let mut ways = vec![(made_before, best), (made_on_the_way, best)];
    let others = levels().into_iter().filter(|&level| level != best);
    ways.extend(others.map(|level| (made_on_the_way, level)));

    let mut random = plan.random(name);
    let mut tracer = Tracer::default();
    let bunches = plan.effort.pick(2, 24, 6_600);
    let (mut leaks, mut disagreeing) = (0, 0);
    for bunch in 0..bunches {
        let from =
            |random: &mut Random| placement.internal(&scene.normalization, (shape.inside)(random));
        let together = (bunch % 2 == 0).then(|| from(&mut random));
        let mut aimed = || {
            let origin = together.unwrap_or_else(|| from(&mut random));
            let prim = random.below(micro.len()) as u32;
            towards(origin, point_on_edges(micro.corners(prim), &mut random))
        };
        let rays: Vec<Ray> = (0..BUNCH).map(|_| aimed()).collect();
        let ways = if bunch % THOROUGH == 0 {
            &ways[..]
        } else {
            &ways[..2]
        };
        let mut first: Option<Vec<_>> = None;
        let mut differs = [false; BUNCH];
        for &(mesh, level) in ways {
            let (found, stopped) = trace(&mut tracer, (mesh, level), &rays);
            let truth = first.get_or_insert_with(|| {
                leaks += found.iter().filter(|hit| hit.is_none()).count() as u64;
                found.clone()
            });
            for (i, differs) in differs.iter_mut().enumerate() {
                *differs |= bits(found[i]) != bits(truth[i]) || stopped[i] != truth[i].is_some();
            }
        }
        disagreeing += differs.iter().filter(|differs| **differs).count() as u64;
    }
    let note = format!(
        "{} micro-triangles, {} ways; {disagreeing} rays differ",
        micro.len(),
        ways.len()
    );
    let cases = (bunches * BUNCH) as u64;
    Finding::none_of(cases, "leaks", leaks + disagreeing).with_note(note)
}

/// The nearest points on rays, and whether anything at all is in their way.
fn trace(
    tracer: &mut Tracer,
    (mesh, level): (DisplacedMesh<'_, '_>, SimdLevel),
    rays: &[Ray],
) -> (Vec<Option<SurfaceHit>>, Vec<bool>) {
    let run = |tracer: &mut Tracer, search| {
        tracer.clear();
        for ray in rays {
            tracer.push(*ray, f32::INFINITY);
        }
        tracer.run(mesh, search, level);
    };
    run(tracer, Search::Any);
    let stopped = (0..rays.len()).map(|i| tracer.is_hit(i)).collect();
    run(tracer, Search::Closest);
    let found = (0..rays.len()).map(|i| tracer.hit(mesh, i)).collect();
    (found, stopped)
}

/// A hit that can be compared to the bit.
fn bits(hit: Option<SurfaceHit>) -> Option<([u32; 4], [Vec3; 2])> {
    hit.map(|hit| {
        let [u, v] = hit.weights.map(f32::to_bits);
        ([hit.t.to_bits(), hit.prim, u, v], [hit.p, hit.normal])
    })
}

/// Two rows of bricks with joints, rough on top.
fn bricks() -> HeightMap {
    let half = TEXELS / 2;
    let raw = grey16(TEXELS, TEXELS, |x, y| {
        let shifted = if y < half { x } else { x + half / 2 };
        let to_joint = |i: u32, n: u32| f64::from((i % n).min(n - 1 - i % n));
        let depth = to_joint(shifted, half).min(to_joint(y, half)) / 3.0;
        let rough = f64::from((x * 7 + y * 13 + x * y) % 11) / 11.0;
        depth.min(1.0) * 0.8 + 0.2 * rough
    });
    HeightMap::from_image(&raw, Channel::Luma)
}

/// Texture coordinates that follow from places: no seam anywhere, mirrored on the far half.
fn sphere() -> WorldMesh {
    let mut mesh = bodies::sphere(8).mesh(true);
    for vertex in &mut mesh.vertices {
        vertex.uv *= 0.5;
    }
    mesh
}

/// Whole turns of the map both ways, with a seam along each.
fn torus() -> WorldMesh {
    let mut mesh = WorldMesh::default();
    mesh.patch([24, 12], 0, |s, t| {
        // The last column and row lie exactly on the first.
        let [(sin_a, cos_a), (sin_b, cos_b)] = [s, t].map(|x| (x.fract() * TAU).sin_cos());
        let out = DVec3::new(cos_a, sin_a, 0.0);
        let normal = out * cos_b + DVec3::Z * sin_b;
        Vertex {
            position: out + normal * 0.4,
            normal,
            uv: DVec2::new(2.0 * s, t),
        }
    });
    mesh
}

/// Six charts that jump at all edges, and face normals.
fn cube() -> WorldMesh {
    let mut mesh = WorldMesh::default();
    for (k, side) in (0..3).flat_map(|k| [(k, 1.0), (k, -1.0)]) {
        let normal = DVec3::AXES[k] * side;
        let (across, up) = (DVec3::AXES[(k + 1) % 3], DVec3::AXES[(k + 2) % 3]);
        mesh.patch([4, 4], 0, |s, t| Vertex {
            position: normal + across * (2.0 * s - 1.0) + up * (2.0 * t - 1.0),
            normal,
            uv: DVec2::new(0.05 + 0.55 * s, 0.1 + 0.55 * t),
        });
    }
    for attributes in &mut mesh.attributes {
        attributes.smooth = false;
    }
    mesh
}
