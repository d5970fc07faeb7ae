//! Whether what is being made is still wanted.

use std::fmt;

/// A question that slow work asks now and then; the answer never goes back to no.
#[derive(Clone, Copy, Default)]
pub struct Stop<'a>(Option<&'a (dyn Fn() -> bool + Sync)>);

impl<'a> Stop<'a> {
    /// Asks `stop`.
    #[must_use]
    pub const fn when(stop: &'a (dyn Fn() -> bool + Sync)) -> Self {
        Self(Some(stop))
    }

    /// Whether to leave off. What was being made then is not to be used.
    #[must_use]
    pub fn now(self) -> bool {
        self.0.is_some_and(|stop| stop())
    }
}

impl fmt::Debug for Stop<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Stop" } else { "Never" })
    }
}
