//! The machine of a run.

use libration::ensemble::{InstructionSet, installed_memory};
use serde::Serialize;

/// The machine and the build, as far as they affect results.
#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    /// Name of the processor.
    pub cpu: String,
    /// Number of logical cores available to this process.
    pub cores: usize,
    /// Operating system and architecture, as in `linux x86_64`.
    pub platform: String,
    /// Version of Libration.
    pub version: &'static str,
    /// Version of the compiler, as in `rustc 1.95.0`.
    pub compiler: &'static str,
    /// Instruction sets of the processor with kernels.
    pub instruction_sets: Vec<&'static str>,
    /// Data caches of the first core, in the order of their level.
    pub caches: Vec<Cache>,
    /// Memory in bytes, if known.
    pub memory: Option<u64>,
}

/// A data cache.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Cache {
    /// Level, from 1.
    pub level: u32,
    /// Size in bytes.
    pub bytes: u64,
}

impl Machine {
    /// Detects the current machine.
    pub fn detect() -> Self {
        Machine {
            cpu: cpu_name().unwrap_or_else(|| "unknown".into()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            platform: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            version: env!("CARGO_PKG_VERSION"),
            compiler: env!("LIBRATION_COMPILER"),
            instruction_sets: InstructionSet::available().map(InstructionSet::name).collect(),
            caches: caches(),
            memory: installed_memory(),
        }
    }
}

/// Returns the data caches of the first core, on Linux.
fn caches() -> Vec<Cache> {
    let folder = |index: u32| format!("/sys/devices/system/cpu/cpu0/cache/index{index}");
    let mut caches: Vec<Cache> = (0..8).filter_map(|index| cache(&folder(index))).collect();
    caches.sort_by_key(|cache| cache.level);
    caches
}

/// Returns the cache that a system folder describes, unless it is an instruction cache.
fn cache(folder: &str) -> Option<Cache> {
    let read = |name: &str| std::fs::read_to_string(format!("{folder}/{name}")).ok();
    if read("type")?.trim() == "Instruction" {
        return None;
    }
    let size = read("size")?;
    let size = size.trim();
    let (digits, unit) = size.split_at(size.find(|c: char| !c.is_ascii_digit())?);
    let unit = match unit {
        "K" => 1 << 10,
        "M" => 1 << 20,
        _ => return None,
    };
    Some(Cache {
        level: read("level")?.trim().parse().ok()?,
        bytes: digits.parse::<u64>().ok()? * unit,
    })
}

/// Returns the `model name` of Linux.
fn cpu_name() -> Option<String> {
    let info = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = info.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}
