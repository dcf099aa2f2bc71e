//! Verdict on instruction counts.

use super::kernel::Kernel;
use super::record::Recorded;
use crate::Outcome;

/// A rise that passes: what another order of the same instructions around the hot loop may cost.
const RISE: f64 = 0.02;

/// A kernel with its count, beside the recorded one.
pub(super) fn line(kernel: &Kernel, count: f64, recorded: Option<f64>) -> String {
    let name = kernel.to_string();
    match recorded {
        Some(before) => {
            // Without a minus before what rounds to zero.
            let change = (1000.0 * (count / before - 1.0)).round() / 10.0 + 0.0;
            format!("{name:<40}{count:>9.3}, recorded {before:>8.3} ({change:+.1} %)")
        }
        None => format!("{name:<40}{count:>9.3}"),
    }
}

/// Fails if a count has risen, or was never recorded.
pub(super) fn compare(recorded: &Recorded, counted: &Recorded) -> Outcome {
    let before = |name: &str| recorded.counts.iter().find(|(known, _)| known == name);
    let mut complaints: Vec<String> = Vec::new();
    for (name, count) in &counted.counts {
        match before(name) {
            None => complaints.push(format!("{name}: not recorded")),
            Some((_, before)) if *count > before * (1.0 + RISE) => complaints.push(format!(
                "{name}: {count:.3} instructions per trajectory and step, recorded {before:.3}"
            )),
            Some(_) => {}
        }
    }
    if complaints.is_empty() {
        return Ok(());
    }
    if recorded.compiler != counted.compiler {
        complaints.push(format!(
            "Counted with {}, recorded with {}: it may be the compiler’s doing.",
            counted.compiler, recorded.compiler
        ));
    }
    complaints
        .push("Where the rise is meant, record it: `cargo xtask instructions --record`".into());
    Err(complaints.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recorded(compiler: &str, count: f64) -> Recorded {
        let counts = vec![("oscillator rk4 f64".to_owned(), count)];
        Recorded { compiler: compiler.to_owned(), counts }
    }

    #[test]
    fn a_rise_of_more_than_two_per_cent_fails_and_names_the_kernel() {
        let before = recorded("rustc 1", 10.0);
        for count in [5.0, 10.0, 10.19] {
            assert_eq!(compare(&before, &recorded("rustc 1", count)), Ok(()));
        }
        let complaint = compare(&before, &recorded("rustc 1", 10.21)).unwrap_err();
        assert!(complaint.starts_with("oscillator rk4 f64: 10.210 instructions"), "{complaint}");
        assert!(!complaint.contains("compiler"));
    }

    #[test]
    fn another_compiler_is_named_where_a_count_has_risen() {
        let complaint =
            compare(&recorded("rustc 1", 10.0), &recorded("rustc 2", 11.0)).unwrap_err();
        assert!(complaint.contains("with rustc 2, recorded with rustc 1"), "{complaint}");
    }

    #[test]
    fn a_kernel_that_was_never_recorded_fails() {
        let nothing = Recorded { compiler: "rustc 1".to_owned(), counts: Vec::new() };
        let complaint = compare(&nothing, &recorded("rustc 1", 1.0)).unwrap_err();
        assert!(complaint.starts_with("oscillator rk4 f64: not recorded"), "{complaint}");
    }
}
