//! Page faults of memory at its first write.

use libration_study::StudyError;

/// An ordinary page.
pub(crate) const PAGE: usize = 4096;

/// The page faults of this process while `work` is done, if the system tells.
pub(crate) fn count_faults(
    work: impl FnOnce() -> Result<(), StudyError>,
) -> Result<Option<u64>, StudyError> {
    let before = faults_so_far();
    work()?;
    Ok(faults_so_far().zip(before).map(|(after, before)| after - before))
}

/// The minor faults of this process so far: the tenth entry of `/proc/self/stat`, counted from one.
fn faults_so_far() -> Option<u64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The second entry is a name in parentheses, which may hold blanks.
    let (_, rest) = stat.rsplit_once(')')?;
    rest.split_whitespace().nth(7)?.parse().ok()
}
