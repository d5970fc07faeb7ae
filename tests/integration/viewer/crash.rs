//! A panic in the tracer: the message names the pixel and how to see it again, and the next picture comes.

use std::panic;
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use reliefscope::render::{Progressive, Snapshot, crashing_pixel, probe};
use reliefscope::scene::DisplaySettings;
use reliefscope::viewer::worker::{
    FirstPass, PassRenderer, Refinement, RenderNote, RenderRequest, RenderWorker,
};

use crate::support::QuadScene;

/// Longer than any machine needs.
const PATIENCE: Duration = Duration::from_secs(60);

/// The quad with another above it whose normals are missing: the loader would never let it pass.
fn broken() -> Snapshot {
    let mut snapshot = QuadScene::new().snapshot();
    let scene = Arc::get_mut(&mut snapshot.scene).expect("nobody else has it");
    scene.mesh.normals.truncate(4);
    snapshot
}

fn request(snapshot: &Snapshot) -> RenderRequest {
    RenderRequest {
        snapshot: snapshot.clone(),
        threads: 1,
        display: DisplaySettings::default(),
        first_pass: FirstPass::FullResolution,
        refinement: Refinement::Paused,
        compare: None,
    }
}

#[test]
fn the_pixel_is_found_where_the_damage_is() {
    let sound = QuadScene::new().snapshot();
    assert_eq!(crashing_pixel(&sound), None);
    let pixel = crashing_pixel(&broken()).expect("it panics");
    let story = probe(&sound, pixel).expect("inside the picture");
    let hit = story.bounces[0].hit.as_ref().expect("the upper quad");
    assert!(hit.triangle >= 2, "{hit:?}");
    let replayed = panic::catch_unwind(|| probe(&broken(), pixel).is_some());
    assert!(
        replayed.is_err(),
        "the story of that very pixel panics, too"
    );
}

#[test]
fn the_window_is_told_the_pixel_and_goes_on() {
    let (wake, woken) = channel();
    let wake = Mutex::new(wake);
    let factory = |threads| Ok(Box::new(Progressive::new(threads)?) as Box<dyn PassRenderer>);
    let mut worker = RenderWorker::spawn(Box::new(factory), move || {
        // The test may be over.
        let _ = wake.lock().expect("wake").send(());
    })
    .expect("a thread");
    let broken = broken();
    worker.submit(request(&broken));
    woken.recv_timeout(PATIENCE).expect("a message");
    let notes = worker.take_notes();
    let [RenderNote::Error(text)] = &notes[..] else {
        panic!("{notes:?}");
    };
    let [x, y] = crashing_pixel(&broken).expect("it panics");
    let command = format!("reliefscope probe 'quad' --size 48x40 --method bump --pixel {x},{y}");
    assert!(text.contains(&command), "{text}");
    worker.submit(request(&QuadScene::new().snapshot()));
    while worker.take_frame().is_none() {
        woken.recv_timeout(PATIENCE).expect("a frame");
    }
}
