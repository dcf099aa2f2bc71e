//! Loops around linear plants.

use std::borrow::Cow;

use libration_core::control::Latency;
use num_complex::Complex64;

use crate::{
    Arrival, Averages, ClockedController, ControllerSchedule, DiscreteController, Discretisation,
    Dynamics, LinearLoopError, LinearPlant, LoopTiming, MOST_TURN, Matrix, Period, Stage,
    eigenvalues,
};

/// A loop: a linear plant, and a controller that runs once per period, or a schedule of them.
#[derive(Clone, Debug)]
pub struct LinearLoop {
    plant: LinearPlant,
    controllers: ControllerSchedule,
    /// The controller with a measured clock; none with the nominal one.
    clocked: Option<ClockedController>,
    period: f64,
    cost: Matrix,
    output_noise: Vec<f64>,
    /// Whether the noise of the plant is held through each period.
    holds_noise: bool,
    /// The eigenvalues of the plant, in 1/s.
    motions: Vec<Complex64>,
}

impl LinearLoop {
    /// A loop with a period of `period` seconds. Its cost per second is the form `cost` of states and inputs, under the noise of the
    /// plant and measurement noise of the variances `output_noise`.
    ///
    /// # Errors
    /// [`LinearLoopError`]: numbers that do not fit each other.
    pub fn new(
        plant: LinearPlant,
        controllers: impl Into<ControllerSchedule>,
        period: f64,
        cost: Matrix,
        output_noise: Vec<f64>,
    ) -> Result<Self, LinearLoopError> {
        let controllers = controllers.into();
        let (n, m, p) = (plant.states.len(), plant.inputs.len(), plant.outputs.len());
        for controller in controllers.kinds() {
            controller.fits([m, p])?;
        }
        if [cost.rows(), cost.columns()] != [n + m; 2] || !cost.is_finite() {
            return Err(LinearLoopError::Matrix("cost"));
        }
        let variance = |x: &f64| x.is_finite() && *x >= 0.0;
        if output_noise.len() != p || !output_noise.iter().all(variance) {
            return Err(LinearLoopError::Matrix("output noise"));
        }
        if !(period.is_finite() && period > 0.0) {
            return Err(LinearLoopError::Period(period));
        }
        if let Some(sampled) = plant.sampling_period
            && (sampled / period - 1.0).abs() > 1e-9
        {
            return Err(LinearLoopError::Sampled { period, sampled });
        }
        let motions = match plant.sampling_period {
            None => eigenvalues(&plant.a).unwrap_or_default(),
            Some(_) => Vec::new(),
        };
        Ok(LinearLoop {
            plant,
            controllers,
            clocked: None,
            period,
            cost,
            output_noise,
            holds_noise: false,
            motions,
        })
    }

    /// The eigenvalues of the plant, in 1/s.
    pub(crate) fn motions(&self) -> &[Complex64] {
        &self.motions
    }

    /// Whether the noise of the plant is held through each period.
    pub(crate) fn holds_noise(&self) -> bool {
        self.holds_noise
    }

    /// The cost rate as a form of states and inputs.
    pub fn cost_form(&self) -> &Matrix {
        &self.cost
    }

    /// The variance of the noise of each output.
    pub fn output_noise(&self) -> &[f64] {
        &self.output_noise
    }

    /// The plant.
    pub fn plant(&self) -> &LinearPlant {
        &self.plant
    }

    /// The controller; of a schedule that of its first period.
    pub fn controller(&self) -> &DiscreteController {
        self.controllers.at(0)
    }

    /// The controllers of all periods.
    pub fn controllers(&self) -> &ControllerSchedule {
        &self.controllers
    }

    /// The controller of all periods. `what` requires that there is only one.
    pub(crate) fn only_controller(
        &self,
        what: &'static str,
    ) -> Result<&DiscreteController, LinearLoopError> {
        match self.controllers.periods() {
            1 => Ok(self.controller()),
            periods => Err(LinearLoopError::Schedule { what, periods }),
        }
    }

    /// The period, in s.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Perfect timing.
    pub fn ideal(&self) -> LoopTiming {
        LoopTiming::ideal(self.plant.inputs.len(), self.plant.outputs.len())
    }

    /// The loop with a controller that measures the lengths of periods. Its clock is right, also where periods are longer than they
    /// should be.
    ///
    /// # Errors
    /// As for [`LinearLoop::new`].
    pub fn with_measured_clock(&self, clocked: ClockedController) -> Result<Self, LinearLoopError> {
        let other = self.with_controller(clocked.at(self.period))?;
        Ok(LinearLoop { clocked: Some(clocked), ..other })
    }

    /// The controller of a kind after a period of so many seconds.
    pub(crate) fn controller_after(
        &self,
        kind: usize,
        seconds: f64,
    ) -> Cow<'_, DiscreteController> {
        match &self.clocked {
            Some(clocked) => Cow::Owned(clocked.at(seconds)),
            None => Cow::Borrowed(&self.controllers.kinds()[kind]),
        }
    }

    /// Whether the controller measures the lengths of periods.
    pub fn measures_time(&self) -> bool {
        self.clocked.is_some()
    }

    /// The loop with all commands times `factor`.
    ///
    /// # Errors
    /// As for [`LinearLoop::new`].
    pub fn amplified(&self, factor: f64) -> Result<Self, LinearLoopError> {
        let clocked = self.clocked.as_ref().map(|own| own.amplified(factor));
        let other = self.with_controller(self.controllers.amplified(factor))?;
        Ok(LinearLoop { clocked, ..other })
    }

    /// The loop with another controller, or another schedule of them, with the nominal clock.
    ///
    /// # Errors
    /// As for [`LinearLoop::new`].
    pub fn with_controller(
        &self,
        controllers: impl Into<ControllerSchedule>,
    ) -> Result<Self, LinearLoopError> {
        let LinearLoop { plant, period, cost, output_noise, holds_noise, .. } = self.clone();
        let other = LinearLoop::new(plant, controllers, period, cost, output_noise)?;
        Ok(LinearLoop { holds_noise, ..other })
    }

    /// The loop with another cost rate, a form of states and inputs.
    ///
    /// # Errors
    /// As for [`LinearLoop::new`].
    pub fn with_cost(&self, cost: Matrix) -> Result<Self, LinearLoopError> {
        let LinearLoop { plant, controllers, clocked, period, output_noise, holds_noise, .. } =
            self.clone();
        let other = LinearLoop::new(plant, controllers, period, cost, output_noise)?;
        Ok(LinearLoop { clocked, holds_noise, ..other })
    }

    /// The loop with noise of the plant that is held through each period, and with the cost of the states at the beginning of each
    /// period: what a simulation measures.
    pub fn with_held_noise(&self) -> Self {
        LinearLoop { holds_noise: true, ..self.clone() }
    }

    /// The loop without noise of the plant and the measurements.
    #[must_use]
    pub fn without_noise(&self) -> Self {
        let plant = LinearPlant { g: Matrix::zeros(self.plant.a.rows(), 0), ..self.plant.clone() };
        LinearLoop { plant, output_noise: vec![0.0; self.output_noise.len()], ..self.clone() }
    }

    /// The number of states: those of plant and controller, and all commands and measurements in transit.
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing.
    pub fn size(&self, timing: &LoopTiming) -> Result<usize, LinearLoopError> {
        Ok(self.layout(timing)?.size())
    }

    /// The periods that the loop may have, with each of its controllers.
    pub(crate) fn stages(
        &self,
        timing: &LoopTiming,
        with_cost: bool,
    ) -> Result<Vec<Vec<Stage>>, LinearLoopError> {
        let LoopTiming { jitter, skew, .. } = *timing;
        let turn = 2.0 * self.smooth_rate() * self.period * jitter.rms() * (1.0 + skew);
        if turn.is_nan() || turn > MOST_TURN {
            return Err(LinearLoopError::Turn);
        }
        let nodes = if jitter.rms() > 0.0 { jitter.nodes(turn) } else { vec![(1.0, 0.0)] };
        let varies = jitter.rms() > 0.0;
        let of = |kind| self.stages_of(kind, timing, (&nodes, varies), with_cost);
        (0..self.controllers.kinds().len()).map(of).collect()
    }

    /// The periods with a kind of controller whose lengths deviate from their mean by these parts, with these probabilities, and
    /// whether lengths vary from period to period.
    pub(crate) fn stages_of(
        &self,
        kind: usize,
        timing: &LoopTiming,
        (nodes, varies): (&[(f64, f64)], bool),
        with_cost: bool,
    ) -> Result<Vec<Stage>, LinearLoopError> {
        let mut layout = self.layout(timing)?;
        if varies && self.measures_time() {
            // A controller that uses the length of the last period belongs to that period, which is drawn for itself.
            layout = layout.ending_with_control();
        }
        let LoopTiming { skew, loss, missing, .. } = *timing;
        let LinearPlant { a, b, c, d, g, sampling_period, .. } = &self.plant;
        let noise = g.congruence(&Matrix::identity(g.columns()));
        let (n, m) = (a.rows(), b.columns());
        let mut driven = Matrix::zeros(n, m + g.columns());
        driven.set_block((0, 0), b);
        driven.set_block((0, m), g);
        let step = |seconds: f64, [from, to]: [f64; 2]| match sampling_period {
            None => Discretisation::exact(a, &driven, (to - from) * seconds),
            Some(_) => Discretisation { phi: a.clone(), gamma: driven.clone() },
        };
        let (noises, white) = (g.columns(), sampling_period.is_none());
        let dynamics = match white && !self.holds_noise {
            true => Dynamics::Exact { a, b, noise: &noise },
            false => Dynamics::Stepped { step: &step, noises, white },
        };
        let mut stages = Vec::new();
        for &(weight, epsilon) in nodes {
            let seconds = self.period * (1.0 + skew) * (1.0 + epsilon);
            let period = Period {
                dynamics,
                outputs: [c, d],
                controller: &self.controller_after(kind, seconds),
                layout: &layout,
                output_latency: &timing.output_latency,
                output_noise: &self.output_noise,
                cost: with_cost.then_some(&self.cost),
            };
            for (share, lost) in [(1.0 - loss, None), (loss, Some(missing))] {
                let arrival = |&latency: &Latency| Arrival { latency, lost };
                let arrivals: Vec<Arrival> = timing.input_latency.iter().map(arrival).collect();
                if share > 0.0 {
                    stages.push(period.stage(weight * share, seconds, &arrivals));
                }
            }
        }
        Ok(stages)
    }
}
