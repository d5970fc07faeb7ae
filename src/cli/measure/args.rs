//! What may be typed after `measure`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::args::{LoadArgs, method_parser, parse_set, parse_size, threads_parser};
use crate::measure::trade::Shard;
use crate::surface::mapping::Method;

/// `measure`.
#[derive(Debug, Args)]
pub(in crate::cli) struct MeasureArgs {
    /// OBJ model, scene file (.toml) or name of a built-in scene
    #[arg(value_name = "INPUT", required_unless_present = "merge")]
    pub input: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// Write index.html, measure.csv and measure.json into this folder
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Fewer angles, parameters and samples: a few minutes
    #[arg(long)]
    pub quick: bool,
    /// Measure only part I of N
    #[arg(long, value_name = "I/N", value_parser = parse_shard)]
    pub shard: Option<Shard>,
    /// Join the measure.json files of shards instead of measuring
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["input", "quick", "shard", "threads", "seed", "angles", "amplitudes", "methods", "rays", "size", "samples", "most_samples", "passes", "set", "no_normalize"])]
    pub merge: Vec<PathBuf>,
    /// Worker threads; 0 means one per core. Only times depend on it
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads_parser())]
    pub threads: u16,
    /// Decides where the view rays lie
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u32,
    /// Angles of the views, degrees from the normal [default: 0,15,30,45,60,75,80,85,89]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse_angle)]
    pub angles: Vec<f64>,
    /// Factors on the amplitude [default: 0.5,1,2, or 1 with --quick]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse_factor)]
    pub amplitudes: Vec<f64>,
    /// Methods [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = method_parser())]
    pub methods: Vec<Method>,
    /// View rays of a view [default: 4000, or 2000 with --quick]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub rays: Option<u32>,
    /// Size of the pictures in pixels [default: 320x180, or 256x144 with --quick]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Samples per pixel of a picture, twice as many of its reference [default: 64, or 16 with --quick]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1 << 16))]
    pub samples: Option<u32>,
    /// Most samples per pixel of pictures whose errors fewer do not tell [default: 16 times as many, or 4 times with --quick]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1 << 20))]
    pub most_samples: Option<u32>,
    /// Frames that are timed, after one that warms up [default: 7, or 5 with --quick]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub passes: Option<u32>,
    /// Set a key of the scene file; may be repeated, later ones win
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_set)]
    pub set: Vec<(String, String)>,
    /// Reading
    #[command(flatten)]
    pub load: LoadArgs,
}

fn parse_shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/');
    let numbers = parts.and_then(|(i, n)| Some((i.trim().parse().ok()?, n.trim().parse().ok()?)));
    numbers
        .map(|(index, count)| Shard { index, count })
        .filter(|s| s.index >= 1 && s.index <= s.count)
        .ok_or_else(|| "a shard is I/N with I from 1 to N, such as 2/8".to_owned())
}

fn parse_angle(text: &str) -> Result<f64, String> {
    let angle = text.trim().parse().ok();
    angle
        .filter(|a| (0.0..=89.0).contains(a))
        .ok_or_else(|| "an angle is a number of degrees from 0 to 89".to_owned())
}

fn parse_factor(text: &str) -> Result<f64, String> {
    let factor = text.trim().parse::<f64>().ok();
    factor
        .filter(|f| *f > 0.0 && *f <= 1e6)
        .ok_or_else(|| "a factor is a number above 0, a million at most".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_angles_and_factors() {
        assert_eq!(parse_shard("2/8"), Ok(Shard { index: 2, count: 8 }));
        for bad in ["", "1", "0/3", "4/3", "a/b", "1/0", "-1/2"] {
            assert!(parse_shard(bad).is_err(), "{bad}");
        }
        assert_eq!(parse_angle("89"), Ok(89.0));
        for bad in ["90", "-1", "nan", "x"] {
            assert!(parse_angle(bad).is_err(), "{bad}");
        }
        assert_eq!(parse_factor("0.5"), Ok(0.5));
        for bad in ["0", "-1", "inf", "nan"] {
            assert!(parse_factor(bad).is_err(), "{bad}");
        }
    }
}
