//! Increase of the cost of a loop by an imperfection.

use libration::analysis::{CostError, Imperfections, Plant};
use libration::control::clock::{Fixed, Gaussian, Jittered, Skewed};
use libration::control::controller::StateFeedback;
use libration::control::{Clock, Jitter, Latency, LqrWeights, Schedule, WhiteNoise};
use libration::ensemble::{All, Loops, MeanCost, Setup};
use libration::integrator::SymplecticEuler;
use libration::number::Mantissa;
use libration::random::{Address, Purpose};
use libration::system::{CommandedSystem, Oscillator};
use libration::{Float, Integrator, State};
use libration_report::record::{Finding, Record, Tolerance};
use libration_study::{Lab, StudyError};

use super::disturbed_run::{COUNT, DT, SEED, SPRING};
use super::imperfection::{Kind, Profile};
use super::prediction::{GAINS, ORIGIN};

/// The energy, as the mean of which the cost is taken.
const ENERGY: LqrWeights =
    LqrWeights { position: SPRING.omega2 / 2.0, velocity: 0.5, command: 0.0 };

/// Steps before the cost counts: twenty times as long as the loop remembers.
const BEFORE: u64 = 2000;

/// `ΔJ/J₀` of the loop by the Lyapunov equation; none where nothing is predicted.
pub(super) fn predicted(kind: Kind, profile: &Profile) -> Result<Option<f64>, CostError> {
    let none = Imperfections::NONE;
    let of = |imperfections| {
        let plant = Plant::new(SymplecticEuler, SPRING, ORIGIN, DT);
        plant.cost(&GAINS.into(), &imperfections, ENERGY)
    };
    let jitter = Jitter::Gaussian(profile.jitter);
    let cost = match kind {
        Kind::Latency => {
            let latency = Latency::of_steps(profile.latency).unwrap_or(Latency::NONE);
            of(Imperfections { latency, ..none })?
        }
        Kind::Jitter => of(Imperfections { jitter, ..none })?,
        Kind::Asynchrony => {
            // Half the clocks fast by the rms and half slow: right to the fourth power of it.
            let slow = of(Imperfections { skew: profile.asynchrony, ..none })?;
            let fast = of(Imperfections { skew: -profile.asynchrony, ..none })?;
            0.5 * (slow + fast)
        }
        Kind::Precision => return Ok(None),
    };
    Ok(Some(cost / of(none)? - 1.0))
}

/// `ΔJ/J₀` of simulated loops under the same noise as ideal ones, and its standard error.
pub(super) fn measured(
    lab: &Lab<'_>,
    kind: Kind,
    profile: &Profile,
) -> Result<[f64; 2], StudyError> {
    let none = Schedule::EVERY_STEP;
    let plain = || costs(lab, Fixed, none);
    let [ideal, disturbed] = match kind {
        Kind::Latency => {
            let latency = Latency::of_steps(profile.latency).unwrap_or(Latency::NONE);
            [plain()?, costs(lab, Fixed, Schedule::late(latency))?]
        }
        Kind::Jitter => {
            let clock = Jittered(Gaussian(profile.jitter));
            [plain()?, costs(lab, clock, none)?]
        }
        Kind::Asynchrony => {
            [plain()?, costs(lab, Skewed(Jitter::Gaussian(profile.asynchrony)), none)?]
        }
        Kind::Precision => {
            let few = match profile.bits {
                7 => rounded::<Mantissa<7>>,
                10 => rounded::<Mantissa<10>>,
                13 => rounded::<Mantissa<13>>,
                _ => rounded::<f32>,
            };
            [rounded_costs(lab, rounded::<f64>)?, rounded_costs(lab, few)?]
        }
    };
    let count = ideal.len() as f64;
    let mean = ideal.iter().sum::<f64>() / count;
    // Pair by pair: what the same noise does to both is no part of the difference.
    let rises: Vec<f64> = disturbed.iter().zip(&ideal).map(|(a, b)| (a - b) / mean).collect();
    let rise = rises.iter().sum::<f64>() / count;
    let squares: f64 = rises.iter().map(|x| (x - rise).powi(2)).sum();
    Ok([rise, (squares / (count - 1.0) / count).sqrt()])
}

/// Leaves both in the record.
pub(super) fn find(
    record: &mut Record,
    kind: Kind,
    profile: &Profile,
    [rise, error]: [f64; 2],
    expected: Option<f64>,
) {
    let id = format!("hierarchy.{}.{}.cost", profile.tag, kind.tag());
    let text = format!(
        "{}, {}: rise of the cost of a loop with the gains (10, 2) under white noise, ΔJ/J₀",
        profile.title,
        kind.title()
    );
    record.find(match expected {
        Some(expected) => {
            let why = "four standard errors of the difference to ideal loops under the same noise, pair by pair";
            let tolerance = Tolerance::absolute(4.0 * error, why);
            Finding::predicted(id, text, "1", expected, rise, tolerance)
        }
        None => Finding::measured(id, text, "1", rise),
    });
}

/// Steps that count.
fn steps(lab: &Lab<'_>) -> u64 {
    lab.effort.choose(10_000, 50_000, 200_000)
}

/// The mean cost of each of many loops.
fn costs<C: Clock<f64>>(
    lab: &Lab<'_>,
    clock: C,
    schedule: Schedule,
) -> Result<Vec<f64>, StudyError> {
    let setup = Setup::new(All(SPRING), SymplecticEuler)
        .controller(StateFeedback::to_origin(GAINS))
        .clock(clock)
        .delay(schedule)
        .disturbance(WhiteNoise(1.0));
    let starts = [State { q: [0.0], v: [0.0] }; COUNT];
    let mut loops = Loops::new(setup, DT, SEED, [0.0], &starts, lab.alone()?)?;
    loops.advance(BEFORE)?;
    lab.check()?;
    let seen = loops.observe(steps(lab), 1, |range| MeanCost::new(range, ENERGY))?;
    Ok(seen.iter().flat_map(MeanCost::means).collect())
}

/// The same in numbers of few bits, under noise of its own.
fn rounded_costs(lab: &Lab<'_>, one: fn(u64, u64) -> f64) -> Result<Vec<f64>, StudyError> {
    // One by one, and slowly.
    let (count, steps) = (COUNT as u64 / 4, steps(lab));
    (0..count).map(|trajectory| lab.check().map(|()| one(trajectory, steps))).collect()
}

/// A loop in numbers of few bits: the state, the parameters, the noise and every operation.
fn rounded<T: Float>(trajectory: u64, steps: u64) -> f64 {
    let system = Oscillator { omega2: T::from_f64(SPRING.omega2) };
    let dt = T::from_f64(DT);
    let [kp, kd] = [GAINS.position, GAINS.velocity].map(T::from_f64);
    let mut state: State<T, 1> = State::origin();
    let mut sum = 0.0;
    for step in 0..BEFORE + steps {
        let State { q: [q], v: [v] } = state;
        let [noise, _] =
            Address { seed: SEED, trajectory, step, purpose: Purpose::Disturbance }.gaussian();
        let command = [-(kp * q) - kd * v + T::from_f64(noise / DT.sqrt())];
        state = SymplecticEuler.step(&CommandedSystem { system, command }, state, dt);
        if step >= BEFORE {
            let [q, v] = [state.q[0], state.v[0]].map(T::to_f64);
            sum += ENERGY.position * q * q + ENERGY.velocity * v * v;
        }
    }
    sum / steps as f64
}
