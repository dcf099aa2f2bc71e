//! The implementations of the benchmark, ready to run.

use libration::ensemble::{AnyEnsemble, EnsembleError, Execution};
use libration::integrator::SymplecticEuler;
use libration::system::Oscillator;
use libration::{Float, Integrator, Method, State};

use super::oscillators::oscillators;
use super::passes::Passes;
use super::{Bench, Implementation, Task};

/// Oscillators under symplectic Euler, in one implementation.
pub(crate) trait Rung {
    /// Takes `steps` steps with every trajectory.
    fn advance(&mut self, steps: u64);

    /// Position and velocity of trajectory `n`.
    fn state(&self, n: usize) -> [f64; 2];
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
    let start = |n| task.start(n).map(T::from_f64);
    let states = || (0..task.count).map(start).map(|[q, v]| State { q: [q], v: [v] }).collect();
    let system = Oscillator { omega2: T::from_f64(task.omega2) };
    let blocks = |execution: &Execution, fused| -> Result<Blocks<T>, EnsembleError> {
        Ok(Blocks { ensemble: oscillators::<T>(task, execution)?, dt, fused })
    };
    let alone = execution.clone().threads(1)?;
    Ok(match implementation {
        Implementation::Dynamic => {
            let step = Box::new(move |s| SymplecticEuler.step(&system, s, dt));
            Box::new(Dynamic { states: states(), step })
        }
        Implementation::Scalar => Box::new(Scalar { states: states(), system, dt }),
        Implementation::Temporaries | Implementation::InPlace => {
            let reuse = implementation == Implementation::InPlace;
            let set = execution.instruction_set();
            Box::new(Passes::new(task.count, start, -system.omega2, dt, set, reuse)?)
        }
        Implementation::OneStep => Box::new(blocks(&alone, false)?),
        Implementation::Fused => Box::new(blocks(&alone, true)?),
        Implementation::Threads => Box::new(blocks(execution, true)?),
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
    ensemble: AnyEnsemble<T>,
    dt: T,
    fused: bool,
}

impl<T: Bench> Rung for Blocks<T> {
    fn advance(&mut self, steps: u64) {
        let (passes, steps) = if self.fused { (1, steps) } else { (steps, 1) };
        for _ in 0..passes {
            self.ensemble.advance(Method::SymplecticEuler, self.dt, steps);
        }
    }

    fn state(&self, n: usize) -> [f64; 2] {
        let at = |plane: Option<&[T]>| plane.map_or(f64::NAN, |plane| plane[n].to_f64());
        [at(self.ensemble.q(0)), at(self.ensemble.v(0))]
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
