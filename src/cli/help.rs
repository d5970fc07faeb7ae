//! What `--help` teaches beyond the list of options.

use std::fmt::Write as _;

use crate::scene::View;
use crate::scene::built_in::SCENES;
use crate::surface::mapping::Method;

/// The first line.
pub(super) const ABOUT: &str =
    "Ray traces models and shows what bump, normal and parallax mapping really do to a picture";

/// Behind `-h`.
pub(super) const SHORT: &str = "\
Examples:
  reliefscope                          a window with a built-in scene
  reliefscope model.obj                a window with a model
  reliefscope render wall -o wall.png  a picture without a window

`reliefscope --help` says more.";

const EXAMPLES: &str = "\
Examples:
  reliefscope
      opens a window with a built-in scene
  reliefscope model.obj
      opens a window with a model; a scene file (.toml) or a built-in name will do as well
  reliefscope render wall -o wall.png --method parallax --samples 64
      renders a built-in scene, with another method than its own
  reliefscope render scene.toml -o out.exr --set light.0.intensity=3 --set material.brick.ks=[0.2,0.2,0.2]
      renders a scene file with some of its keys changed; linear values
  reliefscope inspect model.obj
      says what was found in a model, and what was doubtful about it
  reliefscope probe scene.toml --pixel 320,180
      tells every step from one pixel's ray to its colour
  reliefscope bench --quick
      times frames and rays on this machine
  reliefscope stability
      tests the program where numbers are extreme
  reliefscope measure wall --quick --report trade
      measures what accuracy costs on a model, and writes a page about it";

const EXIT_CODES: &str = "\
Exit codes:
  0  good
  1  a measured threshold failed, or an answer was wrong
  2  could not run: bad arguments, unreadable input, no display

Warnings about an input go to stderr as FILE:LINE: MESSAGE; answers go to stdout.
Scene files, and all keys for --set, are explained in docs/scene.md.";

/// Behind `render -h`.
pub(super) const RENDER_EXAMPLES: &str = "\
Examples:
  reliefscope render wall -o wall.png
  reliefscope render model.obj -o model.png --size 640x480 --samples 16
  reliefscope render scene.toml -o scene.exr --set camera.vfov_deg=30
  reliefscope render wall -o steps.png --method exact --view steps";

/// Behind `inspect -h`.
pub(super) const INSPECT_EXAMPLES: &str = "\
Examples:
  reliefscope inspect model.obj
  reliefscope inspect scene.toml --json | jq '.materials[].name'

Lengths and areas are in the model's own units. `triangles` counts what the file says; those
without area are also counted as `degenerate` and are not traced.";

/// Behind `probe -h`.
pub(super) const PROBE_EXAMPLES: &str = "\
Examples:
  reliefscope probe wall --pixel 640,360
  reliefscope probe wall --pixel 640,360 --method parallax --svg cut.svg
  reliefscope probe scene.toml --size 320x180 --pixel 10,20 --method parallax --json";

/// Behind `bench -h`.
pub(super) const BENCH_EXAMPLES: &str = "\
Examples:
  reliefscope bench --quick
  reliefscope bench wall scene.toml --threads 1,8 --json
  reliefscope bench model.obj --kind camera --dump-rays camera.rays
  reliefscope bench --rays camera.rays --hits camera.hits";

const BENCH: &str = "\
Each answer is checked before it is timed: rays traced together find what each finds alone, vector
code gives the picture of scalar code, re-shading gives the picture of rendering afresh, all to the
bit. If one is wrong the exit code is 1. Times are medians, with the least and the greatest.

The table has four parts:
  frame    for every scene and method: taking a new snapshot, preview of one pixel in four, one
           sample of each pixel, the same from known hits after a light has changed, encoding
  scaling  one sample of each pixel with each number of threads
  rays     millions of rays a second by kind: camera, point-shadow, sun-shadow, mirror
  growth   one sample of each pixel against triangles, lights, mirror bounces, picture size

A file of rays holds the triangles in the units in which they are traced (a model is centred and
scaled by a power of two unless --no-normalize), and a place for each pixel whether it sends a ray
or not. Holes of cut-out maps count as solid. docs/performance.md says more, and the format.";

/// Behind `stability -h`.
pub(super) const STABILITY_EXAMPLES: &str = "\
Examples:
  reliefscope stability
  reliefscope stability --full --json > matrix.json
  reliefscope stability watertight sphere --kernel moller-trumbore
  reliefscope stability contact --offset-rule fixed";

const STABILITY: &str = "\
Each line is a test: `ok` or `SHORT`, its name, the figure, its bar, and how many rays or pixels
it looked at. `--` marks figures that are reported without a bar. The exit code is 1 if any test
falls short, 2 if it could not run.

The families:
  watertight  rays from inside closed meshes at edges and vertices, plain and displaced: how many
              get out. With RELIEFSCOPE_MODELS=DIR closed scans of that folder, too
  borders     rays a few units in the last place beside borders: how many answers differ from f64
  accuracy    distances, weights, points, texture coordinates, normals: the worst error
  contact     rays leaving a convex body: how many it stops itself, and how far away they start
  convex      pictures of a convex body: how many pixels shadows change
  terminator  coarse meshes with smooth normals: dark pixels that face the sun, light inside
  sweep       a camera that crosses one pixel: how much longer pixels travel in finer steps
  methods     every method at every angle and amplitude: pixels without a colour, and steps
  maps        maps of all sizes, depths and contents: pixels without a colour
  shading     exponents, lamps in impossible places, mirrors face to face
  faces       charts without area, normals without length, triangles without sense

All vector instructions of the machine must give the same bits throughout. --kernel and
--offset-rule replace the program's own by those of textbooks in `watertight`, `borders`,
`accuracy` and `contact`, to show what they would do; pictures are always the program's own.
docs/stability.md says more.";

/// Behind `stability --help`.
pub(super) fn stability_details() -> String {
    format!("{STABILITY_EXAMPLES}\n\n{STABILITY}")
}

/// Behind `measure -h`.
pub(super) const MEASURE_EXAMPLES: &str = "\
Examples:
  reliefscope measure wall --quick
  reliefscope measure model.obj --report trade
  reliefscope measure scene.toml --angles 0,45,75 --methods relief,exact --json
  reliefscope measure model.obj --shard 2/8 --report part2
  reliefscope measure --merge part*/measure.json --report whole";

const MEASURE: &str = "\
The camera turns around the place that the middle of the picture sees, from 0 to 89 degrees off the
surface's normal. In each view every method is measured by every parameter:
  where rays land   texture coordinate in texels, depth over amplitude, normal in degrees: rms, p50,
                    p95, share above one texel; lights that reach one place and not the other
  how it looks      linear RMSE, PSNR, SSIM and FLIP to a picture of the truth, which has twice the
                    samples and knows how far its own halves are apart
  what it takes     look-ups, steps and rays for each sample, which are exact; then times, the methods
                    taking turns, as medians with the least and the greatest
The truth is the bilinear relief walked in double precision. Errors and counts are the same to the bit
for the same seed, on any number of threads and split into any shards; times are not.

--report writes index.html, measure.csv and measure.json into a folder. Ctrl-C finishes the cell at
hand, writes what there is, marked as partial, and exits with 2. docs/measuring.md says more.";

/// Behind `measure --help`.
pub(super) fn measure_details() -> String {
    format!("{MEASURE_EXAMPLES}\n\n{MEASURE}")
}

/// Behind `--help`: examples, methods, scenes, exit codes.
pub(super) fn overview() -> String {
    format!("{EXAMPLES}\n\n{}\n{}\n{EXIT_CODES}", methods(), scenes())
}

/// Behind `render --help`.
pub(super) fn render_details() -> String {
    format!("{RENDER_EXAMPLES}\n\n{SET}\n\n{}\n{}", views(), methods())
}

/// Behind `probe --help`.
pub(super) fn probe_details() -> String {
    format!("{PROBE_EXAMPLES}\n\n{SET}\n\n{}", methods())
}

/// Behind `bench --help`.
pub(super) fn bench_details() -> String {
    format!("{BENCH_EXAMPLES}\n\n{BENCH}")
}

const SET: &str = "\
Keys for --set are paths through the scene file, whatever INPUT is:
  camera.vfov_deg=30                 a key of a table
  light.0.intensity=3                of the first light; a light's name will do as well
  material.brick.ks=[0.2,0.2,0.2]    of a material by name; `*` means every material
  material.brick.map.height.gain=2   of a material's map by role or number
  shading.background=[0.1,0.1,0.2]
A value is TOML; a word needs no quotes. docs/scene.md lists every key with units and ranges.";

/// The one list of views.
fn views() -> String {
    let mut text = String::from("Views:\n");
    for view in View::ALL {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {:<18}{}", view.name(), view.meaning());
    }
    text
}

/// The one list of methods.
pub(super) fn methods() -> String {
    let mut text = String::from("Methods:\n");
    for method in Method::ALL {
        let info = method.info();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {:<18}{}", info.name, info.summary);
    }
    text
}

/// The one list of built-in scenes.
pub(super) fn scenes() -> String {
    let mut text = String::from("Built-in scenes:\n");
    for scene in SCENES {
        let _ = writeln!(text, "  {:<18}{}", scene.name, scene.summary);
    }
    text
}
