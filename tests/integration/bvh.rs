//! The hierarchy against testing every triangle, on easy and on nasty meshes.

use glam::Vec3;
use reliefscope::geometry::bvh::{AcceptAll, Bvh};
use reliefscope::geometry::triangle::{TriangleHit, TriangleTest, Watertight};
use reliefscope::geometry::{Hit, Ray, RaySlabs, TriangleMesh};

use crate::shapes::{Random, mesh, mixed_ray, placed, plane, random_soup, soup, sphere, torus};

/// All hits of a ray, the closest first: every triangle tested in turn.
fn brute_force(mesh: &TriangleMesh, reach: f32, ray: &Ray) -> Vec<Hit> {
    let (test, slabs) = (Watertight::new(ray), RaySlabs::new(ray, reach));
    let hit = |prim| {
        let TriangleHit { t, u, v } = test.intersect(&slabs, &mesh.corners(prim))?;
        Some(Hit {
            t,
            prim,
            sub: 0,
            u,
            v,
        })
    };
    let mut hits: Vec<_> = (0..mesh.len() as u32).filter_map(hit).collect();
    // Stable: the lowest index stays first among equals.
    hits.sort_by(|a, b| a.t.total_cmp(&b.t));
    hits
}

/// All that must be equal, as bits.
fn bits(hit: Option<Hit>) -> Option<[u32; 5]> {
    hit.map(|h| [h.t.to_bits(), h.prim, h.sub, h.u.to_bits(), h.v.to_bits()])
}

fn assert_equals_brute_force(name: &str, mesh: &TriangleMesh, rays: usize) {
    let bvh = Bvh::build(mesh);
    bvh.validate(mesh).unwrap_or_else(|e| panic!("{name}: {e}"));
    let mut random = Random::new(7);
    let mut hits = 0;
    for i in 0..rays {
        let ray = mixed_ray(mesh, bvh.bounds(), &mut random);
        let expected = brute_force(mesh, bvh.reach(), &ray);
        hits += usize::from(!expected.is_empty());
        // All, the closest just excluded, just included.
        let closest = expected.first().map_or(1.0, |hit| hit.t);
        for t_max in [f32::INFINITY, closest, closest.next_up()] {
            let expected = expected.iter().find(|hit| hit.t < t_max).copied();
            let found = bvh.intersect::<Watertight, _>(&ray, t_max, &AcceptAll);
            assert_eq!(
                bits(found),
                bits(expected),
                "{name}, ray {i} to {t_max}: {ray:?}"
            );
            let occluded = bvh.occluded::<Watertight, _>(&ray, t_max, &AcceptAll);
            assert_eq!(
                occluded,
                expected.is_some(),
                "{name}, ray {i} to {t_max}: {ray:?}"
            );
        }
    }
    assert!(hits > rays / 20, "{name}: only {hits} hits test little");
}

/// Needles, triangles without area, points, huge and tiny ones, and copies.
fn degenerate_soup() -> TriangleMesh {
    let mut random = Random::new(11);
    let mut last = [Vec3::ZERO; 3];
    soup(240, || {
        let at = random.cube();
        let side = random.direction();
        last = match random.below(6) {
            0 => [at; 3],
            1 => [at, at + side, at + side * 0.5],
            2 => [at, at + side, at + side + random.cube() * 1e-6],
            3 => [at + side * 30.0, at - side * 30.0, random.cube() * 30.0],
            4 => [at, at + random.cube() * 1e-6, at + random.cube() * 1e-6],
            _ => last,
        };
        last
    })
}

/// The same 2 × 2 quads over and over.
fn coincident_quads() -> TriangleMesh {
    let mut quads = plane(2, 2);
    let once = quads.indices.clone();
    for _ in 1..16 {
        quads.indices.extend_from_slice(&once);
    }
    quads
}

#[test]
fn equals_brute_force_on_a_random_soup() {
    assert_equals_brute_force("soup", &random_soup(200, 0.3, 3), 100_000);
}

#[test]
fn equals_brute_force_on_a_sphere() {
    assert_equals_brute_force("sphere", &sphere(4), 100_000);
    assert_equals_brute_force("small sphere", &placed(sphere(4), 1e-6, 0.0), 10_000);
    assert_equals_brute_force("far sphere", &placed(sphere(4), 1.0, 1e4), 20_000);
}

#[test]
fn equals_brute_force_on_a_torus() {
    assert_equals_brute_force("torus", &torus(16, 8), 40_000);
}

#[test]
fn equals_brute_force_on_a_plane() {
    assert_equals_brute_force("plane", &plane(10, 10), 100_000);
}

#[test]
fn equals_brute_force_on_a_degenerate_soup() {
    assert_equals_brute_force("degenerate soup", &degenerate_soup(), 100_000);
}

#[test]
fn equals_brute_force_on_coincident_quads() {
    assert_equals_brute_force("coincident quads", &coincident_quads(), 100_000);
}

#[test]
fn filter_makes_holes_for_closest_and_any_hit() {
    let mesh = random_soup(200, 0.5, 5);
    let bvh = Bvh::build(&mesh);
    let mut random = Random::new(9);
    let filter = |prim: u32, u: f32, v: f32| !prim.is_multiple_of(3) && u + v < 0.7;
    let mut fewer = 0;
    for _ in 0..20_000 {
        let ray = mixed_ray(&mesh, bvh.bounds(), &mut random);
        let all = brute_force(&mesh, bvh.reach(), &ray);
        let expected = all
            .iter()
            .find(|hit| hit.t < 2.0 && filter(hit.prim, hit.u, hit.v))
            .copied();
        let found = bvh.intersect::<Watertight, _>(&ray, 2.0, &filter);
        assert_eq!(bits(found), bits(expected), "{ray:?}");
        let occluded = bvh.occluded::<Watertight, _>(&ray, 2.0, &filter);
        assert_eq!(occluded, expected.is_some(), "{ray:?}");
        fewer += usize::from(bits(all.first().copied()) != bits(expected));
    }
    assert!(fewer > 1000, "the filter removed only {fewer} hits");
}

#[test]
fn many_rays_equal_single_rays() {
    let mesh = torus(24, 12);
    let bvh = Bvh::build(&mesh);
    let mut random = Random::new(13);
    let rays: Vec<_> = (0..5000)
        .map(|_| mixed_ray(&mesh, bvh.bounds(), &mut random))
        .collect();
    let t_max: Vec<_> = rays.iter().map(|_| random.unit() * 4.0).collect();
    let mut hits = vec![None; rays.len()];
    let mut occluded = vec![false; rays.len()];
    bvh.intersect_many::<Watertight, _>(&rays, &t_max, &AcceptAll, &mut hits);
    bvh.occluded_many::<Watertight, _>(&rays, &t_max, &AcceptAll, &mut occluded);
    for (i, (ray, &t_max)) in rays.iter().zip(&t_max).enumerate() {
        let hit = bvh.intersect::<Watertight, _>(ray, t_max, &AcceptAll);
        assert_eq!(bits(hits[i]), bits(hit));
        assert_eq!(occluded[i], hit.is_some());
    }
}

/// Shuffled triangles, so that the tree differs, and the index each had before.
fn shuffled(original: &TriangleMesh, seed: u32) -> (TriangleMesh, Vec<u32>) {
    let mut random = Random::new(seed);
    let mut order: Vec<_> = (0..original.len() as u32).collect();
    for i in (1..order.len()).rev() {
        order.swap(i, random.below(i + 1));
    }
    let indices = order
        .iter()
        .map(|&i| original.indices[i as usize])
        .collect();
    (mesh(original.positions.clone(), indices), order)
}

#[test]
fn shuffled_builds_give_the_same_surface() {
    let original = torus(40, 20);
    let bvh = Bvh::build(&original);
    for seed in 0..4 {
        let (mesh, order) = shuffled(&original, seed);
        let other = Bvh::build(&mesh);
        other.validate(&mesh).unwrap();
        let mut random = Random::new(17 + seed);
        for _ in 0..10_000 {
            let ray = mixed_ray(&original, bvh.bounds(), &mut random);
            let a = bvh.intersect::<Watertight, _>(&ray, f32::INFINITY, &AcceptAll);
            let b = other.intersect::<Watertight, _>(&ray, f32::INFINITY, &AcceptAll);
            assert_eq!(
                a.map(|h| h.t.to_bits()),
                b.map(|h| h.t.to_bits()),
                "{ray:?}"
            );
            // On a shared edge the index decides, and the indices have changed.
            if let (Some(a), Some(b)) = (a, b)
                && a.u > 0.0
                && a.v > 0.0
                && a.u + a.v < 1.0
                && order[b.prim as usize] == a.prim
            {
                assert_eq!([a.u, a.v].map(f32::to_bits), [b.u, b.v].map(f32::to_bits));
            }
        }
    }
}

#[test]
fn thread_count_leaves_no_trace() {
    // Large enough for parallel binning and parallel subtrees.
    let mesh = sphere(60);
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| Bvh::build(&mesh))
    };
    let (one, many) = (build(1), build(5));
    assert!(one.same_tree(&many));
    one.validate(&mesh).unwrap();
}

#[test]
fn a_watched_build_stops_when_told() {
    let mesh = sphere(100);
    let shares = std::sync::Mutex::new(Vec::new());
    let note = |share: f32| {
        shares.lock().unwrap().push(share);
        Ok::<_, ()>(())
    };
    let watched = Bvh::build_watched(&mesh, &note).unwrap();
    assert!(watched.same_tree(&Bvh::build(&mesh)));
    let shares = shares.into_inner().unwrap();
    assert!(shares.len() > 5 && shares[0] == 0.0 && shares.contains(&1.0));

    for limit in [0.0, 0.5, 1.0] {
        let stop = |share: f32| if share < limit { Ok(()) } else { Err(limit) };
        assert_eq!(Bvh::build_watched(&mesh, &stop).err(), Some(limit));
    }
    let never = Bvh::build_watched(&TriangleMesh::default(), &|_| Err(()));
    assert!(never.is_err());
}

#[test]
fn nothing_to_hit() {
    let empty = Bvh::build(&TriangleMesh::default());
    empty.validate(&TriangleMesh::default()).unwrap();
    let ray = Ray {
        origin: Vec3::ZERO,
        dir: Vec3::X,
    };
    assert_eq!(
        empty.intersect::<Watertight, _>(&ray, f32::INFINITY, &AcceptAll),
        None
    );
    assert!(!empty.occluded::<Watertight, _>(&ray, f32::INFINITY, &AcceptAll));
    assert!(empty.is_empty());
    assert_eq!(empty.stats().leaves, 0);
}

#[test]
fn degenerate_sets_build_valid_trees() {
    let mut random = Random::new(19);
    let one = soup(1, || [Vec3::ZERO, Vec3::X, Vec3::Y]);
    let coincident = soup(100_000, || [Vec3::ZERO, Vec3::X, Vec3::Y]);
    let points = soup(1000, || [Vec3::ONE; 3]);
    // Boxes around one centre, from 10⁻³⁰ to 10³⁰.
    let concentric = soup(5000, || {
        let size = 10.0_f32.powf(random.unit() * 60.0 - 30.0);
        [
            Vec3::splat(-size),
            Vec3::splat(size),
            Vec3::new(-size, size, size),
        ]
    });
    // Each twice as far as the one before: the shape that makes binning peel off one at a time.
    let mut at = 1e-38_f32;
    let geometric = soup(250, || {
        at *= 2.0;
        [
            Vec3::splat(at),
            Vec3::splat(at * 1.5),
            Vec3::new(at, at, at * 1.5),
        ]
    });
    let enormous = soup(100, || [(); 3].map(|()| random.cube() * f32::MAX));
    let cases = [one, coincident, points, concentric, geometric, enormous];
    for (case, mesh) in cases.iter().enumerate() {
        let bvh = Bvh::build(mesh);
        bvh.validate(mesh)
            .unwrap_or_else(|e| panic!("case {case}: {e}"));
        let stats = bvh.stats();
        assert_eq!(stats.triangles, mesh.len());
        assert!(stats.max_depth < 100, "case {case}: {stats:?}");
        for _ in 0..200 {
            let ray = mixed_ray(mesh, bvh.bounds(), &mut random);
            if let Some(hit) = bvh.intersect::<Watertight, _>(&ray, f32::INFINITY, &AcceptAll) {
                assert!(hit.t > 0.0 && hit.t.is_finite() && hit.u.is_finite() && hit.v.is_finite());
            }
        }
    }
}

#[test]
fn lowest_index_wins_among_a_hundred_thousand_copies() {
    let mesh = soup(100_000, || [Vec3::ZERO, Vec3::X, Vec3::Y]);
    let bvh = Bvh::build(&mesh);
    let ray = Ray {
        origin: Vec3::new(0.2, 0.3, 1.0),
        dir: -Vec3::Z,
    };
    let hit = bvh
        .intersect::<Watertight, _>(&ray, f32::INFINITY, &AcceptAll)
        .unwrap();
    assert_eq!((hit.prim, hit.t), (0, 1.0));
    let odd = |prim: u32, _: f32, _: f32| prim % 1000 == 999;
    let hit = bvh
        .intersect::<Watertight, _>(&ray, f32::INFINITY, &odd)
        .unwrap();
    assert_eq!(hit.prim, 999);
    // Full leaves: no place is wasted.
    assert!(bvh.stats().leaf_fill > 0.99, "{:?}", bvh.stats());
}

#[test]
fn rays_that_are_no_rays_hit_nothing() {
    let mesh = sphere(4);
    let bvh = Bvh::build(&mesh);
    for bad in [f32::NAN, f32::INFINITY] {
        for axis in 0..3 {
            let mut ray = Ray {
                origin: Vec3::ZERO,
                dir: Vec3::X,
            };
            ray.origin[axis] = bad;
            assert_eq!(
                bvh.intersect::<Watertight, _>(&ray, f32::INFINITY, &AcceptAll),
                None
            );
            ray.origin[axis] = 0.0;
            ray.dir[axis] = f32::NAN;
            assert_eq!(
                bvh.intersect::<Watertight, _>(&ray, f32::INFINITY, &AcceptAll),
                None
            );
        }
    }
    let none = Ray {
        origin: Vec3::ZERO,
        dir: Vec3::ZERO,
    };
    assert_eq!(
        bvh.intersect::<Watertight, _>(&none, f32::INFINITY, &AcceptAll),
        None
    );
    let ray = Ray {
        origin: Vec3::ZERO,
        dir: Vec3::X,
    };
    for t_max in [f32::NAN, 0.0, -1.0] {
        assert_eq!(
            bvh.intersect::<Watertight, _>(&ray, t_max, &AcceptAll),
            None
        );
    }
}

#[test]
fn stats_count_what_is_there() {
    let mesh = sphere(20);
    let bvh = Bvh::build(&mesh);
    let stats = bvh.stats();
    assert_eq!(stats.triangles, 4800);
    assert_eq!(stats.bytes, stats.nodes * 256 + stats.leaves * 320);
    assert!(stats.leaf_fill > 0.8 && stats.leaf_fill <= 1.0, "{stats:?}");
    assert!((2..8).contains(&stats.max_depth), "{stats:?}");
    assert!(stats.sah_cost > 1.0 && stats.sah_cost < 30.0, "{stats:?}");
}
