//! Renders a scene to a PNG: `cargo run --release --example render_a_scene -- INPUT OUT.png`.
//!
//! INPUT is an OBJ model, a scene file or the name of a built-in scene. This is what the program's `render`
//! command does, without its options: open, render pass by pass, encode, write.
#![expect(clippy::print_stdout, reason = "an example shows its results")]

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;

use reliefscope::render::{Progressive, Snapshot};
use reliefscope::scene::load::LoadOptions;
use reliefscope::scene::{open, save_picture::write_png};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let input = arguments.next().unwrap_or_else(|| "wall".into());
    let output = arguments.next().unwrap_or_else(|| "scene.png".into());

    let loaded = open(&input, &LoadOptions::default())?;
    for warning in &loaded.warnings {
        println!("{warning}");
    }
    let size = loaded.size.unwrap_or([640, 360]);

    // A snapshot is everything that a picture depends on; the same snapshot gives the same bytes.
    let mut renderer = Progressive::new(0)?;
    renderer.start(Snapshot {
        scene: loaded.scene,
        settings: Arc::new(loaded.settings),
        size,
    });
    let never_stop = || false;
    while !renderer.is_converged() {
        renderer.pass(&never_stop);
    }

    let mut rgba = vec![[0; 4]; size[0] as usize * size[1] as usize];
    renderer.encode_into(loaded.display.exposure_ev, &mut rgba);
    let rgb: Vec<[u8; 3]> = rgba.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
    write_png(&output, size, &rgb)?;
    println!(
        "{}: {} samples per pixel, {} rays",
        output.display(),
        renderer.samples(),
        renderer.counters().rays()
    );
    Ok(())
}
