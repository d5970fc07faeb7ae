//! What searches make of a height map before they can start.

use std::time::Instant;

use super::{Precompute, Subject};
use crate::surface::mapping::Method;
use crate::texture::{ConeMap, HeightPyramid};

/// Makes once more, on one thread or as many as the maker takes, what the methods need for the map that is looked at.
#[must_use]
pub fn precompute(subject: &Subject, methods: &[Method]) -> Vec<Precompute> {
    let (Some(slot), Some(image)) = (subject.height_slot(), subject.height_image()) else {
        return Vec::new();
    };
    let map = image.height(slot.channel);
    let mut made = Vec::new();
    let walks = |m: &Method| m.searches() || *m == Method::Displacement;
    if methods.iter().any(walks) {
        let (pyramid, ms) = timed(|| HeightPyramid::new(map, slot.wrap));
        made.push(Precompute {
            what: "pyramid of extremes (exact, displacement, and every relief that shadows itself)"
                .to_owned(),
            ms,
            bytes: pyramid.bytes(),
        });
    }
    if methods.contains(&Method::RelaxedCone) {
        let inverted = slot.gain_and_bias().0 < 0.0;
        let (cones, ms) = timed(|| ConeMap::new(map, slot.wrap, inverted));
        made.push(Precompute {
            what: "map of cones (relaxed-cone)".to_owned(),
            ms,
            bytes: cones.bytes(),
        });
    }
    made
}

fn timed<T>(make: impl FnOnce() -> T) -> (T, f64) {
    let began = Instant::now();
    let made = make();
    (made, began.elapsed().as_secs_f64() * 1e3)
}
