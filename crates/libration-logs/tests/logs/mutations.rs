//! Damaged files: no bytes lead to a panic, or to more memory than the file deserves.

use std::fs;
use std::sync::Once;

use libration_logs::{ClockChoice, Log, PARQUET_THREAD, ReadOptions};

use crate::path;

/// Mutations of a sample, five times as many of a small one; `cargo xtask torture` sets more.
fn count(sample: &[u8]) -> u64 {
    let count = std::env::var("LIBRATION_MUTATIONS").ok().and_then(|count| count.parse().ok());
    let count: u64 = count.unwrap_or(500);
    if sample.len() > 10_000 { count } else { 5 * count }
}

/// Random bits (G. Marsaglia, *Xorshift RNGs*, Journal of Statistical Software 8, 2003).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit.max(1) as u64) as usize
    }
}

/// Changes some bytes, copies some, removes some, or ends early.
fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    const EDGES: [u8; 6] = [0, 1, 0x7f, 0x80, 0xfe, 0xff];
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len());
        match random.below(6) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = EDGES[random.below(EDGES.len())],
            2 => {
                // A length becomes huge.
                let end = (at + 1 + random.below(8)).min(bytes.len());
                bytes[at..end].fill(EDGES[random.below(EDGES.len())]);
            }
            3 => bytes.truncate(at.max(1)),
            4 => {
                let end = (at + random.below(64)).min(bytes.len());
                bytes.drain(at..end);
            }
            _ => {
                let end = (at + random.below(64)).min(bytes.len());
                let copy = bytes[at..end].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, copy);
            }
        }
        if bytes.is_empty() {
            bytes.push(0);
        }
    }
}

/// Reads all that a log offers.
fn read_all(bytes: Vec<u8>) -> bool {
    let Ok(log) = Log::from_bytes(bytes, &ReadOptions::default()) else { return false };
    for topic in log.topics().iter().take(1) {
        for clock in ClockChoice::ALL {
            let _ = log.stamps_of(&topic.name, clock);
        }
    }
    let signals = log.signals();
    for signal in signals.iter().step_by(signals.len().div_ceil(2).max(1)) {
        let _ = log.series(&signal.name);
    }
    let _ = log.notes();
    true
}

/// Ignores panics of the thread that reads Parquet files, as the program does.
fn ignore_panics_of_parquet() {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if std::thread::current().name() != Some(PARQUET_THREAD) {
            report(panic);
        }
    }));
}

/// Reads damaged samples.
fn damage(name: &str, sample: &[u8]) {
    static HOOK: Once = Once::new();
    HOOK.call_once(ignore_panics_of_parquet);
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let start = std::time::Instant::now();
    let mut opened = 0_u64;
    for _ in 0..count(sample) {
        let mut bytes = sample.to_vec();
        mutate(&mut bytes, &mut random);
        opened += u64::from(read_all(bytes));
    }
    eprintln!("{name}: {opened} of {} open, {:?}", count(sample), start.elapsed());
}

/// A test for each sample, so that they run at the same time.
macro_rules! no_mutation_leads_to_a_panic {
    ($($test:ident: $name:literal;)*) => {
        $(
            #[test]
            fn $test() {
                damage($name, &fs::read(path($name)).unwrap());
            }
        )*
    };
}

no_mutation_leads_to_a_panic! {
    of_mcap_by_zstd: "zstd.mcap";
    of_mcap_by_lz4: "lz4.mcap";
    of_mcap_in_plain_chunks: "none.mcap";
    of_mcap_without_chunks: "json.mcap";
    of_ros_1: "ros1.bag";
    of_ros_1_by_lz4: "ros1_lz4.bag";
    of_ros_1_by_bzip2: "ros1_bz2.bag";
    of_ros_2_in_sqlite: "humble.db3";
    of_ros_2_with_definitions: "iron.db3";
    of_ulog: "px4.ulg";
    of_archives: "table.npz";
    of_arrays: "matrix.npy";
    of_records: "records.npy";
    of_parquet: "table.parquet";
    of_durations: "durations.parquet";
}

#[test]
fn of_texts() {
    let texts: [(&str, &[u8]); 3] = [
        ("CSV", b"time_ns,x [m],y\n1700000000000000000,1,nan\n1700000000010000000,,2e5\n1700000000020000000,-3,\n"),
        ("cyclictest -v", b"T: 0 ( 12) I:500 C: 3\n 0: 0: 5\n 1: 0: 9\n 0: 1: 7\n 0: 2: 6\n"),
        ("cyclictest -h", b"# Histogram\n000003 000010\t000000\n000004 000089\t000001\n# Total: 99 1\n"),
    ];
    for (name, text) in texts {
        damage(name, text);
    }
}
