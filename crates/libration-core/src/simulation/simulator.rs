//! The loop that runs an integrator on a system.

use core::cell::Cell;

use thiserror::Error;

use super::{CountedSystem, Observer, Sample};
use crate::{Float, Integrator, State, System};

/// Error of a simulation.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum SimulationError {
    /// The time step is not a positive finite number of its float type.
    #[error("dt = {dt} s: expected a positive finite time step in {float}")]
    TimeStep {
        /// The requested time step, in seconds.
        dt: f64,
        /// The float type it was rounded to.
        float: &'static str,
    },
    /// The start has a coordinate that is infinite or not a number.
    #[error("the start is not finite in {float}: coordinate {coordinate} of q, v is {value}")]
    Start {
        /// Index among `q₀ … q_{D−1}, v₀ … v_{D−1}`.
        coordinate: usize,
        /// The value there.
        value: f64,
        /// The float type it was rounded to.
        float: &'static str,
    },
    /// A coordinate overflowed or became undefined.
    #[error("the state stopped being finite at step {step} (t = {time} s)")]
    NotFinite {
        /// The first step whose result is not finite.
        step: u64,
        /// Its time in seconds.
        time: f64,
    },
}

/// One trajectory of a system: state, integer clock and count of force evaluations.
#[derive(Clone, Debug)]
pub struct Simulator<Sys, I, S, const D: usize> {
    system: Sys,
    integrator: I,
    dt: S,
    step: u64,
    state: State<S, D>,
    evaluations: Cell<u64>,
}

impl<Sys, I, S, const D: usize> Simulator<Sys, I, S, D>
where
    Sys: System<S, D> + Copy,
    I: Integrator,
    S: Float,
{
    /// A trajectory of `system` from `start`, in steps of `dt` seconds.
    ///
    /// # Errors
    /// If `dt` is not positive and finite, or a coordinate of `start` is not finite.
    pub fn new(
        system: Sys,
        integrator: I,
        start: State<S, D>,
        dt: S,
    ) -> Result<Self, SimulationError> {
        check(&start, dt)?;
        Ok(Simulator { system, integrator, dt, step: 0, state: start, evaluations: Cell::new(0) })
    }

    /// Takes `steps` steps; `observer` sees the start (at step 0) and the state after each step.
    ///
    /// # Errors
    /// [`SimulationError::NotFinite`] names the first step whose result is not finite. The
    /// observer has seen all steps before it, and the simulator stands at the last of them.
    pub fn run(
        &mut self,
        steps: u64,
        observer: &mut impl Observer<S, D>,
    ) -> Result<(), SimulationError> {
        if self.step == 0 {
            observer.observe(&self.sample());
        }
        for _ in 0..steps {
            let counted = CountedSystem::new(self.system, &self.evaluations);
            let next = self.integrator.step(&counted, self.state, self.dt);
            if !next.coordinates().all(Float::is_finite) {
                let step = self.step + 1;
                return Err(SimulationError::NotFinite { step, time: self.time_of(step) });
            }
            self.step += 1;
            self.state = next;
            observer.observe(&self.sample());
        }
        Ok(())
    }

    /// The current sample of the trajectory.
    #[inline(always)]
    pub fn sample(&self) -> Sample<S, D> {
        Sample { step: self.step, time: self.time_of(self.step), state: self.state }
    }

    /// Force evaluations so far, counted.
    pub fn evaluations(&self) -> u64 {
        self.evaluations.get()
    }

    /// The clock is a step counter times `Δt`: a running sum of steps would drift.
    #[inline(always)]
    fn time_of(&self, step: u64) -> f64 {
        step as f64 * self.dt.to_f64()
    }
}

/// Apart from [`Simulator::new`], since it depends on neither system nor integrator: it is then
/// compiled once for each number type and dimension, not once for each simulator of the catalogue.
fn check<S: Float, const D: usize>(start: &State<S, D>, dt: S) -> Result<(), SimulationError> {
    if !(dt > S::zero() && dt.is_finite()) {
        return Err(SimulationError::TimeStep { dt: dt.to_f64(), float: S::NAME });
    }
    let mut coordinates = start.coordinates().enumerate();
    match coordinates.find(|(_, x)| !x.is_finite()) {
        None => Ok(()),
        Some((coordinate, value)) => {
            Err(SimulationError::Start { coordinate, value: value.to_f64(), float: S::NAME })
        }
    }
}
