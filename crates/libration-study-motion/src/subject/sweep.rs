//! One orbit at many time steps at once: the first unstable one.

use core::ops::Range;

use libration::ensemble::{All, EnsembleError, Execution, Lanes, Observer, PerTrajectory};
use libration::system::BaselineOnly;
use libration::{Ensemble, Hamiltonian, Method, Model, State, with_method};

use super::{Orbits, Problem};

/// An orbit about an equilibrium is lost if it has grown by this factor.
const GROWN: f64 = 1e3;

/// Time steps that are tried together. What lies beyond the first loss is tried in vain, so not too
/// many; enough that blocks are full, whatever the system.
const TOGETHER: usize = 416;

/// The first of the time steps `dts` at which `steps` steps of `method` from `start` lose the orbit, as `execution` runs it.
///
/// It is looked at after every step. A lane holds the bits of the lone trajectory, so it makes no
/// difference how many are tried together.
pub(super) fn first_unstable<M: Model<D>, const D: usize>(
    execution: &Execution,
    problem: &Problem<M, D>,
    orbits: Orbits,
    start: &State<f64, D>,
    method: Method,
    dts: &[f64],
    steps: u64,
) -> Result<Option<usize>, EnsembleError>
where
    M::On<f64>: Send + Sync,
{
    let system = BaselineOnly(problem.model.on::<f64>());
    let bound = Bound::new(problem, &system, orbits, start);
    for (i, dts) in dts.chunks(TOGETHER).enumerate() {
        let watch = |range| BoundObserver::new(range, system, bound);
        let mut ensemble = Ensemble::from_fn(dts.len(), execution.clone(), |_| *start)?;
        // The one place in which a method becomes a type for many trajectories.
        let watched = with_method!(method, |m| {
            ensemble.observe(m, All(system), PerTrajectory(dts), steps, 1, watch)
        })?;
        let mut stays = watched.iter().flat_map(|watch| &watch.stays);
        if let Some(lost) = stays.position(|stays| !stays) {
            return Ok(Some(i * TOGETHER + lost));
        }
    }
    Ok(None)
}

/// The distance of two states, velocities divided by `omega`.
#[inline(always)]
pub(super) fn distance<const D: usize>(a: &State<f64, D>, b: &State<f64, D>, omega: f64) -> f64 {
    let mut squares = [0.0; 2];
    for i in 0..D {
        squares[0] += (a.q[i] - b.q[i]) * (a.q[i] - b.q[i]);
        squares[1] += (a.v[i] - b.v[i]) * (a.v[i] - b.v[i]);
    }
    (squares[0] + squares[1] / (omega * omega)).sqrt()
}

/// The bound of an orbit; an orbit beyond it is lost.
#[derive(Clone, Copy, Debug)]
enum Bound<const D: usize> {
    /// The change of its energy from `start`.
    Energy { start: f64, change: f64 },
    /// The distance from a state, velocities divided by `omega`.
    Distance { from: State<f64, D>, omega: f64, reach: f64 },
}

impl<const D: usize> Bound<D> {
    fn new<M: Model<D>>(
        problem: &Problem<M, D>,
        system: &impl Hamiltonian<f64, D>,
        orbits: Orbits,
        start: &State<f64, D>,
    ) -> Self {
        match orbits {
            Orbits::Configured => {
                let energy = system.energy(start);
                Bound::Energy { start: energy, change: energy.abs().max(f64::MIN_POSITIVE) }
            }
            Orbits::Small => {
                let from = problem.equilibrium.unwrap_or(*start);
                let omega = std::f64::consts::TAU / problem.turn;
                Bound::Distance { from, omega, reach: GROWN * distance(start, &from, omega) }
            }
        }
    }
}

/// Notes which orbits stay within a bound, and finite.
struct BoundObserver<Sys, const D: usize> {
    first: usize,
    system: Sys,
    bound: Bound<D>,
    stays: Vec<bool>,
}

impl<Sys, const D: usize> BoundObserver<Sys, D> {
    fn new(orbits: Range<usize>, system: Sys, bound: Bound<D>) -> Self {
        BoundObserver { first: orbits.start, system, bound, stays: vec![true; orbits.len()] }
    }
}

impl<Sys: Hamiltonian<f64, D> + Send, const D: usize> Observer<f64, D> for BoundObserver<Sys, D> {
    // One index for all planes, whose lengths are the same: so the loops become vectors.
    #[allow(clippy::needless_range_loop)]
    #[inline(always)]
    fn observe(&mut self, lanes: &Lanes<'_, f64, D>) {
        let stays = &mut self.stays[lanes.first - self.first..][..lanes.len()];
        // Of known lengths: a check within the loop would cost it its vectors.
        let (mut q, mut v) = (lanes.q, lanes.v);
        for plane in q.iter_mut().chain(&mut v) {
            *plane = &plane[..stays.len()];
        }
        let state = |l: usize| {
            let mut state = State { q: [0.0; D], v: [0.0; D] };
            for i in 0..D {
                (state.q[i], state.v[i]) = (q[i][l], v[i][l]);
            }
            state
        };
        let finite = |state: &State<f64, D>| {
            (0..D).fold(true, |all, i| all & state.q[i].is_finite() & state.v[i].is_finite())
        };
        // What is not a number is within no bound.
        match self.bound {
            Bound::Energy { start, change } => {
                for l in 0..stays.len() {
                    let state = state(l);
                    let changed = (self.system.energy(&state) - start).abs();
                    stays[l] &= (changed <= change) & finite(&state);
                }
            }
            Bound::Distance { from, omega, reach } => {
                for l in 0..stays.len() {
                    let state = state(l);
                    stays[l] &= (distance(&state, &from, omega) <= reach) & finite(&state);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use libration::simulation::Sample;
    use libration::system::{Duffing, Kepler, Pendulum};

    use super::*;

    const STEPS: u64 = 600;

    fn kepler() -> Problem<Kepler<f64>, 2> {
        let start = State { q: [0.4, 0.0], v: [0.0, 2.0] };
        Problem::new("kepler", Kepler { mu: 1.0 }, start, std::f64::consts::TAU)
    }

    fn pendulum() -> Problem<Pendulum<f64>, 1> {
        let turn = std::f64::consts::TAU / 9.81_f64.sqrt();
        let start = State { q: [2.0], v: [0.0] };
        Problem::new("pendulum", Pendulum { omega2: 9.81 }, start, turn)
            .with_equilibrium(State::origin())
    }

    /// The verdict over a simulator of one orbit.
    fn is_lost_alone<M: Model<D>, const D: usize>(
        problem: &Problem<M, D>,
        orbits: Orbits,
        start: &State<f64, D>,
        method: Method,
        dt: f64,
    ) -> bool {
        let system = problem.model.on::<f64>();
        let (initial, omega) = (system.energy(start), std::f64::consts::TAU / problem.turn);
        let at = problem.equilibrium.unwrap_or(*start);
        let mut gone = false;
        let mut watch = |s: &Sample<f64, D>| {
            gone |= match orbits {
                Orbits::Configured => {
                    let change = (system.energy(&s.state) - initial).abs();
                    !change.is_finite() || change > initial.abs()
                }
                Orbits::Small => {
                    distance(&s.state, &at, omega) > GROWN * distance(start, &at, omega)
                }
            };
        };
        // A simulator stops where a state is not finite.
        problem.run(method, *start, dt, STEPS, &mut watch).is_err() || gone
    }

    /// Compares the verdicts at steps of all sizes, and tells how many were lost.
    fn lost_as_alone<M: Model<D>, const D: usize>(
        problem: &Problem<M, D>,
        orbits: Orbits,
        start: &State<f64, D>,
    ) -> usize
    where
        M::On<f64>: Send + Sync,
    {
        // Up to ωΔt = 6, where some overflow.
        let dts: Vec<f64> = (1..=30).map(|i| problem.turn * 0.033 * f64::from(i)).collect();
        let mut count = 0;
        for method in Method::ALL {
            let alone: Vec<bool> =
                dts.iter().map(|&dt| is_lost_alone(problem, orbits, start, method, dt)).collect();
            for (dt, &alone) in dts.iter().zip(&alone) {
                let lost = first_unstable(
                    &Execution::serial(),
                    problem,
                    orbits,
                    start,
                    method,
                    &[*dt],
                    STEPS,
                );
                assert_eq!(lost, Ok(alone.then_some(0)), "{method:?}, {dt} s");
            }
            let first =
                first_unstable(&Execution::serial(), problem, orbits, start, method, &dts, STEPS);
            assert_eq!(first, Ok(alone.iter().position(|&lost| lost)), "{method:?}");
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
            lost_as_alone(&pendulum, Orbits::Small, &State { q: [1e-6], v: [-2e-6] }),
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
        let method = Method::VelocityVerlet;
        let lost = first_unstable(
            &Execution::serial(),
            &kepler,
            Orbits::Configured,
            &kepler.start,
            method,
            &dts,
            STEPS,
        );
        assert_eq!(lost, Ok(Some(2 * TOGETHER + 7)));
    }

    #[test]
    fn a_start_that_is_not_finite_is_lost() {
        let kepler = kepler();
        let start = State { q: [f64::INFINITY, 0.0], v: [0.0, 1.0] };
        let lost = first_unstable(
            &Execution::serial(),
            &kepler,
            Orbits::Configured,
            &start,
            Method::Rk4,
            &[0.01],
            1,
        );
        assert_eq!(lost, Ok(Some(0)));
    }
}
