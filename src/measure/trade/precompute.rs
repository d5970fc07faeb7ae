//! What is made of maps before methods can start.

use std::time::Instant;

use super::{Plan, Precompute, Subject};
use crate::surface::mapping::Method;
use crate::texture::{ConeMap, HeightPyramid, HorizonMap, MapRole, RawImage, Wrap, destaired};

/// What the methods of a plan need for the map that is looked at. `slopes` is how many slope maps were made for the
/// measurement, and in how many milliseconds.
#[must_use]
pub fn made_before(
    subject: &Subject,
    plan: &Plan,
    slopes: Option<(usize, f64)>,
) -> Vec<Precompute> {
    let mut made = precompute(subject, &plan.methods);
    if let Some((maps @ 1.., ms)) = slopes {
        let bytes = subject.image(MapRole::Slope).map_or(0, |image| {
            let RawImage {
                width,
                height,
                channels,
                ..
            } = image.raw;
            let samples = width as usize * height as usize * usize::from(channels);
            samples * usize::from(image.raw.bits() / 8)
        });
        made.push(Precompute {
            what: format!("slope maps from normal maps, made for this measurement: {maps} (slope)"),
            ms,
            bytes,
        });
    }
    made
}

/// Makes once more, on one thread or as many as the maker takes, what the methods need for the map that is looked at.
fn precompute(subject: &Subject, methods: &[Method]) -> Vec<Precompute> {
    let (Some(slot), Some(image)) = (subject.height_slot(), subject.height_image()) else {
        return Vec::new();
    };
    let mut made = Vec::new();
    if slot.destair {
        let stored = image.heights(slot.channel);
        let step = stored.levels().step;
        let (smoothed, ms) = timed(|| destaired(stored.map(), step, slot.wrap));
        made.push(Precompute {
            what: "map with its stairs smoothed (every method that reads heights)".to_owned(),
            ms,
            bytes: smoothed.bytes(),
        });
    }
    // What the slot reads, stairs smoothed if it asks for that: what follows is made of it.
    let map = image.heights_of(slot).map();
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
    let inverted = slot.gain_and_bias().0 < 0.0;
    if methods.iter().any(walks) && slot.wrap == Wrap::Repeat {
        let (horizons, ms) = timed(|| HorizonMap::new(map, inverted));
        made.push(Precompute {
            what: "map of horizons (displacement of flat charts, and every relief that shadows itself)"
                .to_owned(),
            ms,
            bytes: horizons.bytes(),
        });
    }
    if methods.contains(&Method::RelaxedCone) {
        let (cones, ms) = timed(|| ConeMap::new(map, slot.wrap, inverted));
        made.push(Precompute {
            what: "map of cones (relaxed-cone)".to_owned(),
            ms,
            bytes: cones.bytes(),
        });
    }
    made
}

/// What `make` makes, and the milliseconds that it takes.
pub fn timed<T>(make: impl FnOnce() -> T) -> (T, f64) {
    let began = Instant::now();
    let made = make();
    (made, began.elapsed().as_secs_f64() * 1e3)
}
