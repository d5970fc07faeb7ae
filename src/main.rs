//! Arguments → command → exit code.

use std::process::ExitCode;

use reliefscope::cli::{self, FeelRequest, FeltScene, ViewRequest, Windows};

fn main() -> ExitCode {
    cli::run(std::env::args_os(), &Viewer)
}

/// The window, if the program was built with it.
struct Viewer;

#[cfg(feature = "viewer")]
impl Windows for Viewer {
    fn show(&self, request: ViewRequest) -> Result<(), String> {
        use reliefscope::viewer::{ViewOptions, run};
        let options = ViewOptions {
            input: request.input,
            threads: request.threads,
            normalize: request.normalize,
        };
        run(options).map_err(|error| error.to_string())
    }

    fn feel(&self, request: FeelRequest) -> Result<Vec<FeltScene>, String> {
        use reliefscope::viewer::{FeelOptions, Felt, measure_feel};
        let felt = measure_feel(FeelOptions {
            scenes: request.scenes,
            threads: request.threads,
            size: request.size,
            seconds: request.seconds,
        });
        let scene = |felt: Felt| FeltScene {
            feel: felt.feel,
            size: felt.size,
            draw_p50_ms: felt.draw_p50_ms,
        };
        felt.map(|felt| felt.into_iter().map(scene).collect())
            .map_err(|error| error.to_string())
    }
}

#[cfg(not(feature = "viewer"))]
impl Windows for Viewer {
    fn show(&self, _: ViewRequest) -> Result<(), String> {
        Err(
            "this program was built without a window; `reliefscope render` makes pictures"
                .to_owned(),
        )
    }

    fn feel(&self, _: FeelRequest) -> Result<Vec<FeltScene>, String> {
        Err("this program was built without a window, so there is nothing to feel".to_owned())
    }
}
