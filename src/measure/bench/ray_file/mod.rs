//! Files of triangles and rays of one kind: the same work for any tracer.
//!
//! One line of text, then little-endian `f32`:
//!
//! ```text
//! reliefscope-rays 1 kind=KIND query=closest|any triangles=T rays=N
//! T × 9   corners v0 v1 v2, x y z each
//! N × 8   origin x y z, tmin, direction x y z, tmax
//! ```
//!
//! A ray with tmax < tmin, or with NaN in one of them, is a place without a ray. Directions need not be of
//! unit length: distances count in their lengths. Answers are records of `t`, triangle (`u32`), `u` and `v`
//! per ray, all little endian.

mod error;
mod read;
mod write;

use glam::{DVec3, Vec3};

pub use error::RayFileError;
pub use read::read_rays;
pub use write::{write_hits, write_rays};

use crate::geometry::{Ray, TriangleMesh};
use crate::render::{RayList, RayQuery};

/// What a file begins with.
const MAGIC: &str = "reliefscope-rays 1";
/// Kinds that a file may name.
const KINDS: [&str; 5] = ["camera", "point-shadow", "sun-shadow", "mirror", "diffuse"];
const TRIANGLE_BYTES: usize = 9 * 4;
const RAY_BYTES: usize = 8 * 4;

/// Squared lengths this near to 1 are those of unit vectors that were rounded, by one reflection after another.
/// Distances are exact all the same: the triangle tests count in lengths of the direction.
const UNIT_TOLERANCE: f64 = 1e-4;

/// What a file holds.
#[derive(Debug, Clone)]
pub struct RayFile {
    /// Why the rays were sent.
    pub kind: String,
    /// What is asked about them.
    pub query: RayQuery,
    /// The triangles, in the file's units; nothing but corners.
    pub mesh: TriangleMesh,
    /// The rays.
    pub rays: Vec<FileRay>,
}

/// A ray as a file holds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FileRay {
    /// Where distances count from.
    pub origin: Vec3,
    /// Where the ray begins, in lengths of `dir`.
    pub t_min: f32,
    /// Direction of any length.
    pub dir: Vec3,
    /// Where it ends, in lengths of `dir`.
    pub t_max: f32,
}

impl FileRay {
    /// Whether it is a ray at all.
    #[must_use]
    pub fn is_active(&self) -> bool {
        self.t_max >= self.t_min
    }

    /// The ray with a unit direction that begins at its origin, and where it ends.
    ///
    /// A ray of unit direction that begins at 0 is kept to the bit. Others are turned into one of that sort
    /// in double precision, then rounded: a hit within rounding of `t_min` may come or go.
    #[must_use]
    pub fn normalized(&self) -> Option<(Ray, f32)> {
        if !self.is_active() {
            return None;
        }
        let (length, dir) = (self.length(), self.dir.as_dvec3());
        let origin = if self.t_min == 0.0 {
            self.origin
        } else {
            (self.origin.as_dvec3() + dir * f64::from(self.t_min)).as_vec3()
        };
        let dir = (dir / length).as_vec3();
        let t_max = (f64::from(self.t_max) - f64::from(self.t_min)) * length;
        Some((Ray { origin, dir }, t_max as f32))
    }

    /// A distance along the [normalized](Self::normalized) ray in lengths of `dir` from `origin`.
    #[must_use]
    pub fn file_t(&self, t: f32) -> f32 {
        (f64::from(self.t_min) + f64::from(t) / self.length()) as f32
    }

    /// Length of `dir`; exactly 1 where it differs by rounding only.
    fn length(&self) -> f64 {
        let squared = DVec3::from(self.dir).length_squared();
        if (squared - 1.0).abs() <= UNIT_TOLERANCE {
            1.0
        } else {
            squared.sqrt()
        }
    }
}

impl RayFile {
    /// The rays in a form that can be traced.
    #[must_use]
    pub fn list(&self) -> RayList {
        let mut list = RayList::default();
        self.rays.iter().for_each(|ray| list.push(ray.normalized()));
        list
    }
}
