//! The progress bar of `render` and `measure`, on a terminal only.

use std::io::IsTerminal as _;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar that counts what is done; silent where standard error is no terminal.
pub(super) struct Progress(ProgressBar);

impl Progress {
    /// A bar from 0 to so many samples per pixel.
    pub fn new(samples: u32) -> Self {
        Self::counting(u64::from(samples), "samples")
    }

    /// A bar from 0 to `count` of whatever `things` says.
    pub fn counting(count: u64, things: &str) -> Self {
        if !std::io::stderr().is_terminal() {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::with_draw_target(Some(count), ProgressDrawTarget::stderr());
        let style =
            format!("{{wide_bar}} {{pos}}/{{len}} {things}, {{elapsed}} gone, {{eta}} to go");
        // A bad template is a bug that shows at once; the plain style will do instead of a panic.
        bar.set_style(
            ProgressStyle::with_template(&style).unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        bar.tick();
        Self(bar)
    }

    /// This many are done.
    pub fn reached(&self, count: u64) {
        self.0.set_position(count);
    }

    /// There are this many.
    pub fn of(&self, count: u64) {
        self.0.set_length(count);
    }

    /// Does something while the bar is out of the way, such as writing a line.
    pub fn aside<T>(&self, work: impl FnOnce() -> T) -> T {
        self.0.suspend(work)
    }

    /// Takes the bar away.
    pub fn finish(self) {
        self.0.finish_and_clear();
    }
}
