//! The cost of jittered clocks and late commands, relative to a fixed clock.

use std::hint::black_box;

use bytemuck::Pod;
use libration::control::clock::{Gaussian, Jittered, Skewed, Uniform};
use libration::control::controller::StateFeedback;
use libration::control::{Clock, Controller, Delay, Feedback, Jitter, Latency, Schedule};
use libration::ensemble::{All, Loops, Setup};
use libration::integrator::SymplecticEuler;
use libration::system::Oscillator;
use libration::{Ensemble, Float, State};
use libration_report::record::{Record, Table};
use libration_study::StudyError;

use super::fused::RESIDENT;
use crate::bench::Contestant;
use crate::measurement::{Measurement, judge};

/// Steps of a pass: as many as a draw by address serves.
const STEPS: u64 = libration::random::EPOCH;

/// How many times as long as a step of a fixed clock one with a jittered or asynchronous clock may take.
const CLOCK: f64 = 4.0;

/// The same for a step under a command that is a whole step late.
const DELAY: f64 = 3.0;

/// A measured case: its name in findings and in sentences, and its largest allowed cost.
const CONTESTANTS: [(&str, &str, Option<f64>); 4] = [
    ("asynchrony", "a clock rate for each trajectory", Some(CLOCK)),
    ("jitter", "uniform jitter", Some(CLOCK)),
    ("gaussian-jitter", "Gaussian jitter", None),
    ("delay", "feedback of the state, a step late", Some(DELAY)),
];

/// Races perturbed loops against an ensemble with a fixed clock.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let task = measurement.task(RESIDENT);
    let (system, dt) = (All(Oscillator { omega2: task.omega2 as f32 }), task.dt as f32);
    let starts: Vec<State<f32, 1>> = (0..RESIDENT).map(start).collect();
    let mut plain = Ensemble::new(&starts, measurement.serial.clone())?;
    let fixed = Contestant::new(RESIDENT as f64 * STEPS as f64, move |times| {
        for _ in 0..times {
            // One value for all is never too few or too many.
            let outcome = plain.advance(SymplecticEuler, system, All(dt), STEPS);
            debug_assert_eq!(outcome, Ok(()));
        }
        black_box(plain.q(0));
    });
    let base = Setup::new(system, SymplecticEuler);
    let gains = Feedback { position: 1.0, velocity: 0.1 };
    let late = Latency::of_steps(1.0).ok_or_else(|| StudyError::Exact("no latency".into()))?;
    let delayed = base.controller(StateFeedback::<1>::to_origin(gains)).delay(Schedule::late(late));
    let rates = measurement.compare_rates([
        fixed,
        contestant(measurement, base.clock(Skewed(Jitter::Gaussian(0.01))), dt, &starts)?,
        contestant(measurement, base.clock(Jittered(Uniform(0.1))), dt, &starts)?,
        contestant(measurement, base.clock(Jittered(Gaussian(0.1))), dt, &starts)?,
        contestant(measurement, delayed, dt, &starts)?,
    ])?;
    let [fixed, perturbed @ ..] = &rates;
    let mut table = Table::new("clocks and delays", &["with", "cost", "wanted at most"]);
    for ((id, what, most), rates) in CONTESTANTS.into_iter().zip(perturbed) {
        let ratio = rates.over(fixed);
        // Bars are for kernels that the registers hold.
        let bar = most.filter(|_| measurement.set().registers() >= 32).map(|most| 1.0 / most);
        judge(
            record,
            format!("throughput.{id}"),
            format!(
                "oscillators, symplectic Euler, f32, one core, {what}: steps a second over those with a \
                 fixed clock and without feedback"
            ),
            bar,
            &ratio,
        );
        table.push([what.into(), (1.0 / ratio.median()).into(), most.into()]);
    }
    record.tables.push(table);
    Ok(())
}

/// Each elsewhere.
fn start(n: usize) -> State<f32, 1> {
    let share = n as f32 / RESIDENT as f32;
    State { q: [1.0 + share], v: [0.5 - share] }
}

fn contestant<'a, T, K, C, L>(
    measurement: &Measurement<'_>,
    setup: Setup<All<Oscillator<T>>, SymplecticEuler, K, C, L>,
    dt: T,
    starts: &[State<T, 1>],
) -> Result<Contestant<'a>, StudyError>
where
    T: Float + Pod,
    K: Controller<T, 1> + 'a,
    C: Clock<T> + 'a,
    L: Delay<T> + 'a,
{
    let mut loops = Loops::new(setup, dt, 0, [T::zero()], starts, measurement.serial.clone())?;
    Ok(Contestant::new(RESIDENT as f64 * STEPS as f64, move |times| {
        for _ in 0..times {
            // Clocks and delays that know all steps never end.
            let outcome = loops.advance(STEPS);
            debug_assert_eq!(outcome, Ok(()));
        }
        black_box(loops.trajectories().q(0));
    }))
}
