//! Speedup with all cores.

use libration::Method;
use libration_report::record::{Finding, Record, Table};
use libration_study::StudyError;

use super::fused::{RESIDENT, STEPS, flow, peak};
use crate::bench::{Contestant, Rates, stepping};
use crate::measurement::{Measurement, judge};

/// Least speedup of fused steps, relative to that of independent arithmetic.
const BAR: f64 = 0.9;

/// Steps of a pass: threads meet at the end of the whole horizon.
const HORIZON: u64 = 5 * STEPS;

/// Races fused steps and independent arithmetic, each on one thread, on two and so on.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let cores = measurement.parallel.thread_count();
    let task = measurement.task(RESIDENT * cores);
    let method = Method::SymplecticEuler;
    let peak = peak::<f32>(measurement, &flow(measurement, method))?;
    let counts = thread_counts(cores);
    let mut contestants: Vec<Contestant<'_>> = Vec::new();
    for &threads in &counts {
        let execution = measurement.serial.clone().threads(threads)?;
        contestants.push(stepping::<f32>(method, task, HORIZON, &execution)?);
        contestants.push(peak.run_on_threads::<f32>(&execution));
    }
    let rates = measurement.compare_rates_of(&mut contestants)?;
    let pairs: Vec<(usize, [&Rates; 2])> = counts
        .iter()
        .zip(rates.chunks_exact(2))
        .map(|(&threads, pair)| (threads, [&pair[0], &pair[1]]))
        .collect();
    let mut table = Table::new(
        "threads",
        &["threads", "fused (10⁹ steps/s)", "over one", "independent arithmetic over one", "share"],
    );
    let Some(&(_, alone)) = pairs.first() else { return Ok(()) };
    for &(threads, pair) in &pairs {
        let [fused, arithmetic] = [0, 1].map(|i| pair[i].over(alone[i]));
        let share = fused.over(&arithmetic);
        table.push([
            (threads as u64).into(),
            (pair[0].median() / 1e9).into(),
            fused.median().into(),
            arithmetic.median().into(),
            share.median().into(),
        ]);
        if threads == cores && threads > 1 {
            judge(
                record,
                "throughput.threads".into(),
                format!(
                    "symplectic Euler, f32: what {threads} threads gain over one, over what \
                     independent arithmetic gains"
                ),
                Some(BAR),
                &share,
            );
            record.find(Finding::measured(
                "throughput.threads.gain",
                format!("symplectic Euler, f32: steps a second on {threads} threads over one"),
                "1",
                fused.median(),
            ));
        }
    }
    record.tables.push(table);
    Ok(())
}

/// One thread, then twice as many and so on, and as many as there are cores.
fn thread_counts(cores: usize) -> Vec<usize> {
    let doubled = std::iter::successors(Some(1), |threads| Some(threads * 2));
    doubled.take_while(|&threads| threads < cores).chain([cores]).collect()
}

#[cfg(test)]
mod tests {
    use super::thread_counts;

    #[test]
    fn threads_double_up_to_the_cores() {
        assert_eq!(thread_counts(1), [1]);
        assert_eq!(thread_counts(2), [1, 2]);
        assert_eq!(thread_counts(6), [1, 2, 4, 6]);
        assert_eq!(thread_counts(8), [1, 2, 4, 8]);
    }
}
