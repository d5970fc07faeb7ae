//! Rays of one kind, traced alone by a number of threads.

use std::sync::{Mutex, PoisonError};

use super::spread::millis;
use super::{BenchError, Spread, pool};
use crate::geometry::bvh::{AcceptAll, Bvh};
use crate::geometry::triangle::Watertight;
use crate::geometry::{Hit, Ray};
use crate::render::{RayList, RayQuery};

/// Rays that a thread takes at a time: as many as a tile has pixels.
const BLOCK: usize = 1024;

/// A tree, and rays to trace through it.
#[derive(Debug, Clone, Copy)]
pub struct RayRace<'a> {
    /// The tree. What is cut out of triangles counts as solid.
    pub bvh: &'a Bvh,
    /// The rays.
    pub list: &'a RayList,
    /// What is asked about each.
    pub query: RayQuery,
}

/// One answer for each place in a list; nothing where there is no ray.
#[derive(Debug, Clone, PartialEq)]
pub enum Answers {
    /// Closest hits.
    Closest(Vec<Option<Hit>>),
    /// Whether there is a hit.
    Any(Vec<bool>),
}

/// How fast rays were traced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RaySpeed {
    /// By how many threads.
    pub threads: usize,
    /// Millions of rays a second in the fastest pass.
    pub best: f64,
    /// In the middle one.
    pub median: f64,
    /// In the slowest.
    pub worst: f64,
}

impl RayRace<'_> {
    /// Each ray finds the same, to the bit, when it is traced alone. Returns what that is.
    ///
    /// # Errors
    /// If not, or if there are no threads.
    pub fn check(&self) -> Result<Answers, BenchError> {
        let mut answers = self.no_answers();
        self.pass(&pool(0)?, &mut answers);
        match (0..self.list.rays.len()).find(|&ray| !self.agrees_alone(ray, &answers)) {
            Some(ray) => Err(BenchError::Ray { ray }),
            None => Ok(answers),
        }
    }

    /// Traces all rays `passes` times, after a pass that warms up.
    ///
    /// # Errors
    /// If there are no threads.
    pub fn time(&self, threads: usize, passes: usize) -> Result<RaySpeed, BenchError> {
        let pool = pool(threads)?;
        let mut answers = self.no_answers();
        let mut times = Vec::with_capacity(passes);
        for pass in 0..=passes {
            let millis = millis(|| self.pass(&pool, &mut answers));
            if pass > 0 {
                times.push(millis);
            }
        }
        let spread = Spread::of(times);
        let rays = self.list.active() as f64;
        let speed = |millis: f64| rays / (millis * 1e3).max(f64::MIN_POSITIVE);
        Ok(RaySpeed {
            threads: pool.current_num_threads(),
            best: speed(spread.min),
            median: speed(spread.median),
            worst: speed(spread.max),
        })
    }

    fn no_answers(&self) -> Answers {
        let count = self.list.rays.len();
        match self.query {
            RayQuery::Closest => Answers::Closest(vec![None; count]),
            RayQuery::Any => Answers::Any(vec![false; count]),
        }
    }

    fn pass(&self, pool: &rayon::ThreadPool, answers: &mut Answers) {
        let (bvh, list) = (self.bvh, self.list);
        match answers {
            Answers::Closest(hits) => in_blocks(pool, list, hits, None, |rays, t_max, hits| {
                bvh.intersect_many::<Watertight, _>(rays, t_max, &AcceptAll, hits);
            }),
            Answers::Any(hits) => in_blocks(pool, list, hits, false, |rays, t_max, hits| {
                bvh.occluded_many::<Watertight, _>(rays, t_max, &AcceptAll, hits);
            }),
        }
    }

    fn agrees_alone(&self, place: usize, answers: &Answers) -> bool {
        let (ray, t_max) = (&self.list.rays[place], self.list.t_max[place]);
        let is_active = RayList::is_active(t_max);
        let bits =
            |hit: Option<Hit>| hit.map(|h| [h.prim, h.t.to_bits(), h.u.to_bits(), h.v.to_bits()]);
        match answers {
            Answers::Closest(hits) => {
                let alone = || self.bvh.intersect::<Watertight, _>(ray, t_max, &AcceptAll);
                bits(is_active.then(alone).flatten()) == bits(hits[place])
            }
            Answers::Any(hits) => {
                let alone = || self.bvh.occluded::<Watertight, _>(ray, t_max, &AcceptAll);
                (is_active && alone()) == hits[place]
            }
        }
    }
}

/// One pass: each thread takes the next block, copies its rays in, traces them and copies the answers out.
/// Places without a ray are left out, as the stages of a tile leave them out.
fn in_blocks<A: Copy + Send + Sync>(
    pool: &rayon::ThreadPool,
    list: &RayList,
    answers: &mut [A],
    nothing: A,
    trace: impl Fn(&[Ray], &[f32], &mut [A]) + Sync,
) {
    let blocks = list.rays.chunks(BLOCK).zip(list.t_max.chunks(BLOCK));
    let blocks = Mutex::new(blocks.zip(answers.chunks_mut(BLOCK)));
    // Held only while a block is handed out.
    let next = || {
        let mut blocks = blocks.lock().unwrap_or_else(PoisonError::into_inner);
        blocks.next()
    };
    pool.broadcast(|_| {
        let (mut places, mut rays, mut ends) = (Vec::new(), Vec::new(), Vec::new());
        let mut found = Vec::new();
        while let Some(((block, t_max), answers)) = next() {
            places.clear();
            rays.clear();
            ends.clear();
            for (place, (ray, &end)) in block.iter().zip(t_max).enumerate() {
                if RayList::is_active(end) {
                    places.push(place);
                    rays.push(*ray);
                    ends.push(end);
                }
            }
            found.clear();
            found.resize(rays.len(), nothing);
            trace(&rays, &ends, &mut found);
            for (&place, &answer) in places.iter().zip(&found) {
                answers[place] = answer;
            }
        }
    });
}
