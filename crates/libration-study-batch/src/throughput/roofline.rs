//! Roofline: rates against the number of steps per pass.

use std::hint::black_box;

use libration::Method;
use libration_report::record::{Finding, Record, Series};
use libration_study::StudyError;

use super::bandwidth::footprint;
use super::fused::{flow, peak};
use super::one_step::update;
use crate::bench::{Contestant, oscillators};
use crate::measurement::{Measurement, judge};

/// Bytes that a pass moves for each trajectory: position and velocity, read and written.
const BYTES: f64 = 4.0 * size_of::<f32>() as f64;

/// Steps of a pass: as many as it takes to leave the memory behind.
const STEPS: [u64; 8] = [1, 2, 4, 8, 16, 32, 64, 128];

/// The number of steps at which arithmetic and memory both take long.
const JUDGED: u64 = 16;

/// Share of the rate without any overlap that is to be reached.
const BAR: f64 = 0.9;

/// Races ensembles that no cache holds, with more and more steps a pass.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    // Two arrays, as large as those of which bandwidths are told, but not so that it takes minutes.
    let bytes = (footprint(measurement) / 3 * 2).min(1 << 30);
    let count = usize::try_from(bytes).unwrap_or(usize::MAX) / (2 * size_of::<f32>());
    let task = measurement.task(count);
    let method = Method::SymplecticEuler;
    let arithmetic = peak::<f32>(measurement, &flow(measurement, method))?;
    let operations = arithmetic.operations() as f64;
    let loops = || -> Result<_, StudyError> {
        Ok([
            arithmetic.contestant::<f32>(measurement.set()),
            update(measurement, count, &measurement.serial)?,
        ])
    };
    let [peak, memory] = measurement.sweep_rates(loops()?)?.map(|rates| rates.median());
    let mut ensemble = oscillators::<f32>(task, &measurement.serial)?;
    let dt = task.dt as f32;
    let mut columns: [Vec<f64>; 5] = Default::default();
    for steps in STEPS {
        let k = steps as f64;
        let pass = Contestant::new(count as f64 * k, |times| {
            for _ in 0..times {
                ensemble.advance(method, dt, steps);
            }
            black_box(ensemble.q(0));
        });
        let rates = if steps == JUDGED {
            let [arithmetic, memory] = loops()?;
            let [rates, arithmetic, memory] =
                measurement.compare_rates([pass, arithmetic, memory])?;
            let in_turn = arithmetic.with(&memory, |peak, memory| bounds(peak, memory, k)[0]);
            judge(
                record,
                "throughput.roofline".into(),
                format!(
                    "symplectic Euler, f32, one core, arrays of {} MiB, {steps} steps a pass: steps a \
                     second over those if arithmetic and memory waited for each other",
                    (count * size_of::<f32>()) >> 20
                ),
                // Worse than that would be a third thing that limits. With few registers there is
                // one: blocks go through a cache.
                (measurement.set().registers() >= 32).then_some(BAR),
                &rates.over(&in_turn),
            );
            rates
        } else {
            let [rates] = measurement.sweep_rates([pass])?;
            rates
        };
        let [in_turn, at_once] = bounds(peak, memory, k);
        let row = [k * operations / BYTES, rates.median(), in_turn, at_once, k];
        columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
    }
    let [intensity, rate, low, high, steps] = columns;
    let flops = |rates: Vec<f64>| rates.iter().map(|rate| rate * operations).collect();
    record.series.push(
        Series::new("roofline")
            .with("steps_per_pass", "1", steps)
            .with("intensity", "1/B", intensity)
            .with("attained", "1/s", flops(rate))
            .with("in_turn", "1/s", flops(low))
            .with("at_once", "1/s", flops(high)),
    );
    for (id, text, value) in [
        ("peak", "multiplications and additions", peak * operations / 1e9),
        (
            "memory",
            "bytes that a loop over the arrays of the roofline reads and writes",
            memory * BYTES / 1e9,
        ),
    ] {
        let unit = if id == "peak" { "10⁹/s" } else { "GB/s" };
        let text = format!("one core, f32: {text}, a second");
        record.find(Finding::measured(format!("throughput.roof.{id}"), text, unit, value));
    }
    Ok(())
}

/// Steps a second where a pass of `k` steps waits for its memory and then for its arithmetic, and where
/// one goes on behind the other.
fn bounds(peak: f64, memory: f64, k: f64) -> [f64; 2] {
    let (arithmetic, memory) = (k / peak, 1.0 / memory);
    [k / (arithmetic + memory), k / arithmetic.max(memory)]
}

#[cfg(test)]
mod tests {
    use super::bounds;

    #[test]
    fn a_pass_takes_at_least_the_longer_of_two_times_and_at_most_both() {
        // Ten steps at 10 a second take 1 s, the memory of a pass another second.
        assert_eq!(bounds(10.0, 1.0, 10.0), [5.0, 10.0]);
        assert_eq!(bounds(10.0, 1.0, 1.0), [1.0 / 1.1, 1.0]);
    }
}
