//! What may be typed after `bench`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::cli::args::{LoadArgs, MAX_THREADS, parse_set, parse_size};
use crate::geometry::simd::SimdLevel;
use crate::render::RayKind;

/// `bench`.
#[derive(Debug, Args)]
pub(in crate::cli) struct BenchArgs {
    /// OBJ models, scene files (.toml) or names of built-in scenes [default: all built-in scenes]
    #[arg(value_name = "INPUT")]
    pub inputs: Vec<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// Fewer scenes, smaller meshes, three passes: minutes become seconds
    #[arg(long)]
    pub quick: bool,
    /// Numbers of worker threads [default: 1 and one per core]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=MAX_THREADS))]
    pub threads: Vec<u16>,
    /// Vector instructions to use [default: the best of this machine]
    #[arg(long, value_name = "LEVEL", value_parser = level_parser())]
    pub level: Option<SimdLevel>,
    /// Passes that are timed, after one that warms up [default: 7, or 3 with --quick]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub passes: Option<u16>,
    /// Picture size in pixels [default: 1280x720]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Set a key of every INPUT's scene file; may be repeated, later ones win
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_set)]
    pub set: Vec<(String, String)>,
    /// Write the triangles of INPUT and the rays of this kind...
    #[arg(long, value_name = "KIND", requires = "dump_rays", value_parser = kind_parser())]
    pub kind: Option<RayKind>,
    /// ...into this file
    #[arg(long, value_name = "FILE", requires = "kind", conflicts_with_all = ["json", "quick", "threads", "passes"])]
    pub dump_rays: Option<PathBuf>,
    /// Time the rays of this file instead of pictures
    #[arg(long, value_name = "FILE", conflicts_with_all = ["inputs", "quick", "size", "set", "kind", "dump_rays", "no_normalize"])]
    pub rays: Option<PathBuf>,
    /// Write what the rays of --rays hit
    #[arg(long, value_name = "FILE", requires = "rays")]
    pub hits: Option<PathBuf>,
    /// Drag the camera in a window, and tell how that feels, instead of timing pictures
    #[arg(long, conflicts_with_all = ["quick", "passes", "kind", "dump_rays", "rays", "hits"])]
    pub feel: bool,
    /// How long to drag in each scene
    #[arg(long, value_name = "SECONDS", requires = "feel", default_value_t = 6, value_parser = clap::value_parser!(u16).range(1..=600))]
    pub seconds: u16,
    /// Reading
    #[command(flatten)]
    pub load: LoadArgs,
}

fn level_parser() -> impl TypedValueParser<Value = SimdLevel> {
    PossibleValuesParser::new(SimdLevel::ALL.map(SimdLevel::name))
        .try_map(|name| SimdLevel::from_name(&name).ok_or("no such level"))
}

fn kind_parser() -> impl TypedValueParser<Value = RayKind> {
    PossibleValuesParser::new(RayKind::ALL.map(RayKind::name))
        .try_map(|name| RayKind::from_name(&name).ok_or("no such kind"))
}
