//! Arguments → command → exit code.

use std::process::ExitCode;

use reliefscope::cli::{self, ViewRequest};

fn main() -> ExitCode {
    cli::run(std::env::args_os(), open_window)
}

#[cfg(feature = "viewer")]
fn open_window(request: ViewRequest) -> Result<(), String> {
    use reliefscope::viewer::{ViewOptions, run};
    run(ViewOptions {
        input: request.input,
        threads: request.threads,
        normalize: request.normalize,
    })
    .map_err(|error| error.to_string())
}

#[cfg(not(feature = "viewer"))]
fn open_window(_request: ViewRequest) -> Result<(), String> {
    Err("this program was built without a window; `reliefscope render` makes pictures".to_owned())
}
