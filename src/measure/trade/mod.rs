//! What accuracy costs: every method on one model and map, from many angles, against the truth.
//!
//! - `plan`: what is measured, in which order, and which part of it a shard takes; `variant`: methods with their
//!   parameters
//! - `subject`: the scene, the place that is looked at; `orbit`: cameras around it; `depths`: fewer bits of height;
//!   `slopes`: the slope map that a material lacks
//! - `truth`: where a view ray really lands, in double precision; `facet`: triangles in double precision
//! - `sights`, `geometric`: view rays through every method, and how far each lands from the truth
//! - `pictures`: pictures against a reference that knows its own error; `timing`, `precompute`: what it takes
//! - `sweep`: all of it; `record`: what comes out; `merge`: shards put together again
//! - `advice`: the cheapest method that is good enough; `glance`: a small sweep of one view, for a window
//! - `table`, `plots` (of `chart`s), `page`: what came out as CSV, as drawings, as one HTML page; `notes`: what to know
//!   before trusting it

mod advice;
mod chart;
mod depths;
mod doubt;
mod facet;
mod geometric;
mod glance;
mod merge;
mod notes;
mod orbit;
mod page;
mod pictures;
mod plan;
mod plots;
mod precompute;
mod record;
mod sights;
mod slopes;
mod subject;
mod sweep;
mod table;
mod timing;
mod truth;
mod variant;

pub use advice::{Advice, Measured, Question, advise};
pub use chart::short;
pub use doubt::PictureDoubt;
pub use geometric::{outline_agreement, quantile};
pub use glance::{Glance, GlancePoint, glance};
pub use merge::{MergeError, merge};
pub use page::page;
pub use plan::{Plan, Shard, View};
pub use plots::{PlotMetric, color as method_color, error_by_angle, error_by_cost};
pub use record::{
    Cell, Cost, FORMAT, GeometricErrors, MachineFacts, PictureErrors, Precompute, Record, Spread3,
    Stats, SubjectFacts, ViewFacts,
};
pub use subject::{Subject, TradeError};
pub use sweep::{Watch, measure};
pub use table::csv_table;
pub use truth::{Landing, Truth};
pub use variant::Variant;
