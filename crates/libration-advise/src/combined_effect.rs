//! The effect of all stated imperfections together, by theory and simulation.

use libration::State;
use libration::analysis::{CostError, Imperfections, Plant};
use libration::control::LqrWeights;
use libration::linear::{LinearLoopError, LoopTiming};
use libration_work::Work;

use super::AdviseError;
use super::budget::Budget;
use super::ensemble::{EnsembleResult, EnsembleRun, FORGOTTEN, GROUPS, MEMORIES, MOST_PERIODS};
use super::limits::MOST_LOSS;
use super::loops::{AnyController, Loop, LoopError, PlantModel};
use super::region_of_attraction::RegionOfAttraction;
use super::request::{Measure, Request, Tolerance};
use super::timed_loop::{StatedTiming, TimedLoop};

/// The effect of all stated imperfections together.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct CombinedEffect {
    /// The logarithm of the growth factor of second moments per period; below zero the loop is stable.
    pub growth: f64,
    /// The largest common factor of all imperfections with which the loop is stable; none if no limit was found.
    pub margin: Option<f64>,
    /// The largest tried common factor; none without stated imperfections, or if the loop is unstable.
    pub margin_tried_up_to: Option<f64>,
    /// The cost of the ideal loop, per second under unit noise; infinite, `null` in JSON, if it is unstable.
    pub ideal_cost: f64,
    /// The cost with all imperfections; none if it is infinite.
    pub cost: Option<f64>,
    /// `ΔJ/J₀`.
    pub cost_increase: Option<f64>,
    /// The cost measured by an ensemble; none if the loop is unstable, or decays too slowly to simulate.
    pub simulated: Option<SimulatedCost>,
    /// The region of attraction of a nonlinear plant or a limited command.
    pub region_of_attraction: Option<RegionOfAttraction>,
    /// A command that prints growth and cost.
    pub command: String,
}

impl CombinedEffect {
    /// Whether the loop decays too slowly to simulate.
    pub(super) fn is_slow(&self) -> bool {
        MEMORIES / -self.growth >= MOST_PERIODS
    }

    /// Whether a simulation contradicts the theory.
    pub fn is_contradicted(&self) -> bool {
        let returns = self.region_of_attraction.is_none_or(|r| r.returned[0] == r.returned[1]);
        !(returns && self.simulated.is_none_or(|s| s.agrees()))
    }
}

impl SimulatedCost {
    /// The cost of loops, of which equal parts in this order are groups with a mean each.
    pub(super) fn new(costs: &[f64], groups: usize, periods: u64, predicted: f64) -> Self {
        let count = costs.len() as f64;
        let cost = costs.iter().sum::<f64>() / count;
        let squares: Vec<f64> = costs
            .chunks(costs.len() / groups)
            .flat_map(|group| {
                let mean = group.iter().sum::<f64>() / group.len() as f64;
                group.iter().map(move |x| (x - mean).powi(2))
            })
            .collect();
        let sum: f64 = squares.iter().sum();
        let error = (sum / (count - groups as f64) / count).sqrt();
        let kurtosis = count * squares.iter().map(|x| x * x).sum::<f64>() / (sum * sum);
        let outbursts = kurtosis > OUTBURSTS;
        SimulatedCost { loops: costs.len(), periods, cost, error, predicted, outbursts }
    }

    /// Whether the cost agrees with the prediction to four standard errors. With rare outbursts it may be smaller.
    pub fn agrees(&self) -> bool {
        let above = self.cost - self.predicted;
        above <= 4.0 * self.error && (self.outbursts || above >= -4.0 * self.error)
    }
}

/// The cost measured by an ensemble of loops under noise.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct SimulatedCost {
    /// Number of loops.
    pub loops: usize,
    /// Number of measured periods.
    pub periods: u64,
    /// The mean cost at samples under noise that is constant over a period.
    pub cost: f64,
    /// The standard error of the mean cost.
    pub error: f64,
    /// The predicted cost under the same noise.
    pub predicted: f64,
    /// Whether rare outbursts dominate the cost, so that the standard error is unreliable.
    pub outbursts: bool,
}

/// Number of simulated loops.
const COUNT: usize = 256;

/// Measured periods of each loop, as a multiple of its memory: 100 time constants of the decay of second moments. The standard error
/// of the cost is `2/√(256·100)`, or 1.25 %, where a single time constant dominates.
const MEASURED: f64 = 5.0;

/// Kurtosis of the costs of single loops above which rare outbursts dominate. For a normal law it is 3: for 256 loops 3 ± 0.3,
/// for 64 loops 3 ± 0.6.
const OUTBURSTS: f64 = 6.0;

impl TimedLoop {
    /// The largest common factor of all imperfections within stability and tolerance, and the largest tried factor: up to 16, or
    /// until the loop is too large to analyse.
    pub(super) fn margin(
        &self,
        ideal_cost: f64,
        tolerance: Tolerance,
        budgets: &[Budget],
    ) -> Result<(Option<f64>, f64), LinearLoopError> {
        const MOST: f64 = 16.0;
        /// Part of a period between two trials of a plant with a direct path, where missed windows were 0.05 to 0.35 periods wide.
        const DIRECT: f64 = 0.04;
        // Slightly beyond each limit.
        let ends = budgets.iter().filter_map(|budget| budget.used.filter(|used| *used > 0.0));
        let ends: Vec<f64> = ends.map(|used| (1.0 + 1e-6) / used).collect();
        let holds = |share: f64| -> Result<bool, LinearLoopError> {
            let imperfections = self.scaled(share)?;
            Ok(match tolerance {
                Tolerance { of: Measure::Cost, most } => {
                    self.cost(&imperfections)? <= (1.0 + most) * ideal_cost
                }
                _ => self.decays(&imperfections)?,
            })
        };
        // Trials with a record are expensive.
        let (ratio, halvings) = if self.timing.record.is_some() { (1.5, 20) } else { (1.125, 30) };
        let narrowed =
            |mut low: f64, mut high: f64| -> Result<(Option<f64>, f64), LinearLoopError> {
                for _ in 0..halvings {
                    let middle = 0.5 * (low + high);
                    if holds(middle)? { low = middle } else { high = middle }
                }
                Ok((Some(low), low))
            };
        if !holds(1.0)? {
            return narrowed(0.0, 1.0);
        }
        // The tried factors include the limits of the budgets; the plant turns by a part of a radian between them.
        let StatedTiming { input_latency, output_latency, .. } = &self.timing;
        let longest = input_latency.iter().chain(output_latency).copied().fold(0.0, f64::max);
        let turn = (longest * self.rate()).max(f64::MIN_POSITIVE);
        let step = (0.25 / turn).max((MOST - 1.0) / 128.0);
        // A direct path shows commands that take over at whole periods: windows beside these are narrow, and trials cheap.
        let step = match self.has_direct_path() && self.stated()?.repeats() {
            true => step.min((DIRECT * self.period() / longest).max((MOST - 1.0) / 1500.0)),
            false => step,
        };
        // A probability of a loss is below 1.
        let most = match self.timing.loss {
            0.0 => MOST,
            loss => MOST.min(MOST_LOSS / loss).max(1.0),
        };
        let mut low = 1.0;
        while low < most {
            let high = (low * ratio).min(low + step).min(most);
            let high = ends.iter().copied().filter(|end| *end > low).fold(high, f64::min);
            // A clock a thousand times as fast is invalid.
            if 1.0 + high * self.timing.skew < 1e-3 {
                return Ok((None, low));
            }
            match holds(high) {
                Ok(true) => low = high,
                Ok(false) => return narrowed(low, high),
                Err(
                    LinearLoopError::Size { .. }
                    | LinearLoopError::Turn
                    | LinearLoopError::Latency { .. },
                ) => return Ok((None, low)),
                Err(error) => return Err(error),
            }
        }
        Ok((None, low))
    }
}

impl<M: PlantModel> Loop<M> {
    /// The effect of all stated imperfections.
    pub(super) fn combined_effect(
        &self,
        work: &Work<'_>,
        request: &Request,
        budgets: &[Budget],
    ) -> Result<CombinedEffect, AdviseError> {
        let timed = &self.timed;
        let timing = timed.stated().map_err(LoopError::from)?;
        let stated = self.stated()?;
        let growth = timed.growth(&timing).map_err(LoopError::from)?;
        let cost = |timing: &LoopTiming| timed.cost(timing).map_err(LoopError::from);
        let (ideal_cost, all) = (cost(&timed.ideal())?, cost(&timing)?);
        let finite = Some(all).filter(|cost| cost.is_finite());
        let stable = growth < 0.0;
        let simulated = if stable { self.simulated_cost(work, growth, &stated)? } else { None };
        let region_of_attraction =
            if stable { self.region_of_attraction(work, growth)? } else { None };
        let (margin, margin_tried_up_to) = match stable && stated != Imperfections::NONE {
            true => {
                let (margin, tried) = timed
                    .margin(ideal_cost, request.tolerance, budgets)
                    .map_err(LoopError::from)?;
                (margin, Some(tried))
            }
            false => (None, None),
        };
        Ok(CombinedEffect {
            growth,
            margin,
            margin_tried_up_to,
            ideal_cost,
            cost: finite,
            cost_increase: finite.map(|cost| cost / ideal_cost - 1.0),
            simulated,
            region_of_attraction,
            command: self.command(&timing, request),
        })
    }

    /// The cost of an ensemble under noise.
    fn simulated_cost(
        &self,
        work: &Work<'_>,
        growth: f64,
        stated: &Imperfections,
    ) -> Result<Option<SimulatedCost>, AdviseError> {
        let memory = MEMORIES / -growth;
        // A nonlinear loop gets small noise, and its cost is scaled.
        let linear = M::LINEAR && !self.has_command_limit();
        let intensity = if linear { 1.0 } else { self.small_noise()? };
        if !(memory < MOST_PERIODS && intensity > 0.0) {
            return Ok(None);
        }
        let before = (FORGOTTEN * memory).ceil() as u64;
        let mut periods = (MEASURED * memory).clamp(1000.0, MOST_PERIODS) as u64;
        if let Some(record) = &self.control.record {
            // Each part of the record is used equally often.
            periods = periods.next_multiple_of(record.len().div_ceil(GROUPS) as u64);
        }
        let starts = [State { q: [0.0], v: [0.0] }; COUNT];
        let run = EnsembleRun { before, periods, starts: &starts, intensity };
        let Some(EnsembleResult { costs, .. }) = self.run(work, run)? else { return Ok(None) };
        let costs: Vec<f64> = costs.into_iter().map(|cost| cost / intensity).collect();
        // Loops that begin at the same place of a record have a common mean.
        let groups = if self.control.record.is_some() { GROUPS } else { 1 };
        let held = self.plant().with_simulated_noise();
        let weights = LqrWeights { command: 0.0, ..self.weights };
        let predicted = self.simulated_prediction(&held, stated, weights)?;
        Ok(Some(SimulatedCost::new(&costs, groups, periods, predicted)))
    }

    /// The cost of the loop in steps whose noise is held through a period.
    fn simulated_prediction(
        &self,
        plant: &Plant<'_>,
        stated: &Imperfections,
        weights: LqrWeights,
    ) -> Result<f64, LoopError> {
        let cost = match self.timed.replayed(stated.jitter.rms()) {
            Some(steps) => plant.recorded_cost(&self.linear, stated, &steps, weights),
            None => plant.cost(&self.linear, stated, weights),
        };
        cost.map_err(|error: CostError| error.into())
    }

    /// The intensity of noise that moves the plant by 1 % of the deviation and uses at most 10 % of the command limit.
    fn small_noise(&self) -> Result<f64, AdviseError> {
        let stated = self.timed.stated().map_err(LoopError::from)?;
        let square = |position, command| {
            let weights = LqrWeights { position, velocity: 0.0, command };
            self.cost(&stated, weights)
        };
        let moves = (0.01 * self.control.deviation).powi(2) / square(1.0, 0.0)?;
        Ok(match self.controller {
            AnyController::Pid(pid) if pid.gains().most.is_finite() => {
                moves.min((0.1 * pid.gains().most).powi(2) / square(0.0, 1.0)?)
            }
            _ => moves,
        })
    }

    /// Whether the command has a limit.
    pub(super) fn has_command_limit(&self) -> bool {
        match self.control.law {
            super::Law::Pid(gains) => gains.most.is_finite(),
            _ => false,
        }
    }
}
