//! Rays of one kind, and what is asked about them.

use glam::Vec3;

use crate::geometry::Ray;

/// Why a ray is sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RayKind {
    /// From the eye.
    Camera,
    /// From a surface to a point light.
    PointShadow,
    /// From a surface to a directional light.
    SunShadow,
    /// From a mirror.
    Mirror,
}

/// What is asked about a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RayQuery {
    /// The closest hit.
    Closest,
    /// Whether there is a hit.
    Any,
}

impl RayKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [
        Self::Camera,
        Self::PointShadow,
        Self::SunShadow,
        Self::Mirror,
    ];

    /// Name on the command line and in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::PointShadow => "point-shadow",
            Self::SunShadow => "sun-shadow",
            Self::Mirror => "mirror",
        }
    }

    /// The kind of that [`Self::name`].
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// What the renderer asks about it.
    #[must_use]
    pub const fn query(self) -> RayQuery {
        match self {
            Self::Camera | Self::Mirror => RayQuery::Closest,
            Self::PointShadow | Self::SunShadow => RayQuery::Any,
        }
    }
}

/// Rays with the distances at which they end, internal units. A place without a ray ends below 0.
#[derive(Debug, Clone, Default)]
pub struct RayList {
    /// The rays; anything where there is none.
    pub rays: Vec<Ray>,
    /// Their ends; at least 0 where there is a ray.
    pub t_max: Vec<f32>,
}

impl RayList {
    /// The end of a place without a ray.
    pub const INACTIVE: f32 = -1.0;

    /// Adds a ray, or a place without one.
    pub fn push(&mut self, ray: Option<(Ray, f32)>) {
        let nothing = Ray {
            origin: Vec3::ZERO,
            dir: Vec3::ZERO,
        };
        let (ray, t_max) = ray.unwrap_or((nothing, Self::INACTIVE));
        self.rays.push(ray);
        self.t_max.push(t_max);
    }

    /// Whether there is a ray that ends here; not for NaN.
    #[must_use]
    pub fn is_active(t_max: f32) -> bool {
        t_max >= 0.0
    }

    /// Number of rays, places without one left out.
    #[must_use]
    pub fn active(&self) -> usize {
        self.t_max.iter().filter(|t| Self::is_active(**t)).count()
    }
}
