//! What the times were taken on, and with which program.

use crate::geometry::simd::{SimdLevel, simd_level};

/// Everything that a time depends on besides the work.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    /// The processor's own name, where the system tells it.
    pub cpu: Option<String>,
    /// Threads that it runs at once.
    pub cores: usize,
    /// Vector instructions of the trees that are built.
    pub level: SimdLevel,
    /// Version of this program.
    pub version: &'static str,
    /// Its commit, if `RELIEFSCOPE_COMMIT` named one when it was built.
    pub commit: Option<&'static str>,
}

impl Machine {
    /// This one.
    #[must_use]
    pub fn this() -> Self {
        let processors = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let name = processors
            .lines()
            .find_map(|line| line.strip_prefix("model name")?.split_once(':'));
        Self {
            cpu: name.map(|(_, name)| name.trim().to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            level: simd_level(),
            version: env!("CARGO_PKG_VERSION"),
            commit: option_env!("RELIEFSCOPE_COMMIT"),
        }
    }
}
