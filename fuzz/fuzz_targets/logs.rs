//! The readers of logs: no bytes lead to a panic, nor to more memory than the file deserves.

#![no_main]

use libfuzzer_sys::fuzz_target;
use libration_logs::{ClockChoice, Log, ReadOptions};

fuzz_target!(|bytes: &[u8]| {
    let Ok(log) = Log::from_bytes(bytes.to_vec(), &ReadOptions::default()) else { return };
    for topic in log.topics().iter().take(2) {
        for clock in ClockChoice::ALL {
            let _ = log.stamps_of(&topic.name, clock);
        }
    }
    for signal in log.signals().iter().take(4) {
        let _ = log.series(&signal.name);
    }
});
