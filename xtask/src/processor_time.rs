//! Processor time of programs: unlike their duration it does not depend on what else the machine does.

use std::process::Child;
use std::time::{Duration, Instant};
use std::{fs, thread};

/// Fields of `/proc/PID/stat` behind the name of the program: proc(5).
const STATE: usize = 0;
const USER: usize = 11;
const CHILDREN_SYSTEM: usize = 14;

/// Ticks of the fields per second, the same on each architecture on which Linux runs.
const TICKS: u64 = 100;

/// Time between two looks at a program that is about to end.
const PAUSE: Duration = Duration::from_millis(5);

/// Processor time of all programs that this one has run to their end; zero where the system does not tell.
pub(crate) fn of_children() -> Duration {
    let text = stat("self").unwrap_or_default();
    fields(&text)
        .map_or(Duration::ZERO, |fields| ticks(&fields[CHILDREN_SYSTEM - 1..=CHILDREN_SYSTEM]))
}

/// Waits until a program ends, and returns its processor time and that of its children; none if it still runs at `deadline`.
///
/// Where the system does not tell, zero at once.
pub(crate) fn at_the_end_of(child: &Child, deadline: Instant) -> Option<Duration> {
    let process = child.id().to_string();
    while let Some(text) = stat(&process) {
        let Some(fields) = fields(&text) else { break };
        // It stays a zombie until this program waits for it.
        if fields[STATE] == "Z" {
            return Some(ticks(&fields[USER..=CHILDREN_SYSTEM]));
        }
        if Instant::now() > deadline {
            return None;
        }
        thread::sleep(PAUSE);
    }
    Some(Duration::ZERO)
}

fn stat(process: &str) -> Option<String> {
    fs::read_to_string(format!("/proc/{process}/stat")).ok()
}

/// The fields behind the name, which may contain blanks and parentheses.
fn fields(stat: &str) -> Option<Vec<&str>> {
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    (fields.len() > CHILDREN_SYSTEM).then_some(fields)
}

fn ticks(fields: &[&str]) -> Duration {
    let sum: u64 = fields.iter().filter_map(|field| field.parse::<u64>().ok()).sum();
    Duration::from_millis(sum * 1000 / TICKS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::LONGEST;

    #[test]
    fn times_are_the_fields_fourteen_to_seventeen() {
        let text = "7 (a b) c) Z 1 2 3 4 5 6 7 8 9 10 150 25 1000 20 20 0 1";
        let fields = fields(text).unwrap();
        assert_eq!(fields[STATE], "Z");
        assert_eq!(ticks(&fields[USER..=CHILDREN_SYSTEM]), Duration::from_millis(11_950));
        assert_eq!(super::fields("7 (a) Z 1"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_child_that_computes_has_a_time() {
        let before = of_children();
        let mut computing =
            crate::command::cargo("--list").stdout(std::process::Stdio::null()).spawn().unwrap();
        let of_child = at_the_end_of(&computing, Instant::now() + LONGEST).unwrap();
        assert!(computing.wait().unwrap().success());
        // Other tests run programs at the same time.
        assert!(of_children() - before >= of_child);
    }
}
