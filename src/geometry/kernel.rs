//! Which ray–triangle test and which offset is looked at, where the program's own are compared with textbooks'.

use glam::Vec3;

use super::bvh::{Bvh, HitFilter};
use super::triangle::{
    MollerTrumbore, PlainWoop, ReportEdges, TriangleHit, TriangleTest, Watertight,
};
use super::{Hit, OriginRule, Ray, RaySlabs};

/// A ray–triangle test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kernel {
    /// The program's own.
    #[default]
    Watertight,
    /// The report's equations 2.4–2.8, with 2.8 corrected.
    Report,
    /// Möller and Trumbore 1997.
    MollerTrumbore,
    /// Woop, Benthin and Wald 2013 in `f32` alone, see [`PlainWoop`].
    Woop,
}

impl Kernel {
    /// All, the program's own first.
    pub const ALL: [Self; 4] = [
        Self::Watertight,
        Self::Report,
        Self::MollerTrumbore,
        Self::Woop,
    ];

    /// Name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Watertight => "watertight",
            Self::Report => "report",
            Self::MollerTrumbore => "moller-trumbore",
            Self::Woop => "woop",
        }
    }

    /// The kernel of that [`Self::name`].
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kernel| kernel.name() == name)
    }

    /// The closest hit ahead that counts, through the tree.
    #[must_use]
    pub fn closest(self, bvh: &Bvh, ray: &Ray, filter: &impl HitFilter) -> Option<Hit> {
        let far = f32::INFINITY;
        match self {
            Self::Watertight => bvh.intersect::<Watertight, _>(ray, far, filter),
            Self::Report => bvh.intersect::<ReportEdges, _>(ray, far, filter),
            Self::MollerTrumbore => bvh.intersect::<MollerTrumbore, _>(ray, far, filter),
            Self::Woop => bvh.intersect::<PlainWoop, _>(ray, far, filter),
        }
    }

    /// Whether anything that counts is hit nearer than `t_max`, through the tree.
    #[must_use]
    pub fn occluded(self, bvh: &Bvh, ray: &Ray, t_max: f32, filter: &impl HitFilter) -> bool {
        match self {
            Self::Watertight => bvh.occluded::<Watertight, _>(ray, t_max, filter),
            Self::Report => bvh.occluded::<ReportEdges, _>(ray, t_max, filter),
            Self::MollerTrumbore => bvh.occluded::<MollerTrumbore, _>(ray, t_max, filter),
            Self::Woop => bvh.occluded::<PlainWoop, _>(ray, t_max, filter),
        }
    }

    /// One triangle alone.
    #[must_use]
    pub fn triangle(self, ray: &Ray, corners: &[Vec3; 3]) -> Option<TriangleHit> {
        let reach = corners.map(|c| c.abs().max_element());
        let slabs = RaySlabs::new(ray, reach.into_iter().fold(0.0, f32::max));
        match self {
            Self::Watertight => Watertight::new(ray).intersect(&slabs, corners),
            Self::Report => ReportEdges::new(ray).intersect(&slabs, corners),
            Self::MollerTrumbore => MollerTrumbore::new(ray).intersect(&slabs, corners),
            Self::Woop => PlainWoop::new(ray).intersect(&slabs, corners),
        }
    }
}

/// How far from its surface a leaving ray starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OffsetRule {
    /// By the rounding bound of its point: the program's own.
    #[default]
    Bound,
    /// By 10⁻⁴ units along the normal, the textbooks' epsilon.
    Fixed,
}

impl OffsetRule {
    /// The textbooks' epsilon, in the units that are traced in.
    pub const EPSILON: f32 = 1e-4;

    /// Both, the program's own first.
    pub const ALL: [Self; 2] = [Self::Bound, Self::Fixed];

    /// Name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bound => "bound",
            Self::Fixed => "fixed",
        }
    }

    /// The rule of that [`Self::name`].
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|rule| rule.name() == name)
    }

    /// As geometry takes it.
    #[must_use]
    pub const fn origin_rule(self) -> OriginRule {
        match self {
            Self::Bound => OriginRule::Bound,
            Self::Fixed => OriginRule::Fixed(Self::EPSILON),
        }
    }
}
