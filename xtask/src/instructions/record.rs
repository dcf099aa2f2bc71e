//! Recorded instruction counts.

use std::fmt;

use super::kernel::Kernel;

/// Instructions per trajectory and step, by the names of the kernel, and the compiler that chose them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Recorded {
    pub(super) compiler: String,
    pub(super) counts: Vec<(String, f64)>,
}

const HEADER: &str = "\
# Instructions per trajectory and step of the batch kernels with AVX2, as `cargo xtask instructions`
# counts them; with `--record` it writes this file anew.
";

impl Recorded {
    /// Parses a file of counts.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut recorded = Recorded { compiler: String::new(), counts: Vec::new() };
        for (i, line) in text.lines().enumerate() {
            if line.starts_with('#') || line.is_empty() {
                continue;
            }
            let unreadable = || format!("line {} of the recorded counts: `{line}`", i + 1);
            let (name, value) = line.rsplit_once(' ').ok_or_else(unreadable)?;
            match line.split_once(' ') {
                Some(("rustc", _)) => recorded.compiler = line.to_owned(),
                _ => {
                    let count = value.parse().map_err(|_| unreadable())?;
                    recorded.counts.push((name.trim_end().to_owned(), count));
                }
            }
        }
        Ok(recorded)
    }

    /// The count of `kernel`, if there is one.
    pub(super) fn of(&self, kernel: &Kernel) -> Option<f64> {
        let name = kernel.to_string();
        self.counts.iter().find(|(known, _)| *known == name).map(|(_, count)| *count)
    }
}

impl fmt::Display for Recorded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{HEADER}{}", self.compiler)?;
        self.counts.iter().try_for_each(|(name, count)| writeln!(f, "{name} {count:.3}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again() {
        let recorded = Recorded {
            compiler: "rustc 1.95.0 (59807616e 2026-04-14)".to_owned(),
            counts: Kernel::all().map(|kernel| (kernel.to_string(), 1.25)).collect(),
        };
        let read = Recorded::parse(&recorded.to_string());
        assert_eq!(read.as_ref(), Ok(&recorded));
        assert!(Kernel::all().all(|kernel| recorded.of(&kernel) == Some(1.25)));
    }

    #[test]
    fn a_line_that_is_no_count_is_named() {
        let complaint = Recorded::parse("# words\noscillator rk4 f64 many\n");
        assert_eq!(
            complaint,
            Err("line 2 of the recorded counts: `oscillator rk4 f64 many`".to_owned())
        );
    }

    /// The counts in the repository are those of the kernels that are counted.
    #[test]
    fn every_kernel_is_recorded() {
        let text = include_str!("../../../crates/libration/benches/instructions.txt");
        let recorded = Recorded::parse(text).unwrap();
        assert!(recorded.compiler.starts_with("rustc "));
        let names: Vec<String> = Kernel::all().map(|kernel| kernel.to_string()).collect();
        let known: Vec<&String> = recorded.counts.iter().map(|(name, _)| name).collect();
        assert_eq!(known, names.iter().collect::<Vec<_>>());
    }
}
