//! Arguments → command → exit code.
fn main() -> std::process::ExitCode {
    let options = reliefscope::viewer::ViewOptions {
        input: std::env::args_os().nth(1).map(Into::into),
        threads: 0,
        normalize: true,
    };
    match reliefscope::viewer::run(options) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("reliefscope: {error}");
            std::process::ExitCode::from(2)
        }
    }
}
