//! From a scene and settings to a picture.

mod counters;
mod crash;
mod displaced_rays;
mod film;
mod frame;
mod material;
mod probe;
mod profile;
mod progressive;
mod ray_jobs;
mod ray_list;
mod recorder;
mod records;
mod sampling;
mod sites;
mod stages;
mod stop;
mod suspect;
mod tile;
mod view;

pub use counters::Counters;
pub use crash::crashing_pixel;
pub use displaced_rays::Passage;
pub use film::Picture;
pub use frame::{Frame, FrameLight, FrameLightKind};
pub use material::amplitude;
pub use probe::{BounceStory, HitStory, LightStory, PixelStory, Visibility, probe};
pub use profile::{LightProfile, MethodProfile, NoProfile, ReliefProfile, profile};
pub use progressive::{PassEnd, Progressive, Shown, Snapshot};
pub use ray_jobs::rays_of;
pub use ray_list::{RayKind, RayList, RayQuery};
pub use records::{PixelRecord, Recording, Records, UvYardstick};
pub use sampling::pixel_sample;
pub use stages::{Stage, StageWatch};
pub use stop::Stop;
pub use view::{Legend, MARK, NO_VALUE};
