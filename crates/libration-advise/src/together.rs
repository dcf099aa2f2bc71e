//! All that is stated at once: by theory, and simulated.

use libration::analysis::{CostError, Imperfections, Plant};
use libration::control::LqrWeights;
use libration::{Model, State};
use libration_work::Work;

use super::AdviseError;
use super::budget::Budget;
use super::ensemble::{GROUPS, Ran, Run};
use super::loops::{AnyController, Loop, LoopError};
use super::request::{Measure, Request, Tolerance};
use super::returns::Returns;

/// What is left where all imperfections act together.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Together {
    /// The logarithm of the factor by which second moments grow in a period; below zero the loop is stable.
    pub growth: f64,
    /// So many times as large all of them may be before it is not; none where no end was found.
    pub room: Option<f64>,
    /// So many times as large all of them were tried; none where nothing is stated, or where it is not stable.
    pub room_tried: Option<f64>,
    /// The cost of the loop without any of it, per second under unit noise.
    pub ideal_cost: f64,
    /// The cost with all of it; none where it is infinite.
    pub cost: Option<f64>,
    /// `ΔJ/J₀`.
    pub cost_increase: Option<f64>,
    /// What an ensemble measures; none where it would have to run for too long, or where the loop is not stable.
    pub simulated: Option<Simulated>,
    /// Of a nonlinear plant, or one with a limit: from how far it returns.
    pub returns: Option<Returns>,
    /// A command that shows growth and cost.
    pub command: String,
}

impl Together {
    /// Whether it forgets too slowly to be simulated.
    pub(super) fn slow(&self) -> bool {
        MEMORIES / -self.growth >= MOST_PERIODS
    }

    /// Whether a simulation does otherwise than theory says.
    pub fn contradicted(&self) -> bool {
        let returns = self.returns.is_none_or(|r| r.of_asked[0] == r.of_asked[1]);
        !(returns && self.simulated.is_none_or(|s| s.agrees()))
    }
}

impl Simulated {
    /// Whether that is what was predicted, to four standard errors; of rare outbursts too few may have been met.
    pub fn agrees(&self) -> bool {
        let above = self.cost - self.predicted;
        above <= 4.0 * self.error && (self.outbursts || above >= -4.0 * self.error)
    }
}

/// What an ensemble of loops under noise measures.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Simulated {
    /// Loops.
    pub loops: usize,
    /// Periods that count.
    pub periods: u64,
    /// The mean cost at samples under noise that is held for a period.
    pub cost: f64,
    /// Its standard error.
    pub error: f64,
    /// What theory says of just that.
    pub predicted: f64,
    /// Whether rare outbursts make up so much of the cost that few loops miss many of them, and the standard error says little.
    pub outbursts: bool,
}

/// Loops that are simulated.
const COUNT: usize = 256;

/// The kurtosis of the costs of single loops from which on they are made by rare outbursts; of a normal law it is 3, and of 256 loops
/// 3 ± 0.3.
const OUTBURSTS: f64 = 6.0;

/// Periods that may be simulated.
pub(super) const MOST_PERIODS: f64 = 100_000.0;

/// Of a growth: within so many times its inverse everything is forgotten.
pub(super) const MEMORIES: f64 = 20.0;

impl<M: Model<1>> Loop<M> {
    /// What all of it does.
    pub(super) fn together(
        &self,
        work: &Work<'_>,
        plant: &Plant<'_>,
        request: &Request,
        budgets: &[Budget],
    ) -> Result<Together, AdviseError> {
        // A hair beyond each end.
        let ends = budgets.iter().filter_map(|budget| budget.used.filter(|used| *used > 0.0));
        let ends: Vec<f64> = ends.map(|used| (1.0 + 1e-6) / used).collect();
        let stated = self.stated()?;
        let growth = self.growth(plant, &stated).map_err(LoopError::from)?;
        let cost = |imperfections: &Imperfections| {
            self.cost(plant, imperfections, self.weights).map_err(LoopError::from)
        };
        let (ideal_cost, all) = (cost(&Imperfections::NONE)?, cost(&stated)?);
        let finite = Some(all).filter(|cost| cost.is_finite());
        let stable = growth < 0.0;
        let simulated = if stable { self.simulated(work, growth, &stated)? } else { None };
        let returns = if stable { self.returns(work, growth)? } else { None };
        let (room, room_tried) = match stable && stated != Imperfections::NONE {
            true => {
                let (room, tried) = self.room(plant, ideal_cost, request.tolerance, &ends)?;
                (room, Some(tried))
            }
            false => (None, None),
        };
        Ok(Together {
            growth,
            room,
            room_tried,
            ideal_cost,
            cost: finite,
            cost_increase: finite.map(|cost| cost / ideal_cost - 1.0),
            simulated,
            returns,
            command: self.command(&stated, request),
        })
    }

    /// How many times as large all of it may be, until it is unstable or, if a cost is tolerated, costs more; and how many times as large
    /// was tried: up to 16 times, or where the loop becomes too large to be told of.
    fn room(
        &self,
        plant: &Plant<'_>,
        ideal_cost: f64,
        tolerance: Tolerance,
        ends: &[f64],
    ) -> Result<(Option<f64>, f64), AdviseError> {
        const MOST: f64 = 16.0;
        let holds = |share: f64| -> Result<bool, LoopError> {
            let imperfections = self.scaled(share)?;
            if imperfections.loss >= 1.0 {
                return Ok(false);
            }
            Ok(match tolerance {
                Tolerance { of: Measure::Cost, most } => {
                    self.cost(plant, &imperfections, self.weights)? <= (1.0 + most) * ideal_cost
                }
                _ => self.decays(plant, &imperfections)?,
            })
        };
        // Through a record each is costly.
        let (ratio, halvings) = if self.control.record.is_some() { (1.5, 20) } else { (1.125, 40) };
        let narrowed = |mut low: f64, mut high: f64| -> Result<(Option<f64>, f64), AdviseError> {
            for _ in 0..halvings {
                let middle = 0.5 * (low + high);
                if holds(middle)? { low = middle } else { high = middle }
            }
            Ok((Some(low), low))
        };
        if !holds(1.0)? {
            return narrowed(0.0, 1.0);
        }
        // The ends of the budgets are among what is tried, and latencies between which the plant turns by a part of a radian.
        let turn = (self.control.latency * plant.rate()).max(f64::MIN_POSITIVE);
        let step = (0.25 / turn).max((MOST - 1.0) / 128.0);
        let mut low = 1.0;
        while low < MOST {
            let high = (low * ratio).min(low + step).min(MOST);
            let high = ends.iter().copied().filter(|end| *end > low).fold(high, f64::min);
            // A clock that is a thousand times as fast is none.
            if 1.0 + high * self.control.skew < 1e-3 {
                return Ok((None, low));
            }
            match holds(high) {
                Ok(true) => low = high,
                Ok(false) => return narrowed(low, high),
                Err(
                    LoopError::Cost(CostError::Size { .. } | CostError::Turn)
                    | LoopError::Latency { .. },
                ) => return Ok((None, low)),
                Err(error) => return Err(error.into()),
            }
        }
        Ok((None, low))
    }

    /// An ensemble under noise.
    fn simulated(
        &self,
        work: &Work<'_>,
        growth: f64,
        stated: &Imperfections,
    ) -> Result<Option<Simulated>, AdviseError> {
        let memory = MEMORIES / -growth;
        // Of what is not linear small noise is asked for, and what it costs is in proportion.
        let linear = M::LINEAR && !self.limited();
        let intensity = if linear { 1.0 } else { self.small_noise()? };
        if !(memory < MOST_PERIODS && intensity > 0.0) {
            return Ok(None);
        }
        let before = memory.ceil() as u64;
        let mut periods = (20.0 * memory).clamp(2000.0, MOST_PERIODS) as u64;
        if let Some(record) = &self.control.record {
            // Each part of it as often as any other.
            periods = periods.next_multiple_of(record.len().div_ceil(GROUPS) as u64);
        }
        let starts = [State { q: [0.0], v: [0.0] }; COUNT];
        let run = Run { before, periods, starts: &starts, intensity };
        let Some(Ran { costs, .. }) = self.run(work, run)? else { return Ok(None) };
        let costs: Vec<f64> = costs.into_iter().map(|cost| cost / intensity).collect();
        let count = costs.len() as f64;
        let cost = costs.iter().sum::<f64>() / count;
        // Loops that begin at the same place of a record vary about a mean of their own.
        let groups = if self.control.record.is_some() { GROUPS } else { 1 };
        let squares: Vec<f64> = costs
            .chunks(COUNT / groups)
            .flat_map(|group| {
                let mean = group.iter().sum::<f64>() / group.len() as f64;
                group.iter().map(move |x| (x - mean).powi(2))
            })
            .collect();
        let sum: f64 = squares.iter().sum();
        let error = (sum / (count - groups as f64) / count).sqrt();
        let kurtosis = count * squares.iter().map(|x| x * x).sum::<f64>() / (sum * sum);
        let outbursts = kurtosis > OUTBURSTS;
        let held = self.plant().held();
        let weights = LqrWeights { command: 0.0, ..self.weights };
        let predicted = self.cost(&held, stated, weights).map_err(LoopError::from)?;
        Ok(Some(Simulated { loops: COUNT, periods, cost, error, predicted, outbursts }))
    }

    /// Noise that moves the plant by a hundredth of the deviation that was asked for, and asks for a tenth of the command that there is.
    fn small_noise(&self) -> Result<f64, AdviseError> {
        let stated = self.stated()?;
        let square = |position, command| {
            let weights = LqrWeights { position, velocity: 0.0, command };
            self.cost(&self.plant(), &stated, weights).map_err(LoopError::from)
        };
        let moves = (0.01 * self.control.deviation).powi(2) / square(1.0, 0.0)?;
        Ok(match self.controller {
            AnyController::Pid(pid) if pid.gains().most.is_finite() => {
                moves.min((0.1 * pid.gains().most).powi(2) / square(0.0, 1.0)?)
            }
            _ => moves,
        })
    }

    /// Whether its command has a limit.
    pub(super) fn limited(&self) -> bool {
        match self.control.law {
            super::Law::Pid(gains) => gains.most.is_finite(),
            _ => false,
        }
    }
}
