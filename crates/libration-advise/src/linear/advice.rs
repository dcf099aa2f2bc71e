//! The results of advice on loops around linear plants.

use libration::linear::{DiscreteController, LoopStability, Matrix, Signal, StabilityOutcome};
use libration::live::Setting;
use libration_analyze::linear_analysis::{NOT_SIMULATED, SystemMotion, loop_verdict};
use libration_report::verdict::{Outcome, Verdict};
use libration_settings::linear_loop::OperatingPoint;
use serde::{Serialize, Serializer};

use super::{ChainLink, DeadlineMisses, InputMargins, Mode, Redesign};
use crate::advice_verdict::Doubt;
use crate::budget::{Budget, FirstFailure};
use crate::combined_effect::SimulatedCost;
use crate::loop_check::window_parts;
use crate::stabilising_changes::StabilisingChanges;
use crate::stability_map::StabilityMap;
use crate::summary::percent;

/// The advice on a loop around a linear plant; the fields are the keys of `advise --json`.
#[derive(Clone, Debug, Serialize)]
pub struct LinearAdvice {
    /// The answer in a few sentences.
    pub answer: String,
    /// Whether the loop is stable within the tolerance of its cost.
    pub verdict: Verdict,
    /// The motions that do not decay without imperfections, in words, fastest first; empty if the loop is stable without them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unstable_motions: Vec<String>,
    /// The stability with the stated imperfections of a loop that is unstable without them.
    #[serde(skip)]
    pub(super) stable_as_stated: Option<LoopStability>,
    /// The warnings, most urgent first.
    pub warnings: Vec<String>,
    /// The states of the plant, those of lags and filters last.
    pub states: Vec<SignalName>,
    /// Its inputs.
    pub inputs: Vec<SignalName>,
    /// The measurements as the controller reads them: behind a difference they are per second.
    pub outputs: Vec<SignalName>,
    /// The equilibrium at which a system of the catalogue was linearised; none of other plants.
    pub operating_point: Option<OperatingPoint>,
    /// The modes of the plant without lags and filters, the one that grows fastest first.
    pub plant_modes: Vec<Mode>,
    /// Those of the lags and filters in continuous time.
    pub part_modes: Vec<Mode>,
    /// The controller in words.
    pub controller: String,
    /// The gain of `u = −K x`, inputs × states; none of other controllers.
    #[serde(serialize_with = "rows")]
    pub gain: Option<Matrix>,
    /// The gain of the estimator, states × outputs; none of other controllers.
    #[serde(serialize_with = "rows")]
    pub filter: Option<Matrix>,
    /// The controller in state space, with its filters of samples; none for a cascade.
    pub controller_matrices: Option<ControllerMatrices>,
    /// The controllers of all periods of a cascade until it repeats; empty for other controllers.
    pub schedule: Vec<ControllerMatrices>,
    /// The sampling period, in s.
    pub period: f64,
    /// The sizes of each imperfection with which the loop is stable without others.
    pub budgets: Vec<Budget>,
    /// The imperfection that fails first; none without stated imperfections.
    pub fails_first: Option<FirstFailure>,
    /// Each part of the latency by name.
    pub chain: Vec<ChainLink>,
    /// Gain and phase margins at each input, with the stated latencies; empty if the loop is unstable with them, and for a cascade.
    pub margins: Vec<InputMargins>,
    /// The logarithm of the growth factor of second moments per period; below zero the loop is stable. With all stated imperfections, but
    /// without them if the loop is unstable both with and without them.
    pub growth: f64,
    /// The largest common factor of all imperfections with which the loop is stable; none if no limit was found.
    pub margin: Option<f64>,
    /// The largest tried common factor; none without stated imperfections, or if the loop is unstable.
    pub margin_tried_up_to: Option<f64>,
    /// The cost of the ideal loop, per second under the noise of the plant and its measurements; infinite, `null` in JSON, if it is
    /// unstable.
    pub ideal_cost: f64,
    /// The cost with all imperfections; none if it is infinite.
    pub cost: Option<f64>,
    /// `ΔJ/J₀`.
    pub cost_increase: Option<f64>,
    /// The largest tolerated `ΔJ/J₀`, if there is one.
    pub cost_tolerance: Option<f64>,
    /// The standard deviation of each state under noise.
    pub deviations: Vec<Deviation>,
    /// The cost measured by a simulation; none if the loop is unstable, or decays too slowly to simulate.
    pub simulated: Option<SimulatedCost>,
    /// The motion of a system by equations under a stable loop around its linearisation; none of other plants, and if it was not simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<SystemMotion>,
    /// Missed deadlines; none if the request states none.
    pub deadline_misses: Option<DeadlineMisses>,
    /// Changes that stabilise an unstable loop; none if it is stable.
    pub remedies: Option<StabilisingChanges>,
    /// The controller of least cost for the stated timing, if the request asks for it.
    pub redesign: Option<Redesign>,
    /// A command that repeats this advice.
    pub repeat_command: String,
    /// The stability map, if the request asks for it.
    #[serde(skip)]
    pub map: Option<StabilityMap>,
    /// Whether the plant is the linearisation of a nonlinear system.
    #[serde(skip)]
    pub(super) is_linearised: bool,
    /// The setting of the live section of the page; none where the loop has none.
    #[serde(skip)]
    pub live: Option<Setting>,
}

/// The name and unit of a signal.
#[derive(Clone, Debug, Serialize)]
pub struct SignalName {
    /// The name.
    pub name: String,
    /// The unit; empty if it is unknown.
    pub unit: String,
}

impl From<&Signal> for SignalName {
    fn from(signal: &Signal) -> Self {
        SignalName { name: signal.name.clone(), unit: signal.unit.clone() }
    }
}

/// `m' = A m + B y` and `u = C m + D y`, row by row.
#[derive(Clone, Debug, Serialize)]
pub struct ControllerMatrices {
    /// Memory × memory.
    pub a: Vec<Vec<f64>>,
    /// Memory × outputs.
    pub b: Vec<Vec<f64>>,
    /// Inputs × memory.
    pub c: Vec<Vec<f64>>,
    /// Inputs × outputs.
    pub d: Vec<Vec<f64>>,
}

impl From<&DiscreteController> for ControllerMatrices {
    fn from(DiscreteController { a, b, c, d }: &DiscreteController) -> Self {
        let [a, b, c, d] = [a, b, c, d].map(rows_of);
        ControllerMatrices { a, b, c, d }
    }
}

/// The standard deviation of a state at the beginning of a period.
#[derive(Clone, Debug, Serialize)]
pub struct Deviation {
    /// The state.
    pub state: String,
    /// Its unit.
    pub unit: String,
    /// In the ideal loop.
    pub ideal: f64,
    /// With all imperfections; none if it grows without end, or the clock is a record.
    pub stated: Option<f64>,
}

/// The increase of the cost from which a redesign is proposed.
const COSTLY: f64 = 0.01;

impl LinearAdvice {
    /// Whether the loop is stable with the stated imperfections and missed deadlines, its cost is tolerated and the simulation agrees.
    pub fn holds(&self) -> bool {
        self.verdict.is_good()
    }

    /// Makes the verdict unknown. A loop that is unstable without imperfections stays so: no clock or latency decides that.
    pub fn doubt(&mut self, doubt: Doubt) {
        let is_unstable_alone = !self.unstable_motions.is_empty() && self.is_unstable();
        if !is_unstable_alone {
            doubt.apply(&mut self.verdict, &mut self.answer);
        }
    }

    /// The verdict on a loop of this stability with the stated imperfections.
    pub(super) fn judged(&self, stated: &LoopStability) -> Verdict {
        let of_loop = loop_verdict(stated);
        let misses = self.deadline_misses.as_ref();
        let verdict = match () {
            () if let Some(own) = &self.stable_as_stated => {
                let motions = self.unstable_motions.join("; ");
                let verdict = match &self.motion {
                    Some(motion) => motion.judged(loop_verdict(own)),
                    None => loop_verdict(own),
                };
                let evidence = format!("{}; without imperfections {motions}", verdict.evidence);
                let parts = window_parts(self.cost_tolerance.is_some());
                parts.iter().copied().fold(Verdict { evidence, ..verdict }, Verdict::without)
            }
            () if !self.unstable_motions.is_empty() => match stated.outcome {
                StabilityOutcome::Undecided => Verdict::unknown(self.unstable_motions.join("; ")),
                _ => Verdict::new(
                    Outcome::Unstable,
                    format!("without imperfections {}", self.unstable_motions.join("; ")),
                ),
            },
            () if !of_loop.is_good() => of_loop,
            () if let Some(verdict) = self.motion_contradiction() => verdict,
            () if let Some(simulated) = self.simulated.filter(|own| !own.agrees()) => {
                Verdict::unknown(format!(
                    "the simulated cost is {:.5e} ± {:.1e}, the predicted one {:.5e}",
                    simulated.cost, simulated.error, simulated.predicted
                ))
            }
            () if let Some(misses) = misses.filter(|misses| !misses.holds()) => misses.verdict(),
            () if self.exceeds_tolerated_cost() => Verdict::new(
                Outcome::Exceeds,
                format!(
                    "cost {} that of the ideal loop, tolerance {} %",
                    self.cost_increase.map_or("infinitely above".into(), |rise| format!(
                        "{} % above",
                        percent(rise)
                    )),
                    percent(self.cost_tolerance.unwrap_or_default())
                ),
            ),
            () => match &self.motion {
                Some(motion) => motion.judged(of_loop),
                None => of_loop,
            },
        };
        let is_good = verdict.is_good();
        let missing = [
            (self.simulated.is_none(), "a simulation of the loop"),
            (self.is_linearised_only(), NOT_SIMULATED),
            (self.motion.is_some() && misses.is_some(), "the motion of the system with misses"),
        ];
        let missing = missing.into_iter().filter(|(is_missing, _)| is_good && *is_missing);
        missing.fold(verdict, |verdict, (_, part)| verdict.without(part))
    }

    /// The verdict on a motion of the system that does not return; none if it returns or was not simulated.
    pub(super) fn motion_contradiction(&self) -> Option<Verdict> {
        self.motion.as_ref().and_then(SystemMotion::contradiction)
    }

    /// Whether all results are about a linearisation, as the motion of the system was not simulated.
    pub(super) fn is_linearised_only(&self) -> bool {
        self.is_linearised && self.motion.is_none()
    }

    /// Whether a controller that is designed for the stated timing is worth its work: the imperfections cost more than 1 %.
    pub fn is_costly(&self) -> bool {
        self.cost_increase.is_none_or(|increase| increase > COSTLY)
    }

    /// The words for a deviation that is not known.
    pub fn no_deviation(&self) -> &'static str {
        if self.is_unstable() { "infinite" } else { "unknown" }
    }

    /// Whether the loop is unstable without imperfections, and stable as stated.
    pub fn is_stable_as_stated(&self) -> bool {
        self.stable_as_stated.is_some()
    }

    /// Whether the loop is stable as stated, and unstable with less of an imperfection.
    pub(super) fn is_in_window(&self) -> bool {
        self.is_stable_as_stated() || self.budgets.iter().any(|own| own.regained.is_some())
    }

    /// Whether the loop is not known to be stable, with or without the stated imperfections.
    pub fn is_unstable(&self) -> bool {
        !self.is_stable_as_stated() && (self.growth >= 0.0 || !self.unstable_motions.is_empty())
    }

    /// Whether the cost exceeds its tolerance.
    pub(super) fn exceeds_tolerated_cost(&self) -> bool {
        let Some(most) = self.cost_tolerance else { return false };
        self.cost_increase.is_none_or(|increase| increase > most)
    }
}

/// A matrix row by row.
fn rows_of(matrix: &Matrix) -> Vec<Vec<f64>> {
    (0..matrix.rows()).map(|i| matrix.row(i).to_vec()).collect()
}

fn rows<S: Serializer>(matrix: &Option<Matrix>, serializer: S) -> Result<S::Ok, S::Error> {
    matrix.as_ref().map(rows_of).serialize(serializer)
}
