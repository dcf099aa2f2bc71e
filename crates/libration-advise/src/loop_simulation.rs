//! Errors of integrators in simulated loops.

use bytemuck::Pod;
use libration::analysis::{Imperfections, Plant};
use libration::control::{Latency, Schedule};
use libration::ensemble::{All, Loops, Setup};
use libration::linear::LinearLoopError;
use libration::system::DynSystem;
use libration::{Float, Method, Model, State, System};
use libration_work::Work;

use super::AdviseError;
use super::integrator_choice::IntegratorChoice;
use super::loops::{Loop, LoopError, ORIGIN, PlantModel};
use super::request::{Measure, Tolerance};

/// A loop simulated over a horizon.
pub(super) struct LoopSimulation<'l, M> {
    pub(super) one: &'l Loop<M>,
    pub(super) horizon: f64,
    pub(super) tolerance: Tolerance,
}

/// Tried steps per period.
const SUBSTEPS: [u64; 17] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384];

/// Steps of order four per period of the reference.
const TRUE: u64 = 512;

/// Largest number of compared periods.
const MOST_PERIODS: u64 = 20_000;

/// The time in s for which a loop is simulated where a request asks for `horizon`: at least a period, and not too many.
pub(super) fn simulated_horizon(horizon: f64, period: f64) -> f64 {
    horizon.clamp(period, MOST_PERIODS as f64 * period)
}

impl<M: PlantModel> LoopSimulation<'_, M> {
    /// The fewest steps per period with which `method` meets the tolerance.
    pub(super) fn choose(
        &self,
        work: &Work<'_>,
        method: Method,
        reference: &[State<f64, 1>],
    ) -> Result<IntegratorChoice, AdviseError> {
        let period = self.one.control.period;
        let most = self.tolerance.most;
        let lost = |substeps: u64| self.lost::<f64>(work, method, substeps, reference);
        let mut choice = IntegratorChoice::none(method);
        let (mut fewer, mut met) = (0, None);
        // The reference is no candidate.
        for substeps in SUBSTEPS.into_iter().filter(|&count| count < self.most_substeps()) {
            let here = lost(substeps)?;
            if here < choice.lost {
                (choice.lost, choice.best_dt) = (here, Some(period / substeps as f64));
            }
            if here <= most {
                met = Some((substeps, here));
                break;
            }
            (fewer, choice.lost_beyond) = (substeps, Some(here));
        }
        let Some((mut enough, mut at)) = met else {
            return Ok(IntegratorChoice { lost_beyond: None, ..choice });
        };
        while enough - fewer > 1 {
            let middle = fewer + (enough - fewer) / 2;
            let here = lost(middle)?;
            match here <= most {
                true => (enough, at) = (middle, here),
                false => (fewer, choice.lost_beyond) = (middle, Some(here)),
            }
        }
        (choice.lost, choice.best_dt) = (at, None);
        (choice.dt, choice.substeps) = (Some(period / enough as f64), Some(enough));
        Ok(choice)
    }

    /// The largest number of steps per period, limited by the number of steps of a latency.
    fn most_substeps(&self) -> u64 {
        let latency = self.one.control.latency / self.one.control.period;
        TRUE.min((Latency::MOST_STEPS as f64 / latency.max(1.0)) as u64)
    }

    /// The states of the reference at the samples.
    pub(super) fn reference(&self, work: &Work<'_>) -> Result<Vec<State<f64, 1>>, AdviseError> {
        match self.tolerance.of {
            Measure::Trajectory => {
                self.sample_states::<f64>(work, Method::Suzuki4, self.most_substeps())
            }
            _ => Ok(Vec::new()),
        }
    }

    /// The error in numbers of type `S`.
    pub(super) fn lost<S: Float + Pod>(
        &self,
        work: &Work<'_>,
        method: Method,
        substeps: u64,
        reference: &[State<f64, 1>],
    ) -> Result<f64, AdviseError> {
        match self.tolerance.of {
            Measure::Trajectory => {
                let course = self.sample_states::<S>(work, method, substeps)?;
                // It starts at rest from the deviation of the request.
                let begins = self.one.control.deviation;
                let far = reference.iter().fold(begins, |far: f64, y| far.max(y.q[0].abs()));
                let fast = reference.iter().fold(0.0, |fast: f64, y| fast.max(y.v[0].abs()));
                let omega = if fast > 0.0 { fast / far } else { 1.0 };
                let size = |q: f64, v: f64| q.hypot(v / omega);
                let off = course
                    .iter()
                    .zip(reference)
                    .map(|(a, b)| size(a.q[0] - b.q[0], a.v[0] - b.v[0]));
                let off = off
                    .fold(0.0, |most: f64, x| if x.is_nan() { f64::INFINITY } else { most.max(x) });
                Ok(off / far)
            }
            Measure::Cost => {
                let (one, period) = (self.one, self.one.control.period);
                let plant = Plant::new(method, one.model, ORIGIN, period).substeps(substeps);
                Ok((self.cost(plant)? / self.cost(one.plant())? - 1.0).abs())
            }
            // Rejected before.
            Measure::Energy | Measure::Phase => Ok(f64::INFINITY),
        }
    }

    /// The cost of the loop with its latency alone.
    fn cost(&self, plant: Plant<'_>) -> Result<f64, LoopError> {
        let one = self.one;
        let late = Imperfections { latency: one.stated_latency()?, ..Imperfections::NONE };
        Ok(plant.with_simulated_noise().cost(&one.linear, &late, one.weights)?)
    }

    /// Whether the cost is finite; true if the tolerance is of another measure.
    pub(super) fn has_finite_cost(&self) -> Result<bool, LoopError> {
        Ok(self.tolerance.of != Measure::Cost || self.cost(self.one.plant())?.is_finite())
    }

    /// The states at the samples of a loop with the stated latency that starts from the deviation of the request.
    fn sample_states<S: Float + Pod>(
        &self,
        work: &Work<'_>,
        method: Method,
        substeps: u64,
    ) -> Result<Vec<State<f64, 1>>, AdviseError> {
        let one = self.one;
        let (model, period) = (one.model, one.control.period);
        let acceleration = |state: &State<S, 1>| model.on::<S>().acceleration(state);
        let latency = one.stated_latency()?.steps();
        let schedule = Schedule::new(substeps as f64, 0.0, latency * substeps as f64);
        let wrong = LoopError::from(LinearLoopError::Latency { periods: latency });
        let schedule = schedule.map_err(|_| wrong)?;
        let setup = Setup::new(All(DynSystem(&acceleration)), method)
            .controller(one.controller)
            .delay(schedule);
        let start = [State { q: [S::from_f64(one.control.deviation)], v: [S::zero()] }];
        let dt = S::from_f64(period / substeps as f64);
        let mut loops = Loops::new(setup, dt, 0, [S::zero()], &start, work.serial()?)?;
        let periods = ((self.horizon / period).round().max(1.0) as u64).min(MOST_PERIODS);
        let mut course = Vec::with_capacity(periods as usize);
        for _ in 0..periods {
            work.check()?;
            loops.advance(substeps)?;
            course.extend(loops.state(0).map(|state| state.map(S::to_f64)));
        }
        Ok(course)
    }
}
