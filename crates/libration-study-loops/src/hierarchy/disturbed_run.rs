//! Disturbed trajectories compared with undisturbed ones.

use libration::analysis::{QuadraticForm, UpdateMatrix};
use libration::control::clock::{Fixed, Gaussian, Jittered, Skewed};
use libration::control::controller::Force;
use libration::control::{Clock, Jitter, Latency, Schedule};
use libration::ensemble::{All, Loops, Setup};
use libration::integrator::SymplecticEuler;
use libration::number::{Mantissa, Wide};
use libration::system::{BaselineOnly, Oscillator};
use libration::{Float, Integrator, State};
use libration_study::{Lab, StudyError};

use super::imperfection::{Kind, Profile};

/// The source's oscillator and its time step, whatever is configured: an angle of 0.0316 rad a step.
pub(super) const SPRING: Oscillator<f64> = Oscillator { omega2: 10.0 };

/// The time step, in s.
pub(super) const DT: f64 = 0.01;

/// Trajectories, which start all around the orbit.
pub(super) const COUNT: usize = 128;

/// Of all that is random.
pub(super) const SEED: u64 = 20;

/// Effect of an imperfection on trajectories, at several numbers of steps.
pub(super) struct Effect {
    /// The root of the mean square distance from undisturbed orbits, in units of their size.
    pub(super) distance: Vec<f64>,
    /// The root of the mean square of `ln E/E₀`, of the energy that undisturbed steps conserve.
    pub(super) energy: Vec<f64>,
}

/// Runs disturbed trajectories beside undisturbed ones.
pub(super) fn run(
    lab: &Lab<'_>,
    kind: Kind,
    profile: &Profile,
    steps: &[u64],
) -> Result<Effect, StudyError> {
    let plain = clocked(lab, Fixed, steps)?;
    let disturbed = match kind {
        Kind::Latency => late(lab, profile.latency, steps)?,
        Kind::Jitter => clocked(lab, Jittered(Gaussian(profile.jitter)), steps)?,
        Kind::Asynchrony => clocked(lab, Skewed(Jitter::Gaussian(profile.asynchrony)), steps)?,
        Kind::Precision => match profile.bits {
            7 => rounded::<Mantissa<7>>(steps),
            10 => rounded::<Mantissa<10>>(steps),
            13 => rounded::<Mantissa<13>>(steps),
            _ => rounded::<f32>(steps),
        },
    };
    let square = |q: f64, v: f64| SPRING.omega2 * q * q + v * v;
    let apart = |(a, b): (&Vec<State<f64, 1>>, &Vec<State<f64, 1>>)| {
        let pairs = || a.iter().zip(b);
        let off: f64 = pairs().map(|(a, b)| square(a.q[0] - b.q[0], a.v[0] - b.v[0])).sum();
        let size: f64 = pairs().map(|(_, b)| square(b.q[0], b.v[0])).sum();
        (off / size).sqrt()
    };
    let step = UpdateMatrix::of_step(SymplecticEuler, SPRING, &State::origin(), DT);
    let form = QuadraticForm::carried_by(&step).map(Wide::to_f64);
    let pumped = |(a, b): (&Vec<State<f64, 1>>, &Vec<State<f64, 1>>)| {
        let squares = a.iter().zip(b).map(|(a, b)| (form.at(a) / form.at(b)).ln().powi(2));
        (squares.sum::<f64>() / a.len() as f64).sqrt()
    };
    let pairs = || disturbed.iter().zip(&plain);
    Ok(Effect { distance: pairs().map(apart).collect(), energy: pairs().map(pumped).collect() })
}

/// The states of all trajectories at each of these steps.
type Course = Vec<Vec<State<f64, 1>>>;

/// Starts all around the orbit.
fn starts() -> Vec<State<f64, 1>> {
    let start = |n: usize| {
        let angle = core::f64::consts::TAU * n as f64 / COUNT as f64;
        State { q: [angle.cos()], v: [SPRING.omega2.sqrt() * angle.sin()] }
    };
    (0..COUNT).map(start).collect()
}

/// With a clock that is not ideal.
fn clocked<C: Clock<f64>>(lab: &Lab<'_>, clock: C, steps: &[u64]) -> Result<Course, StudyError> {
    let setup = Setup::new(All(SPRING), SymplecticEuler).clock(clock);
    let mut loops = Loops::new(setup, DT, SEED, [0.0], &starts(), lab.alone()?)?;
    let mut course = Course::new();
    for &n in steps {
        lab.check()?;
        loops.advance(n - loops.step())?;
        course.push((0..COUNT).filter_map(|i| loops.state(i)).collect());
    }
    Ok(course)
}

/// With a force that is late; before the first one arrives, that of the start acts.
fn late(lab: &Lab<'_>, latency: f64, steps: &[u64]) -> Result<Course, StudyError> {
    let latency =
        Latency::of_steps(latency).ok_or_else(|| StudyError::Exact("making a latency".into()))?;
    let setup = Setup::new(All(BaselineOnly(Oscillator { omega2: 0.0 })), SymplecticEuler)
        .controller(Force(SPRING))
        .delay(Schedule::late(latency));
    let mut course = vec![Vec::with_capacity(COUNT); steps.len()];
    for start in starts() {
        lab.check()?;
        let before = [-SPRING.omega2 * start.q[0]];
        let mut one = Loops::new(setup, DT, SEED, before, &[start], lab.alone()?)?;
        for (states, &n) in course.iter_mut().zip(steps) {
            one.advance(n - one.step())?;
            states.extend(one.state(0));
        }
    }
    Ok(course)
}

/// With numbers of few bits: the state, the parameters and every operation.
fn rounded<T: Float>(steps: &[u64]) -> Course {
    let (spring, dt) = (Oscillator { omega2: T::from_f64(SPRING.omega2) }, T::from_f64(DT));
    let mut course = vec![Vec::with_capacity(COUNT); steps.len()];
    for start in starts() {
        let mut state = start.map(T::from_f64);
        let mut taken = 0;
        for (states, &n) in course.iter_mut().zip(steps) {
            for _ in taken..n {
                state = SymplecticEuler.step(&spring, state, dt);
            }
            taken = n;
            states.push(state.map(T::to_f64));
        }
    }
    course
}
