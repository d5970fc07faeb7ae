//! The window's finished picture is `render`'s, byte for byte.

use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::Duration;

use reliefscope::measure::read_picture;
use reliefscope::render::{Progressive, Snapshot};
use reliefscope::scene::load::LoadOptions;
use reliefscope::scene::open;
use reliefscope::viewer::worker::{
    FirstPass, PassRenderer, Refinement, RenderRequest, RenderWorker,
};

const SIZE: [u32; 2] = [90, 70];
const SAMPLES: u32 = 3;
const SCENE: &str = "mirrors";

/// Longer than any machine needs; only a hang takes it.
const PATIENCE: Duration = Duration::from_secs(120);

/// What the command line writes, as the three bytes of every pixel.
fn rendered(threads: usize) -> Vec<[u8; 3]> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("picture.png");
    let status = Command::new(env!("CARGO_BIN_EXE_reliefscope"))
        .args([
            "render",
            SCENE,
            "--size",
            &format!("{}x{}", SIZE[0], SIZE[1]),
        ])
        .args([
            "--samples",
            &SAMPLES.to_string(),
            "--threads",
            &threads.to_string(),
        ])
        .arg("-o")
        .arg(&path)
        .output()
        .expect("the program starts");
    assert!(
        status.status.success(),
        "{}",
        String::from_utf8_lossy(&status.stderr)
    );
    let picture = read_picture(&path).expect("a picture");
    // Decoding to linear light and encoding again gives the bytes back.
    picture
        .pixels
        .iter()
        .map(|&c| reliefscope::math::srgb8_from_linear(c))
        .collect()
}

/// What the window's worker shows in the end, after a drag and previews.
fn shown(threads: usize) -> Vec<[u8; 3]> {
    let loaded = open(Path::new(SCENE), &LoadOptions::default()).expect("a built-in scene");
    let mut settings = loaded.settings;
    settings.samples = SAMPLES;
    let (woken_sender, woken) = channel();
    let factory = |threads| {
        let renderer: Box<dyn PassRenderer> = Box::new(Progressive::new(threads)?);
        Ok(renderer)
    };
    let wake = move || {
        let _ = woken_sender.send(());
    };
    let mut worker = RenderWorker::spawn(Box::new(factory), wake).expect("a thread");
    let mut generation = 0;
    for step in [3, 2, 1, 0] {
        let mut settings = settings.clone();
        if step > 0 {
            settings.camera.orbit(0.1 * f64::from(step), 0.0);
        }
        let snapshot = Snapshot {
            scene: Arc::clone(&loaded.scene),
            settings: Arc::new(settings),
            size: SIZE,
        };
        generation = worker.submit(RenderRequest {
            snapshot,
            display: loaded.display,
            first_pass: FirstPass::Adaptive,
            refinement: Refinement::Running,
            threads,
            compare: None,
        });
    }
    loop {
        woken.recv_timeout(PATIENCE).expect("a frame");
        if let Some(frame) = worker.take_frame()
            && frame.stats.generation == generation
            && frame.stats.converged
        {
            return frame
                .image
                .pixels
                .iter()
                .map(|p| [p.r(), p.g(), p.b()])
                .collect();
        }
    }
}

#[test]
fn a_converged_window_shows_what_render_writes() {
    let reference = rendered(1);
    assert_eq!(reference.len(), (SIZE[0] * SIZE[1]) as usize);
    assert!(
        reference.iter().any(|pixel| pixel != &reference[0]),
        "there is something to see"
    );
    for threads in [1, 2] {
        assert!(
            rendered(threads) == reference,
            "render with {threads} threads"
        );
        assert!(
            shown(threads) == reference,
            "the window with {threads} threads"
        );
    }
}
