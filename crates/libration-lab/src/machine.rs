//! Where a run took place.

use serde::Serialize;

/// The machine and the build, as far as they bear on results.
#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    /// Processor, as it names itself.
    pub cpu: String,
    /// Logical cores that this process may use.
    pub cores: usize,
    /// Operating system and architecture, as in `linux x86_64`.
    pub platform: String,
    /// Version of Libration.
    pub version: &'static str,
}

impl Machine {
    /// Looks at this machine.
    pub fn detect() -> Self {
        Machine {
            cpu: cpu_name().unwrap_or_else(|| "unknown".into()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            platform: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}

/// The `model name` that Linux reports.
fn cpu_name() -> Option<String> {
    let info = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = info.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// There is not memory enough.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("{:.1} GB of memory are needed, of which {:.1} GB are available", gigabytes(*needed), gigabytes(u128::from(*available)))]
pub struct NoRoom {
    /// Bytes that are needed.
    pub needed: u128,
    /// Bytes that can be had without swapping.
    pub available: u64,
}

fn gigabytes(bytes: u128) -> f64 {
    bytes as f64 / 1e9
}

/// Whether so many bytes can be had without swapping; also where the system does not tell.
///
/// # Errors
/// [`NoRoom`] if not.
pub(crate) fn has_room(needed: u128) -> Result<(), NoRoom> {
    match available_memory() {
        Some(available) if needed > u128::from(available) => Err(NoRoom { needed, available }),
        _ => Ok(()),
    }
}

/// The `MemAvailable` that Linux reports, in bytes.
fn available_memory() -> Option<u64> {
    let info = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = info.lines().find(|line| line.starts_with("MemAvailable:"))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes * 1024)
}
