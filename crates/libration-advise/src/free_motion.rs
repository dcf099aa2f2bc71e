//! Errors of simulations without a loop.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use libration::integrator::{Exact, SUZUKI4};
use libration::system::DynSystem;
use libration::{AnySystem, Float, Hamiltonian, Integrator, Method, Model, State, System};
use libration_work::Work;

use super::AdviseError;
use super::integrator_choice::StepTrial;
use super::request::{Measure, Request};

/// The motion of a system from its start over a horizon.
pub(super) struct FreeMotion<M, const D: usize> {
    pub(super) model: M,
    pub(super) start: State<f64, D>,
    pub(super) horizon: f64,
    pub(super) of: Measure,
    /// The mean rate of the motion, which scales velocities to lengths, in rad/s.
    omega: f64,
    /// The largest rate of the motion, in rad/s.
    fastest: f64,
}

/// Largest number of steps of a run; a search takes hundreds of runs.
const MOST_STEPS: f64 = 2e7;

/// Largest number of steps of a run with a reference of finer steps.
pub(super) const MOST_COMPARED: f64 = 1e6;

/// Reference steps of order four per compared step. Their error is 1/4096 of that of a method of order four.
const FINER: u32 = 8;

/// Safety factor of errors against the reference, so that advised steps meet the tolerance against the true motion.
const WIDER: f64 = 1.001;

/// Steps between two checks of the stop flag.
const LOOK: u64 = 1 << 16;

impl<M: Model<D>, const D: usize> FreeMotion<M, D> {
    /// The motion of `request`.
    pub(super) fn new(work: &Work<'_>, model: M, request: &Request) -> Result<Self, AdviseError> {
        let start = State {
            q: core::array::from_fn(|i| request.q[i]),
            v: core::array::from_fn(|i| request.v[i]),
        };
        let of = request.tolerance.of;
        let tolerance_error = |why: &str| Err(AdviseError::Tolerance { of, why: why.into() });
        if of == Measure::Cost {
            return tolerance_error(
                "a cost requires a loop; add a controller, or set a tolerance of energy, phase or trajectory",
            );
        }
        let loses = matches!(
            request.system,
            AnySystem::DampedOscillator(_) | AnySystem::DrivenOscillator(_)
        );
        if of == Measure::Energy && loses {
            return tolerance_error(
                "the system does not conserve it; set a tolerance of trajectory or phase",
            );
        }
        if of == Measure::Phase && D > 1 {
            return tolerance_error("a phase requires one degree of freedom");
        }
        if of == Measure::Energy && model.on::<f64>().energy(&start) == 0.0 {
            return tolerance_error(
                "the energy at the start is zero, so a relative error is undefined",
            );
        }
        let free =
            FreeMotion { model, start, horizon: request.horizon, of, omega: 1.0, fastest: 1.0 };
        let [omega, fastest] = free.rates(work)?;
        let free = FreeMotion { omega, fastest, ..free };
        let [least, longest] = free.steps();
        if least > longest {
            let why = format!(
                "its motion requires steps of at most {longest:.3e} s, which are {:.1e} steps over the horizon; a search takes at most \
                 {:.0e}; choose a shorter horizon",
                free.horizon / longest,
                free.horizon / least
            );
            return tolerance_error(&why);
        }
        Ok(free)
    }

    /// The angle of the fastest motion in a step of `dt` seconds, in rad.
    pub(super) fn turn(&self, dt: f64) -> f64 {
        self.fastest * dt
    }

    /// The shortest and the longest tried step.
    pub(super) fn steps(&self) -> [f64; 2] {
        let compared = self.of != Measure::Energy && !M::LINEAR;
        let most = if compared { MOST_COMPARED } else { MOST_STEPS };
        let longest = (4.0 / self.fastest).min(self.horizon);
        [self.horizon / most, longest]
    }

    /// The error in numbers of type `S`.
    pub(super) fn lost_in<S: Float>(
        &self,
        work: &Work<'_>,
        method: Method,
        dt: f64,
        most: f64,
    ) -> Result<f64, AdviseError> {
        let acceleration = |state: &State<S, D>| self.model.on::<S>().acceleration(state);
        let true_acceleration = |state: &State<f64, D>| self.model.on::<f64>().acceleration(state);
        let steps = (self.horizon / dt).round().max(1.0) as u64;
        let trajectory = ComparedTrajectory {
            system: DynSystem(&acceleration),
            method,
            start: self.start.map(S::from_f64),
            dt: S::from_f64(dt),
            steps,
        };
        match self.of {
            Measure::Energy => {
                let model = self.model.on::<f64>();
                let first = model.energy(&self.start);
                let energy = |state: &State<f64, D>| ((model.energy(state) - first) / first).abs();
                trajectory.largest(work, most, &mut |state| energy(state))
            }
            _ => {
                let system = DynSystem(&true_acceleration);
                match Exact::new(self.model, dt) {
                    Some(exact) => self.reference_error(work, &trajectory, most, &|state| {
                        exact.step(&system, state, dt)
                    }),
                    None => {
                        let fine = dt / f64::from(FINER);
                        let step = |state| {
                            (0..FINER).fold(state, |state, _| SUZUKI4.step(&system, state, fine))
                        };
                        Ok(self.reference_error(work, &trajectory, most / WIDER, &step)? * WIDER)
                    }
                }
            }
        }
    }

    /// The largest distance from the reference, or the final phase error.
    fn reference_error<S: Float>(
        &self,
        work: &Work<'_>,
        trajectory: &ComparedTrajectory<'_, S, D>,
        most: f64,
        step: &dyn Fn(State<f64, D>) -> State<f64, D>,
    ) -> Result<f64, AdviseError> {
        let mut truth = self.start;
        let mut size = self.size(&truth);
        // The phase error with all turns: a whole turn is no agreement.
        let mut ahead = 0.0_f64;
        let lost = trajectory.largest(work, most, &mut |state| {
            truth = step(truth);
            size = size.max(self.size(&truth));
            if self.of == Measure::Phase {
                let share = self.size(state) / self.size(&truth);
                let turn = self.angle(state, &truth) - ahead;
                ahead += turn - TAU * (turn / TAU).round();
                // A motion of twice or half the amplitude has no comparable phase; a large phase error does not recover.
                let lost = !(0.5..2.0).contains(&share) || ahead.abs() > 4.0 * most + 2.0;
                return if lost { f64::INFINITY } else { 0.0 };
            }
            self.size(&State {
                q: core::array::from_fn(|i| state.q[i] - truth.q[i]),
                v: core::array::from_fn(|i| state.v[i] - truth.v[i]),
            }) / size
        })?;
        Ok(if self.of == Measure::Phase && lost == 0.0 { ahead.abs() } else { lost })
    }

    /// The size of a state with velocities scaled to lengths.
    fn size(&self, state: &State<f64, D>) -> f64 {
        let squares = |x: &[f64; D]| x.iter().map(|x| x * x).sum::<f64>();
        (squares(&state.q) + squares(&state.v) / self.omega.powi(2)).sqrt()
    }

    /// The angle from one state to another in the plane of position and velocity.
    fn angle(&self, a: &State<f64, D>, b: &State<f64, D>) -> f64 {
        let (aq, av) = (a.q[0], a.v[0] / self.omega);
        let (bq, bv) = (b.q[0], b.v[0] / self.omega);
        (aq * bv - av * bq).atan2(aq * bq + av * bv)
    }
}

impl<M: Model<D>, const D: usize> StepTrial for FreeMotion<M, D> {
    fn lost(
        &self,
        work: &Work<'_>,
        method: Method,
        dt: f64,
        most: f64,
    ) -> Result<f64, AdviseError> {
        self.lost_in::<f64>(work, method, dt, most)
    }
}

/// A trajectory that is compared with a reference.
struct ComparedTrajectory<'a, S, const D: usize> {
    system: DynSystem<'a, S, D>,
    method: Method,
    start: State<S, D>,
    dt: S,
    steps: u64,
}

impl<S: Float, const D: usize> ComparedTrajectory<'_, S, D> {
    /// The largest value of `see` after a step, or the first above `most`; infinite if the state is not finite.
    fn largest(
        &self,
        work: &Work<'_>,
        most: f64,
        see: &mut dyn FnMut(&State<f64, D>) -> f64,
    ) -> Result<f64, AdviseError> {
        let (mut state, mut largest) = (self.start, 0.0_f64);
        let mut one = |step: u64| -> Result<ControlFlow<()>, AdviseError> {
            if step.is_multiple_of(LOOK) {
                work.check()?;
            }
            state = self.method.step(&self.system, state, self.dt);
            let here = see(&state.map(S::to_f64));
            largest = if here.is_finite() { largest.max(here) } else { f64::INFINITY };
            Ok(match largest > most || largest.is_infinite() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            })
        };
        for step in 1..=self.steps {
            if one(step)?.is_break() {
                break;
            }
        }
        Ok(largest)
    }
}
