//! The rungs of the ladder: each implementation, ready to run.

use libration::ensemble::{All, EnsembleError, Execution};
use libration::integrator::SymplecticEuler;
use libration::system::Oscillator;
use libration::{Ensemble, Float, Integrator, State};

use super::passes::Passes;
use super::{Bench, Implementation};

/// Oscillators under symplectic Euler, in one implementation.
pub(crate) trait Rung {
    /// Takes `steps` steps with every trajectory.
    fn advance(&mut self, steps: u64);

    /// Position and velocity of trajectory `n`.
    fn state(&self, n: usize) -> [f64; 2];
}

/// What is simulated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Task {
    /// Number of trajectories.
    pub(crate) count: usize,
    /// `ω²`.
    pub(crate) omega2: f64,
    /// The time step, in s.
    pub(crate) dt: f64,
}

impl Task {
    /// Where trajectory `n` starts: each elsewhere, so that none can be left out.
    fn start<T: Float>(&self, n: usize) -> State<T, 1> {
        let share = n as f64 / self.count as f64;
        State { q: [T::from_f64(1.0 + share)], v: [T::from_f64(0.5 - share)] }
    }

    fn system<T: Float>(&self) -> Oscillator<T> {
        Oscillator { omega2: T::from_f64(self.omega2) }
    }
}

/// `task`, to be run by `implementation`, on the instruction set and threads of `execution` as far
/// as it uses any.
///
/// # Errors
/// If the memory is refused.
pub(crate) fn prepare<T: Bench>(
    implementation: Implementation,
    task: Task,
    execution: &Execution,
) -> Result<Box<dyn Rung>, EnsembleError> {
    let dt = T::from_f64(task.dt);
    let states = || (0..task.count).map(|n| task.start::<T>(n));
    let alone = execution.clone().threads(1)?;
    let ensemble = |execution| Ensemble::from_fn(task.count, execution, |n| task.start::<T>(n));
    let system = task.system::<T>();
    Ok(match implementation {
        Implementation::Dynamic => {
            let step = Box::new(move |s| SymplecticEuler.step(&system, s, dt));
            Box::new(Dynamic { states: states().collect(), step })
        }
        Implementation::Scalar => Box::new(Scalar { states: states().collect(), system, dt }),
        Implementation::Temporaries | Implementation::InPlace => {
            let start = states().map(|s| [s.q[0], s.v[0]]);
            let reuse = implementation == Implementation::InPlace;
            let set = execution.instruction_set();
            Box::new(Passes::new(start, -system.omega2, dt, set, reuse)?)
        }
        Implementation::OneStep => {
            Box::new(Blocks { ensemble: ensemble(alone)?, system, dt, fused: false })
        }
        Implementation::Fused => {
            Box::new(Blocks { ensemble: ensemble(alone)?, system, dt, fused: true })
        }
        Implementation::Threads => {
            Box::new(Blocks { ensemble: ensemble(execution.clone())?, system, dt, fused: true })
        }
    })
}

/// Coordinates as doubles.
pub(super) fn doubles<T: Float>(q: T, v: T) -> [f64; 2] {
    [q.to_f64(), v.to_f64()]
}

/// [`Implementation::Dynamic`].
struct Dynamic<T> {
    states: Vec<State<T, 1>>,
    step: Box<dyn Fn(State<T, 1>) -> State<T, 1>>,
}

impl<T: Float> Rung for Dynamic<T> {
    fn advance(&mut self, steps: u64) {
        for state in &mut self.states {
            for _ in 0..steps {
                *state = (self.step)(*state);
            }
        }
    }

    fn state(&self, n: usize) -> [f64; 2] {
        doubles(self.states[n].q[0], self.states[n].v[0])
    }
}

/// [`Implementation::Scalar`].
struct Scalar<T> {
    states: Vec<State<T, 1>>,
    system: Oscillator<T>,
    dt: T,
}

impl<T: Float> Rung for Scalar<T> {
    fn advance(&mut self, steps: u64) {
        for state in &mut self.states {
            let mut current = *state;
            for _ in 0..steps {
                current = SymplecticEuler.step(&self.system, current, self.dt);
            }
            *state = current;
        }
    }

    fn state(&self, n: usize) -> [f64; 2] {
        doubles(self.states[n].q[0], self.states[n].v[0])
    }
}

/// [`Implementation::OneStep`], [`Implementation::Fused`] and [`Implementation::Threads`].
struct Blocks<T: Bench> {
    ensemble: Ensemble<T, 1>,
    system: Oscillator<T>,
    dt: T,
    fused: bool,
}

impl<T: Bench> Rung for Blocks<T> {
    fn advance(&mut self, steps: u64) {
        let (passes, steps) = if self.fused { (1, steps) } else { (steps, 1) };
        for _ in 0..passes {
            let (system, dt) = (All(self.system), All(self.dt));
            // One value for all is never too few or too many.
            let outcome = self.ensemble.advance(SymplecticEuler, system, dt, steps);
            debug_assert_eq!(outcome, Ok(()));
        }
    }

    fn state(&self, n: usize) -> [f64; 2] {
        doubles(self.ensemble.q(0)[n], self.ensemble.v(0)[n])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All states after 37 steps.
    fn states<T: Bench>(implementation: Implementation, count: usize) -> Vec<[f64; 2]> {
        let task = Task { count, omega2: 10.0, dt: 1e-2 };
        let execution = Execution::default();
        let mut rung = prepare::<T>(implementation, task, &execution).expect("small memory");
        rung.advance(30);
        rung.advance(7);
        (0..count).map(|n| rung.state(n)).collect()
    }

    #[test]
    fn all_implementations_give_the_same_bits() {
        for count in [1, 3, 1000] {
            let single = states::<f32>(Implementation::Dynamic, count);
            let double = states::<f64>(Implementation::Dynamic, count);
            assert_ne!(single, double);
            for implementation in Implementation::ALL {
                assert_eq!(states::<f32>(implementation, count), single, "{implementation:?}");
                assert_eq!(states::<f64>(implementation, count), double, "{implementation:?}");
            }
        }
    }
}
