//! What may be typed. Only the parser reads these; commands take the checked `options`.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};

use super::bench::BenchArgs;
use super::help;
use super::measure::MeasureArgs;
use super::stability::StabilityArgs;
use crate::scene::View;
use crate::scene::file::check_size;
use crate::surface::mapping::Method;

/// Most worker threads that can be asked for.
pub(super) const MAX_THREADS: i64 = 1024;

/// What a surface map really does to a picture.
#[derive(Debug, Parser)]
#[command(
    name = "reliefscope",
    version,
    about = help::ABOUT,
    after_help = help::SHORT,
    after_long_help = help::overview(),
    args_conflicts_with_subcommands = true,
    disable_help_subcommand = true
)]
pub(super) struct Arguments {
    /// What to do; without one, a window opens.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The window's own arguments.
    #[command(flatten)]
    pub view: ViewArgs,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Open a window (what happens without a command, too)
    View(ViewArgs),
    /// Render a picture without a window
    #[command(after_help = help::RENDER_EXAMPLES, after_long_help = help::render_details())]
    Render(RenderArgs),
    /// Say what an input holds: counts, materials, maps, warnings
    #[command(after_help = help::INSPECT_EXAMPLES)]
    Inspect(InspectArgs),
    /// Tell the whole story of one pixel
    #[command(after_help = help::PROBE_EXAMPLES, after_long_help = help::probe_details())]
    Probe(ProbeArgs),
    /// Time frames, rays and their growth; write and race files of rays
    #[command(after_help = help::BENCH_EXAMPLES, after_long_help = help::bench_details())]
    Bench(BenchArgs),
    /// Test the program where numbers are very large, very small or very slanted
    #[command(after_help = help::STABILITY_EXAMPLES, after_long_help = help::stability_details())]
    Stability(StabilityArgs),
    /// Measure what accuracy costs: every method on a model, from many angles, against the truth
    #[command(after_help = help::MEASURE_EXAMPLES, after_long_help = help::measure_details())]
    Measure(MeasureArgs),
    /// List the ways of perturbing a surface
    Methods,
    /// List the built-in scenes
    Scenes,
}

/// How an input is read.
#[derive(Debug, Args)]
pub(super) struct LoadArgs {
    /// Keep a model's own coordinates while tracing, instead of centring it and scaling it by a power of two
    #[arg(long)]
    pub no_normalize: bool,
}

/// `view`.
#[derive(Debug, Args)]
pub(super) struct ViewArgs {
    /// OBJ model, scene file (.toml) or name of a built-in scene
    #[arg(value_name = "INPUT")]
    pub input: Option<PathBuf>,
    /// Worker threads; 0 means one per core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads_parser())]
    pub threads: u16,
    /// Reading
    #[command(flatten)]
    pub load: LoadArgs,
}

/// What `render` and `probe` change about a scene.
#[derive(Debug, Args)]
pub(super) struct SceneArgs {
    /// OBJ model, scene file (.toml) or name of a built-in scene
    #[arg(value_name = "INPUT")]
    pub input: PathBuf,
    /// Picture size in pixels [default: the scene's, or 1280x720]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Way of perturbing surfaces [default: the scene's]
    #[arg(long, value_name = "NAME", value_parser = method_parser())]
    pub method: Option<Method>,
    /// Set a key of the scene file; may be repeated, later ones win
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_set)]
    pub set: Vec<(String, String)>,
    /// Reading
    #[command(flatten)]
    pub load: LoadArgs,
}

/// `render`.
#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    /// Scene and changes to it
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Picture to write: .png (sRGB, as the window shows it) or .exr (linear, without exposure)
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Samples per pixel [default: the scene's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub samples: Option<u32>,
    /// Worker threads; 0 means one per core. The picture does not depend on it
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads_parser())]
    pub threads: u16,
    /// Show this of the pixels in a PNG in place of the picture, or over it [default: the scene's]
    #[arg(long, value_name = "NAME", value_parser = view_parser())]
    pub view: Option<View>,
    /// Exposure of a PNG in stops [default: the scene's]
    #[arg(long, value_name = "EV", allow_hyphen_values = true, value_parser = parse_exposure)]
    pub exposure: Option<f32>,
}

/// `inspect`.
#[derive(Debug, Args)]
pub(super) struct InspectArgs {
    /// OBJ model, scene file (.toml) or name of a built-in scene
    #[arg(value_name = "INPUT")]
    pub input: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// Reading
    #[command(flatten)]
    pub load: LoadArgs,
}

/// `probe`.
#[derive(Debug, Args)]
pub(super) struct ProbeArgs {
    /// Scene and changes to it
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Column and row, from 0 at the top left
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel)]
    pub pixel: [u32; 2],
    /// Draw the cut through the relief along the pixel's view ray, with every method on it
    #[arg(long, value_name = "FILE.svg", conflicts_with = "json")]
    pub svg: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

pub(super) fn threads_parser() -> clap::builder::RangedI64ValueParser<u16> {
    clap::value_parser!(u16).range(0..=MAX_THREADS)
}

pub(super) fn method_parser() -> impl TypedValueParser<Value = Method> {
    PossibleValuesParser::new(Method::ALL.map(Method::name))
        .try_map(|name| Method::from_name(&name).ok_or("no such method"))
}

fn view_parser() -> impl TypedValueParser<Value = View> {
    PossibleValuesParser::new(View::ALL.map(View::name))
        .try_map(|name| View::from_name(&name).ok_or("no such view"))
}

fn pair(text: &str, separators: &[char]) -> Option<[u32; 2]> {
    let (a, b) = text.split_once(separators)?;
    Some([a.trim().parse().ok()?, b.trim().parse().ok()?])
}

pub(super) fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let size = pair(text, &['x', 'X', '×']).ok_or("a size is columns x rows, such as 1280x720")?;
    check_size(size).map_err(|why| format!("a size {why}"))?;
    Ok(size)
}

fn parse_pixel(text: &str) -> Result<[u32; 2], String> {
    pair(text, &[',']).ok_or_else(|| "a pixel is column,row, such as 640,360".to_owned())
}

pub(super) fn parse_set(text: &str) -> Result<(String, String), String> {
    text.split_once('=')
        .map(|(key, value)| (key.trim().to_owned(), value.trim().to_owned()))
        .ok_or_else(|| "an assignment is KEY=VALUE, such as camera.vfov_deg=30".to_owned())
}

fn parse_exposure(text: &str) -> Result<f32, String> {
    let stops = text.parse::<f32>().ok();
    stops
        .filter(|ev| (-32.0..=32.0).contains(ev))
        .ok_or_else(|| "an exposure is a number of stops from -32 to 32".to_owned())
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn the_parser_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn sizes_and_pixels() {
        assert_eq!(parse_size("1280x720"), Ok([1280, 720]));
        assert_eq!(parse_size("3×2"), Ok([3, 2]));
        for bad in ["1280", "0x4", "ax4", "4x-1", "70000x1", "65536x65536", ""] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
        assert_eq!(parse_pixel("1, 2"), Ok([1, 2]));
        assert!(parse_pixel("1x2").is_err());
        assert_eq!(parse_exposure("-1.5"), Ok(-1.5));
        assert!(parse_exposure("nan").is_err());
    }
}
