//! One orbit at many time steps at once: the first unstable one.

use libration::ensemble::{BatchFloat, Execution};
use libration::equations::{Program, Recorded};
use libration::{Elementary, Method, Scalar};

use super::energy::Drift;
use super::{Orbits, Problem};

/// An orbit about an equilibrium is lost if it has grown by this factor.
const GROWN: f64 = 1e3;

/// Time steps that are tried together. What lies beyond the first loss is tried in vain, so not too
/// many; enough that blocks are full, whatever the system.
const TOGETHER: usize = 416;

/// The first of the time steps `dts` at which `steps` steps of `method` from `start` lose the orbit, with the instruction set of
/// `execution`.
///
/// It is looked at after every step. A lane holds the bits of the lone trajectory, so it makes no
/// difference how many are tried together.
pub(super) fn first_unstable(
    execution: &Execution,
    problem: &Problem,
    orbits: Orbits,
    start: &[f64],
    method: Method,
    dts: &[f64],
    steps: u64,
) -> Option<usize> {
    let bound = Bound::new(problem, orbits, start);
    let program = bound.watched_step(problem, method);
    for (i, dts) in dts.chunks(TOGETHER).enumerate() {
        let mut rows: Vec<Vec<f64>> = start.iter().map(|&x| vec![x; dts.len()]).collect();
        rows.push(dts.to_vec());
        rows.push(vec![0.0; dts.len()]);
        f64::iterate(&program, &mut rows, steps, execution.instruction_set());
        let (states, watched) = rows.split_at(start.len());
        // What is not finite once remains so; what is not a number is within no bound.
        let stays = |lane: usize| {
            watched[1][lane] <= bound.reach() && states.iter().all(|row| row[lane].is_finite())
        };
        if let Some(lost) = (0..dts.len()).position(|lane| !stays(lane)) {
            return Some(i * TOGETHER + lost);
        }
    }
    None
}

/// The distance of two states, velocities divided by `omega`.
pub(super) fn distance<S: Elementary>(a: &[S], b: &[S], omega: S) -> S {
    let half = a.len() / 2;
    let squares = |places: core::ops::Range<usize>| {
        places.fold(S::zero(), |sum, i| sum + (a[i] - b[i]) * (a[i] - b[i]))
    };
    (squares(0..half) + squares(half..a.len()).quotient(omega * omega)).sqrt()
}

/// The bound of an orbit; an orbit beyond it is lost.
#[derive(Clone, Debug)]
enum Bound {
    /// The change of its energy from `start`.
    Energy { start: f64, change: f64 },
    /// The distance from a state, velocities divided by `omega`.
    Distance { from: Vec<f64>, omega: f64, reach: f64 },
}

impl Bound {
    fn new(problem: &Problem, orbits: Orbits, start: &[f64]) -> Self {
        match orbits {
            Orbits::Configured => {
                let energy = Drift::new(problem, start).initial();
                Bound::Energy { start: energy, change: energy.abs().max(f64::MIN_POSITIVE) }
            }
            Orbits::Small => {
                let from = problem.equilibrium.clone().unwrap_or_else(|| start.to_vec());
                let omega = problem.omega();
                let reach = GROWN * distance(start, &from, omega);
                Bound::Distance { from, omega, reach }
            }
        }
    }

    fn reach(&self) -> f64 {
        match self {
            Bound::Energy { change, .. } => *change,
            Bound::Distance { reach, .. } => *reach,
        }
    }

    /// A step from positions, velocities, the time step and how far the orbit has come, to the same.
    fn watched_step(&self, problem: &Problem, method: Method) -> Program {
        let step = problem.step_program(method);
        let step = step.program();
        let states = 2 * problem.degrees();
        Program::record(states + 2, |x| {
            let (dt, furthest) = (x[states], x[states + 1]);
            let mut inputs = x[..states].to_vec();
            inputs.resize(states + problem.dynamics.inputs(), Recorded::zero());
            inputs.push(dt);
            let mut ends: Vec<Recorded> = step.on::<Recorded>().run(&inputs).collect();
            let reached = match self {
                Bound::Energy { start, .. } => {
                    let change = problem.dynamics.energy().and_then(|energy| {
                        let energy = energy.on::<Recorded>().run(&ends).next()?;
                        Some((energy - Recorded::from_f64(*start)).abs())
                    });
                    change.unwrap_or_else(Recorded::zero)
                }
                Bound::Distance { from, omega, .. } => {
                    let from: Vec<Recorded> = from.iter().map(|&x| Recorded::from_f64(x)).collect();
                    distance(&ends, &from, Recorded::from_f64(*omega))
                }
            };
            ends.extend([dt, furthest.max(reached)]);
            ends
        })
    }
}

#[cfg(test)]
mod tests {
    use libration::State;
    use libration::system::{Duffing, Kepler, Pendulum};

    use super::*;

    const STEPS: u64 = 600;

    fn kepler() -> Problem {
        let start = State { q: [0.4, 0.0], v: [0.0, 2.0] };
        Problem::new("kepler", Kepler { mu: 1.0 }, start, std::f64::consts::TAU)
    }

    fn pendulum() -> Problem {
        let turn = std::f64::consts::TAU / 9.81_f64.sqrt();
        let start = State { q: [2.0], v: [0.0] };
        Problem::new("pendulum", Pendulum { omega2: 9.81 }, start, turn).with_equilibrium(State::<
            f64,
            1,
        >::origin(
        ))
    }

    /// The verdict over one orbit, step by step.
    fn is_lost_alone(
        problem: &Problem,
        orbits: Orbits,
        start: &[f64],
        method: Method,
        dt: f64,
    ) -> bool {
        let mut drift = Drift::new(problem, start);
        let (initial, omega) = (drift.initial(), problem.omega());
        let at = problem.equilibrium.as_deref().unwrap_or(start);
        let mut gone = false;
        let mut watch = |_, state: &[f64]| {
            gone |= match orbits {
                Orbits::Configured => {
                    let change = (drift.energy(state) - initial).abs();
                    !change.is_finite() || change > initial.abs()
                }
                Orbits::Small => distance(state, at, omega) > GROWN * distance(start, at, omega),
            };
        };
        // A run stops where a state is not finite.
        problem.run(method, start, dt, STEPS, &mut watch).is_err() || gone
    }

    fn first(
        problem: &Problem,
        orbits: Orbits,
        start: &[f64],
        method: Method,
        dts: &[f64],
    ) -> Option<usize> {
        first_unstable(&Execution::serial(), problem, orbits, start, method, dts, STEPS)
    }

    /// Compares the verdicts at steps of all sizes, and returns how many were lost.
    fn lost_as_alone(problem: &Problem, orbits: Orbits, start: &[f64]) -> usize {
        // Up to ωΔt = 6, where some overflow.
        let dts: Vec<f64> = (1..=30).map(|i| problem.turn * 0.033 * f64::from(i)).collect();
        let mut count = 0;
        for method in Method::ALL {
            let alone: Vec<bool> =
                dts.iter().map(|&dt| is_lost_alone(problem, orbits, start, method, dt)).collect();
            for (dt, &alone) in dts.iter().zip(&alone) {
                let lost = first(problem, orbits, start, method, &[*dt]);
                assert_eq!(lost, alone.then_some(0), "{method:?}, {dt} s");
            }
            let together = first(problem, orbits, start, method, &dts);
            assert_eq!(together, alone.iter().position(|&lost| lost), "{method:?}");
            count += alone.iter().filter(|&&lost| lost).count();
        }
        count
    }

    #[test]
    fn orbits_that_are_tried_together_are_lost_as_they_are_alone() {
        let all = 30 * Method::ALL.len();
        let (kepler, pendulum) = (kepler(), pendulum());
        let well = Duffing { alpha: 1.0, beta: 1.0 };
        let well = Problem::new("well", well, State { q: [1.5], v: [0.0] }, 4.4);
        for lost in [
            lost_as_alone(&kepler, Orbits::Configured, &kepler.start),
            lost_as_alone(&pendulum, Orbits::Configured, &pendulum.start),
            lost_as_alone(&well, Orbits::Configured, &well.start),
            lost_as_alone(&pendulum, Orbits::Small, &[1e-6, -2e-6]),
        ] {
            assert!(lost > 0 && lost < all, "{lost} of {all}");
        }
    }

    #[test]
    fn the_first_loss_is_found_behind_those_that_are_tried_before() {
        let kepler = kepler();
        let mut dts = vec![0.01; 3 * TOGETHER];
        dts[2 * TOGETHER + 7] = 0.5;
        dts[2 * TOGETHER + 9] = 0.5;
        let lost = first(&kepler, Orbits::Configured, &kepler.start, Method::VelocityVerlet, &dts);
        assert_eq!(lost, Some(2 * TOGETHER + 7));
    }

    #[test]
    fn a_start_that_is_not_finite_is_lost() {
        let start = [f64::INFINITY, 0.0, 0.0, 1.0];
        let lost = first(&kepler(), Orbits::Configured, &start, Method::Rk4, &[0.01]);
        assert_eq!(lost, Some(0));
    }
}
