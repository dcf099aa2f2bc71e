//! The recorded sizes, as a table that people read.

use std::fmt;

use super::part::{Compiled, Part};
use crate::Outcome;

/// The sizes of all parts, by name.
#[derive(Debug, PartialEq)]
pub(super) struct Record {
    pub(super) parts: Vec<Part>,
}

const HEADER: &str = "\
# Sizes of the crates as `cargo xtask size --record` writes them: lines of source, public types, and the functions, batch kernels
# and bytes of code of the release program. The public types of each crate follow the table.
";

/// What is known of a part in numbers: lines, public types, functions, kernels and bytes.
fn numbers(part: &Part) -> [Option<usize>; 5] {
    let of = |get: fn(Compiled) -> usize| part.compiled.map(get);
    let compiled = [of(|c| c.functions), of(|c| c.kernels), of(|c| c.bytes)];
    [Some(part.lines), Some(part.types.len()), compiled[0], compiled[1], compiled[2]]
}

const COLUMNS: [&str; 5] = ["lines", "types", "functions", "kernels", "bytes"];

impl Record {
    pub(super) fn of(&self, name: &str) -> Option<&Part> {
        self.parts.iter().find(|part| part.name == name)
    }

    /// The numbers of all parts together.
    fn sums(&self) -> [Option<usize>; 5] {
        let all: Vec<[Option<usize>; 5]> = self.parts.iter().map(numbers).collect();
        core::array::from_fn(|i| Some(all.iter().filter_map(|one| one[i]).sum()))
    }

    fn rows(&self) -> impl Iterator<Item = (&str, [Option<usize>; 5])> {
        let parts = self.parts.iter().map(|part| (part.name.as_str(), numbers(part)));
        parts.chain([("all", self.sums())])
    }

    /// The table, with the changes since `before`.
    pub(super) fn beside(&self, before: &Record) -> String {
        let known: Vec<_> = before.rows().collect();
        let mut text = header();
        for (name, found) in self.rows() {
            let old = known.iter().find(|(known, _)| *known == name).map(|(_, old)| *old);
            let change = |i: usize| {
                let (new, old) = (found[i]? as i64, old.and_then(|old| old[i]).unwrap_or(0) as i64);
                (new != old).then(|| format!(" {} {:+}", COLUMNS[i], new - old))
            };
            let changes: String = (0..COLUMNS.len()).filter_map(change).collect();
            text += &format!("{}{}\n", row(name, found), changes);
        }
        text
    }

    /// Fails if there are more lines or public types than `before` and a part of them.
    pub(super) fn check_growth(&self, before: &Record, part: f64) -> Outcome {
        let (new, old) = (self.sums(), before.sums());
        for i in 0..2 {
            let (new, old) = (new[i].unwrap_or(0), old[i].unwrap_or(0));
            if new as f64 > old as f64 * (1.0 + part) {
                let what = COLUMNS[i];
                return Err(format!(
                    "{new} {what}, and {old} are recorded: take some back, or record them with `cargo xtask size --record` and say why"
                ));
            }
        }
        Ok(())
    }

    /// Reads a file that `--record` has written.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut record = Record { parts: Vec::new() };
        let lines = text.lines().enumerate().filter(|(_, line)| !line.starts_with('#'));
        for (i, line) in lines.filter(|(_, line)| !line.is_empty()) {
            let unreadable = || format!("line {} of the recorded sizes: `{line}`", i + 1);
            if let Some((name, types)) = line.split_once(": ") {
                let part = record.parts.iter_mut().find(|part| part.name == name);
                let part = part.ok_or_else(unreadable)?;
                part.types = types.split(", ").map(str::to_owned).collect();
                continue;
            }
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            let [name, values @ ..] = &words[..] else { continue };
            if ["crate", "all"].contains(name) {
                continue;
            }
            let values: Vec<Option<usize>> = values.iter().map(|word| word.parse().ok()).collect();
            let [Some(lines), _, functions, kernels, bytes] = values[..] else {
                return Err(unreadable());
            };
            let compiled = match (functions, kernels, bytes) {
                (Some(functions), Some(kernels), Some(bytes)) => {
                    Some(Compiled { functions, kernels, bytes })
                }
                _ => None,
            };
            let name = (*name).to_owned();
            record.parts.push(Part { name, lines, compiled, ..Part::default() });
        }
        Ok(record)
    }
}

fn header() -> String {
    let columns: String = COLUMNS.iter().map(|name| format!("{name:>11}")).collect();
    format!("{:<24}{columns}\n", "crate")
}

fn row(name: &str, values: [Option<usize>; 5]) -> String {
    let shown = |value: &Option<usize>| value.map_or("-".to_owned(), |n| n.to_string());
    let columns: String = values.iter().map(|value| format!("{:>11}", shown(value))).collect();
    format!("{name:<24}{columns}")
}

impl fmt::Display for Record {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{HEADER}{}", header())?;
        self.rows().try_for_each(|(name, values)| writeln!(f, "{}", row(name, values)))?;
        for part in self.parts.iter().filter(|part| !part.types.is_empty()) {
            let types: Vec<&str> = part.types.iter().map(String::as_str).collect();
            write!(f, "\n{}: {}\n", part.name, types.join(", "))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(lines: usize, types: &[&str]) -> Record {
        let compiled = Some(Compiled { functions: 3, kernels: 1, bytes: 700 });
        let types = types.iter().map(|&name| name.to_owned()).collect();
        let a = Part { name: "a".to_owned(), lines, types, compiled };
        let python = Part { name: "python".to_owned(), lines: 50, ..Part::default() };
        Record { parts: vec![a, python] }
    }

    #[test]
    fn what_is_written_is_read_again() {
        let record = record(100, &["A", "B"]);
        assert_eq!(Record::parse(&record.to_string()), Ok(record));
        assert!(Record::parse("a few words\n").is_err());
    }

    #[test]
    fn a_change_is_shown_beside_the_crate_and_the_sum() {
        let shown = record(90, &["A", "B", "C"]).beside(&record(100, &["A", "B"]));
        let changed: Vec<&str> = shown.lines().filter(|line| line.contains("lines -10")).collect();
        assert_eq!(changed.len(), 2, "{shown}");
        assert!(changed.iter().all(|line| line.ends_with("lines -10 types +1")), "{shown}");
    }

    #[test]
    fn growth_beyond_a_part_has_to_be_recorded() {
        let before = record(1000, &["A", "B"]);
        assert_eq!(record(1005, &["A", "B"]).check_growth(&before, 0.005), Ok(()));
        let said = record(1006, &["A"]).check_growth(&before, 0.005).unwrap_err();
        assert!(said.starts_with("1056 lines, and 1050 are recorded"), "{said}");
        assert!(record(900, &["A", "B", "C"]).check_growth(&before, 0.005).is_err());
    }
}
