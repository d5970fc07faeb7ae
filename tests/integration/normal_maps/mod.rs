//! Normal maps in the spaces that bakers write.

mod mikktspace;
mod object;

use std::sync::Arc;

use glam::Vec3;
use reliefscope::geometry::simd::SimdLevel;
use reliefscope::render::{Snapshot, probe};

use crate::support::{bits, edited, picture};

/// The perturbed normal that a pixel's first ray meets.
fn normal_at(snapshot: &Snapshot, pixel: [u32; 2]) -> Vec3 {
    let story = probe(snapshot, pixel).expect("inside");
    Vec3::from(story.bounces[0].hit.as_ref().expect("a hit").n_shade)
}

/// Checks that a picture's first samples are those of the probe, to the bit, at all vector instructions.
fn same_bits_everywhere(snapshot: &Snapshot) {
    let snapshot = edited(snapshot, |s| s.samples = 1);
    for level in SimdLevel::ALL.into_iter().filter(|l| l.is_available()) {
        let mut scene = (*snapshot.scene).clone();
        scene.bvh = scene.bvh.with_level(level).expect("is available");
        let snapshot = Snapshot {
            scene: Arc::new(scene),
            ..snapshot.clone()
        };
        let film = picture(&snapshot);
        let [width, height] = snapshot.size;
        for (x, y) in (0..height)
            .step_by(5)
            .flat_map(|y| (0..width).step_by(3).map(move |x| (x, y)))
        {
            let told = probe(&snapshot, [x, y]).expect("inside").color;
            let shown = bits(&film)[(y * width + x) as usize];
            assert_eq!(
                shown,
                told.to_array().map(f32::to_bits),
                "{level:?} at {x}, {y}"
            );
        }
    }
}
