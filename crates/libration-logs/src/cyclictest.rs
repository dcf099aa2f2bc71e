//! Output of `cyclictest`: of `-v`, and the histogram of `-h`.
//!
//! With `-v` a line has the number of the thread, that of the wake-up and its lateness in µs: `0: 17: 5`. A line of the histogram has a
//! lateness in µs and the number of wake-ups of each thread: `000005 000123 000045`.

use std::collections::BTreeMap;
use std::io::BufRead;

use crate::column::{Column, Values};
use crate::error::LogError;
use crate::input::Input;
use crate::read_options::ReadOptions;
use crate::table::Table;
use crate::text_encoding;
use crate::text_line::TextLines;

/// The interval of the first thread in ns, unless the output has it: the default of the program.
const INTERVAL: i64 = 1_000_000;
/// Most threads.
const MOST_THREADS: usize = 4096;
/// Most wake-ups.
const MOST: usize = 1 << 27;

/// The kind of output in the first bytes of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Output {
    Verbose,
    Histogram,
}

impl Output {
    /// Recognises an output; none in other texts.
    pub(crate) fn recognise(prefix: &str) -> Option<Self> {
        let lines = || prefix.split(['\n', '\r']);
        if lines().any(|line| line.starts_with("# Histogram")) {
            return Some(Output::Histogram);
        }
        let wakeups = lines().filter(|line| wakeup(line).is_some()).count();
        (wakeups >= 3).then_some(Output::Verbose)
    }
}

/// Thread, number and lateness in µs of a line of `-v`.
fn wakeup(line: &str) -> Option<(usize, i64, i64)> {
    let mut parts = line.split(':').map(str::trim);
    let thread = parts.next()?.parse().ok()?;
    let (count, late) = (parts.next()?.parse().ok()?, parts.next()?.parse().ok()?);
    parts.next().is_none().then_some((thread, count, late))
}

/// Reads the output.
pub(crate) fn open(input: &Input, output: Output) -> Result<Table, LogError> {
    match output {
        Output::Verbose => verbose(text_encoding::reader(input)?),
        Output::Histogram => histogram(text_encoding::reader(input)?),
    }
}

/// The wake-ups of each thread, as columns of stamps and of lateness.
fn verbose(input: impl BufRead) -> Result<Table, LogError> {
    let mut threads: BTreeMap<usize, [Vec<i64>; 2]> = BTreeMap::new();
    let (mut interval, mut line, mut all) = (None, String::new(), 0);
    let mut lines = TextLines::new(input);
    while lines.read(&mut line)? {
        if let Some((_, rest)) = line.split_once(" I:") {
            let number = rest.split_whitespace().next().and_then(|text| text.parse::<i64>().ok());
            interval = interval.or(number.map(|us| us.saturating_mul(1000)));
        }
        let Some((thread, count, late)) = wakeup(&line) else { continue };
        if threads.len() >= MOST_THREADS && !threads.contains_key(&thread) {
            continue;
        }
        all += 1;
        if all > MOST {
            let limit = MOST as u64;
            return Err(LogError::TooLarge {
                what: "number of wake-ups",
                value: all as u64,
                limit,
            });
        }
        let [counts, lates] = threads.entry(thread).or_default();
        counts.push(count);
        lates.push(late);
    }
    let note = match interval {
        Some(interval) => format!("the interval is {} µs", interval / 1000),
        None => "the interval is not in the output: 1000 µs assumed, the default of cyclictest"
            .to_owned(),
    };
    let interval = interval.unwrap_or(INTERVAL);
    let mut columns = Vec::new();
    for (thread, [counts, lates]) in threads {
        let stamp = |(count, late): (&i64, &i64)| {
            count.saturating_mul(interval).saturating_add(late.saturating_mul(1000))
        };
        let stamps = counts.iter().zip(&lates).map(stamp).collect();
        let mut stamps = Column::new(format!("thread{thread}"), Values::Whole(stamps));
        stamps.per_second = Some(1e9);
        let mut late = Column::new(format!("thread{thread}.latency"), Values::Whole(lates));
        late.unit = Some("µs".to_owned());
        columns.extend([stamps, late]);
    }
    Table::new("cyclictest", columns, &ReadOptions::of_time("thread0"), vec![note])
}

/// The counts of each thread over the lateness, and quantiles in words: a histogram has no order in time.
fn histogram(input: impl BufRead) -> Result<Table, LogError> {
    let mut columns: Vec<Vec<i64>> = Vec::new();
    let mut line = String::new();
    let mut lines = TextLines::new(input);
    while lines.read(&mut line)? {
        if line.starts_with('#') {
            continue;
        }
        let numbers: Option<Vec<i64>> =
            line.split_whitespace().map(|text| text.parse().ok()).collect();
        let Some(numbers) = numbers.filter(|all| (2..=MOST_THREADS).contains(&all.len())) else {
            continue;
        };
        columns
            .resize(columns.len().max(numbers.len()), vec![0; columns.first().map_or(0, Vec::len)]);
        for (i, column) in columns.iter_mut().enumerate() {
            column.push(numbers.get(i).copied().unwrap_or(0));
        }
        if columns.len() * columns[0].len() > MOST {
            let limit = MOST as u64;
            return Err(LogError::TooLarge { what: "number of cells", value: limit + 1, limit });
        }
    }
    let Some((lates, threads)) = columns.split_first() else {
        return Err(LogError::Damaged("the histogram has no counts".to_owned()));
    };
    let mut notes = vec!["a histogram has no order in time, so it has no intervals".to_owned()];
    for (thread, counts) in threads.iter().enumerate() {
        notes.push(quantiles(thread, lates, counts));
    }
    let name = |i: usize| if i == 0 { "latency_us".to_owned() } else { format!("thread{}", i - 1) };
    let columns =
        columns.into_iter().enumerate().map(|(i, x)| Column::new(name(i), Values::Whole(x)));
    Ok(Table::new(
        "cyclictest histogram",
        columns.collect(),
        &ReadOptions::of_time("latency_us"),
        notes,
    )?
    .without_stamps())
}

/// The quantiles of a thread in words.
fn quantiles(thread: usize, lates: &[i64], counts: &[i64]) -> String {
    let total: i128 = counts.iter().map(|&count| i128::from(count.max(0))).sum();
    let at = |part: f64| {
        let mut sum = 0;
        let wanted = ((part * total as f64).ceil() as i128).max(1);
        let found = lates.iter().zip(counts).find(|(_, count)| {
            sum += i128::from((**count).max(0));
            sum >= wanted
        });
        found.map_or_else(|| "-".to_owned(), |(late, _)| late.to_string())
    };
    format!(
        "thread {thread}: {total} wake-ups, lateness min {}, 50 % {}, 99 % {}, 99.9 % {}, max {} µs",
        at(0.0),
        at(0.5),
        at(0.99),
        at(0.999),
        at(1.0)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::ClockChoice;
    use crate::source::Source;

    const VERBOSE: &str = "Max CPUs = 8\nT: 0 ( 1234) P:80 I:500 C: 10 Min: 3\n\
                           \x20      0:       0:       5\n       1:       0:       9\n       0:       1:       7\n";

    #[test]
    fn wake_ups_of_threads_become_stamps() {
        let table = verbose(VERBOSE.as_bytes()).unwrap();
        assert_eq!(Output::recognise(VERBOSE), Some(Output::Verbose));
        assert_eq!(table.stamps("thread0", ClockChoice::Log).unwrap(), [0.0, 502e-6]);
        assert_eq!(table.series("thread0.latency", ClockChoice::Log).unwrap().values, [5.0, 7.0]);
        assert_eq!(table.stamps("thread1", ClockChoice::Log).unwrap(), [4e-6]);
    }

    #[test]
    fn a_histogram_has_quantiles_and_no_stamps() {
        let text = "# /dev/cpu_dma_latency set to 0us\n# Histogram\n000003 000010\t000000\n000004 000089\t000001\n000050 000001\t000000\n# Total: 000000100 000000001\n";
        assert_eq!(Output::recognise(text), Some(Output::Histogram));
        let table = histogram(text.as_bytes()).unwrap();
        assert!(table.topics().is_empty());
        let notes = table.notes();
        let wanted = "thread 0: 100 wake-ups, lateness min 3, 50 % 4, 99 % 4, 99.9 % 50, max 50 µs";
        assert!(notes.iter().any(|note| note == wanted), "{notes:?}");
    }
}
