//! Available memory.

use memmap2::MmapMut;
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// Error of insufficient memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{} GB of memory are needed, {}: take fewer at a time, or a shorter float", gigabytes(*needed), self.there_is())]
pub struct InsufficientMemory {
    /// Bytes that are needed.
    pub needed: u128,
    /// Bytes available without swapping, if the system reports them.
    pub available: Option<u64>,
}

impl InsufficientMemory {
    /// Checks that `needed` bytes are available without swapping and within the limits of this process (`ulimit -v`). It succeeds
    /// if the system does not report its memory.
    ///
    /// # Errors
    /// If they are not.
    pub fn check(needed: u128) -> Result<(), InsufficientMemory> {
        let available = available_memory().filter(|&available| needed > u128::from(available));
        let least = if is_mappable(needed) { None } else { Some(largest_mapping(needed)) };
        let limits = [available, least].into_iter().flatten();
        limits.min().map_or(Ok(()), |available| {
            Err(InsufficientMemory { needed, available: Some(available) })
        })
    }

    /// Whether more is needed than this machine has, so that no limit or other process is the reason.
    pub fn is_beyond_machine(&self) -> bool {
        installed_memory().is_none_or(|installed| self.needed > u128::from(installed))
    }

    fn there_is(&self) -> String {
        match self.available {
            Some(bytes) => format!("of which {} GB are available", gigabytes(u128::from(bytes))),
            None => "which the system does not give".to_owned(),
        }
    }
}

/// Gigabytes, with more digits for small numbers.
fn gigabytes(bytes: u128) -> String {
    let gigabytes = bytes as f64 / 1e9;
    if gigabytes < 1.0 { format!("{gigabytes:.3}") } else { format!("{gigabytes:.1}") }
}

/// Whether the system gives so many bytes of addresses to this process. They are given back untouched, which takes microseconds.
fn is_mappable(bytes: u128) -> bool {
    let len = usize::try_from(bytes).ok().filter(|&len| len < isize::MAX as usize);
    bytes == 0 || len.is_some_and(|len| MmapMut::map_anon(len).is_ok())
}

/// The most bytes that it gives of so many, to a thousandth.
fn largest_mapping(bytes: u128) -> u64 {
    let (mut given, mut refused) = (0, u64::try_from(bytes).unwrap_or(u64::MAX));
    while refused - given > refused / 1024 {
        let middle = given + (refused - given) / 2;
        if is_mappable(middle.into()) {
            given = middle
        } else {
            refused = middle
        }
        if refused < 1024 {
            break;
        }
    }
    given
}

/// Bytes available to this process without swapping, within the limit of its container; none if the system does not report
/// them.
pub fn available_memory() -> Option<u64> {
    let system = system()?;
    // Files that the container keeps in memory can be dropped.
    let left = system.cgroup_limits().map(|limits| limits.total_memory.saturating_sub(limits.rss));
    known(system.available_memory()).map(|bytes| bytes.min(left.unwrap_or(bytes)))
}

/// Bytes of memory in this machine; none if the system does not report them.
pub fn installed_memory() -> Option<u64> {
    known(system()?.total_memory())
}

fn known(bytes: u64) -> Option<u64> {
    (bytes > 0).then_some(bytes)
}

fn system() -> Option<System> {
    let memory = MemoryRefreshKind::nothing().with_ram();
    System::new_with_specifics(RefreshKind::nothing().with_memory(memory)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused_with_both_figures_and_a_way_out() {
        let Some(available) = available_memory() else { return };
        assert_eq!(InsufficientMemory::check(0), Ok(()));
        let refused = InsufficientMemory::check(1 << 60).expect_err("nobody has an exbibyte");
        assert!(refused.available.is_some_and(|there_is| there_is >= available / 2));
        let text =
            InsufficientMemory { needed: 8_000_000_000, available: Some(250_000_000) }.to_string();
        assert_eq!(
            text,
            "8.0 GB of memory are needed, of which 0.250 GB are available: take fewer at a time, or a \
             shorter float"
        );
    }
}
