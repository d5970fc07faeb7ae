//! Traces one ray against two triangles: `cargo run --release --example trace_one_ray`.
//!
//! Shows the three steps from geometry to a surface point: build a tree over a mesh, ask it for the closest
//! hit, and turn the compact hit into the full surface record.
#![expect(clippy::print_stdout, reason = "an example shows its results")]

use glam::{Vec2, Vec3};
use reliefscope::geometry::bvh::{AcceptAll, Bvh};
use reliefscope::geometry::triangle::Watertight;
use reliefscope::geometry::{Ray, TriangleAttributes, TriangleMesh};
use reliefscope::math::normalize_or;
use reliefscope::surface::{SurfaceParts, surface_at};

fn main() {
    // A square with corners at ±1 in the plane z = 0, its texture laid out once across it.
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let attributes = TriangleAttributes {
        material: 0,
        has_uv: true,
        smooth: false,
    };
    let mesh = TriangleMesh {
        positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
        normals: Vec::new(),
        uvs: corners
            .map(|(x, y)| Vec2::new(x, y) * 0.5 + Vec2::splat(0.5))
            .to_vec(),
        indices: vec![[0, 1, 2], [0, 2, 3]],
        attributes: vec![attributes; 2],
    };
    let bvh = Bvh::build(&mesh);

    // Directions have unit length, so that t is a distance.
    let origin = Vec3::new(0.0, -2.0, 2.0);
    let target = Vec3::new(-0.5, 0.25, 0.0);
    let ray = Ray {
        origin,
        dir: normalize_or(target - origin, Vec3::NEG_Z),
    };
    let Some(hit) = bvh.intersect::<Watertight, _>(&ray, f32::INFINITY, &AcceptAll) else {
        println!("the ray leaves the scene");
        return;
    };
    println!("hit triangle {} at distance {:.6}", hit.prim, hit.t);
    println!(
        "weights of its corners: {:.4} {:.4} {:.4}",
        1.0 - hit.u - hit.v,
        hit.u,
        hit.v
    );

    let surface = surface_at(&mesh, &hit, &ray, SurfaceParts::Gradients);
    let [p, p_error, normal] = [surface.p, surface.p_error, surface.n_geo].map(Vec3::from);
    println!("point  {p} (known to ±{p_error})");
    println!("normal {normal}");
    println!("uv     {}", Vec2::from(surface.uv));
    println!(
        "uv grows by {} and {} per unit of length",
        Vec3::from(surface.grad_u),
        Vec3::from(surface.grad_v)
    );
}
