//! The runs whose bits are compared.

use libration::control::clock::{Gaussian, Jittered, Skewed};
use libration::control::controller::StateFeedback;
use libration::control::{Feedback, Jitter, Latency, Schedule};
use libration::ensemble::{All, AnyEnsemble, Execution, Loops, Setup};
use libration::integrator::SymplecticEuler;
use libration::system::Oscillator;
use libration::{AnySystem, Method, State};
use libration_study::{Lab, StudyError};

/// Trajectories that are compared.
pub(super) const COUNT: usize = 4096;

/// The time step, in s: the report's.
pub(super) const DT: f32 = 0.01;

/// The bits of a state.
pub(super) type Bits = [u32; 2];

/// Steps of a run.
pub(super) fn steps(lab: &Lab<'_>) -> u64 {
    lab.effort.choose(500, 5000, 50_000)
}

/// The source's oscillator, whatever is configured: where nothing is left but infinities, nothing differs.
pub(super) const SPRING: Oscillator<f64> = Oscillator { omega2: 10.0 };

/// Each starts elsewhere, so that none stands for another.
pub(super) fn start(n: usize) -> [f32; 2] {
    [1.0 + n as f32 / 8192.0, 0.0]
}

/// Returns the number of different entries of two lists.
pub(super) fn differing(a: &[Bits], b: &[Bits]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

/// The first `count` trajectories after all steps, taken in so many calls.
pub(super) fn run_plain(
    lab: &Lab<'_>,
    count: usize,
    execution: Execution,
    calls: u64,
) -> Result<Vec<Bits>, StudyError> {
    let system = AnySystem::Oscillator(SPRING);
    let at = |n: usize, i: usize| start(n)[i];
    let mut all = AnyEnsemble::<f32>::of_system(system, 1, count, execution, at)?;
    let whole = steps(lab);
    for call in 0..calls {
        let part = whole * (call + 1) / calls - whole * call / calls;
        all.advance(Method::SymplecticEuler, DT, part);
    }
    let plane = |plane: Option<&[f32]>| plane.map(<[f32]>::to_vec).unwrap_or_default();
    let (q, v) = (plane(all.q(0)), plane(all.v(0)));
    Ok(q.iter().zip(&v).map(|(q, v)| [q.to_bits(), v.to_bits()]).collect())
}

/// The same in loops where nothing is ideal: jitter, a rate for each clock, feedback that is late by a part of a
/// step.
pub(super) fn run_perturbed(
    lab: &Lab<'_>,
    count: usize,
    execution: Execution,
    seed: u64,
) -> Result<Vec<Bits>, StudyError> {
    let gains = Feedback { position: 1.0, velocity: 0.3 };
    let late =
        Latency::of_steps(1.5).ok_or_else(|| StudyError::Exact("making a latency".into()))?;
    let system = Oscillator { omega2: SPRING.omega2 as f32 };
    let setup = Setup::new(All(system), SymplecticEuler)
        .controller(StateFeedback::to_origin(gains))
        .clock((Skewed(Jitter::Uniform(0.01)), Jittered(Gaussian(0.1))))
        .delay(Schedule::late(late));
    let states: Vec<State<f32, 1>> =
        (0..count).map(start).map(|[q, v]| State { q: [q], v: [v] }).collect();
    let mut loops = Loops::new(setup, DT, seed, [0.0], &states, execution)?;
    // Damped loops die out: long before, their bits are compared.
    loops.advance(steps(lab).min(500))?;
    let bits = |state: State<f32, 1>| [state.q[0].to_bits(), state.v[0].to_bits()];
    Ok((0..count).filter_map(|n| loops.state(n)).map(bits).collect())
}
