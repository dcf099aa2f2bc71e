//! Advice on loops around linear plants.

use libration::linear::{LoopStability, Signal};
use libration_analyze::linear_analysis::hidden_loop;
use libration_report::verdict::Verdict;
use libration_settings::linear_loop::Part;
use libration_work::Work;

use super::live_setting::live_setting;
use super::margins::margins;
use super::{Deviation, LinearAdvice, LinearRequest, SignalName};
use crate::imperfection::Imperfection;
use crate::loops::LoopError;
use crate::request::{Measure, Tolerance};
use crate::stability_map::StabilityMap;
use crate::{AdviseError, Budget};

/// Advises on a loop around a linear plant.
///
/// # Errors
/// [`AdviseError`]; errors of the request are returned before any work.
pub fn advise(work: &Work<'_>, request: &LinearRequest) -> Result<LinearAdvice, AdviseError> {
    let timed = &request.timed;
    let stated = timed.stated().map_err(LoopError::from)?;
    let ideal = timed.ideal();
    if let Some(why) = request.redesign_obstacle().filter(|_| request.redesign) {
        return Err(AdviseError::Redesign(why));
    }
    let ideal_stability = timed.stability(&ideal).map_err(LoopError::from)?;
    if let Some(plant) = ideal_stability.hidden_by {
        return Ok(LinearAdvice::unknown(request, &ideal_stability, plant));
    }
    if let Some(motions) = timed.unstable_modes().map_err(LoopError::from)? {
        return advise_unstable(work, request, motions);
    }
    // Refused before any work, if it is impossible.
    let redesign = if request.redesign { Some(request.redesign()?) } else { None };
    let tolerance = match request.cost_tolerance {
        Some(most) => Tolerance { of: Measure::Cost, most },
        None => Tolerance { of: Measure::Trajectory, most: 1.0 },
    };
    let subjects = timed.subjects(true);
    let command = |_: &_| format!("{} --json", request.invocation);
    let budgets = timed.budgets(work, &subjects, tolerance, &command)?;
    let fails_first = timed.fails_first(&subjects, &budgets).map_err(LoopError::from)?;
    let stability = timed.stability(&stated).map_err(LoopError::from)?;
    let stable = stability.is_stable();
    let ideal_cost = timed.cost(&ideal).map_err(LoopError::from)?;
    let cost = match stable {
        true => timed.cost(&stated).map_err(LoopError::from)?,
        false => f64::INFINITY,
    };
    let cost = Some(cost).filter(|cost| cost.is_finite());
    let (margin, margin_tried_up_to) = match stable && !stated.is_ideal() {
        true => {
            let found = timed.margin(ideal_cost, tolerance, &budgets).map_err(LoopError::from)?;
            (found.0, Some(found.1))
        }
        false => (None, None),
    };
    let growth = stability.growth;
    let simulated = if stable { request.simulated_cost(work, growth)? } else { None };
    let motion = match request.system_loop() {
        Some(system) if stable => system.motion(&timed.linear, &stated, growth, work)?,
        _ => None,
    };
    let map = request.stability_map(work, &budgets)?;
    let redesign = redesign.map(|design| request.evaluated(work, &design, cost)).transpose()?;
    let mut advice = LinearAdvice {
        chain: request.latency_chain(&budgets),
        margins: margins(&timed.linear, &stated)?,
        budgets,
        fails_first,
        growth,
        margin,
        margin_tried_up_to,
        ideal_cost,
        cost,
        cost_increase: cost.map(|cost| cost / ideal_cost - 1.0),
        deviations: request.deviations(stable)?,
        simulated,
        motion,
        deadline_misses: request.deadline_misses(&stated)?,
        remedies: (!stable).then(|| timed.stabilising_changes(&stated)),
        redesign,
        map,
        ..LinearAdvice::of_request(request)
    };
    advice.conclude(request, &stability);
    Ok(advice)
}

/// Advises on a loop that is not stable without imperfections: what grows, and what changes that. It has no limits.
fn advise_unstable(
    work: &Work<'_>,
    request: &LinearRequest,
    unstable_motions: Vec<String>,
) -> Result<LinearAdvice, AdviseError> {
    let timed = &request.timed;
    let (stated, ideal) = (timed.stated().map_err(LoopError::from)?, timed.ideal());
    let stability = timed.stability(&ideal).map_err(LoopError::from)?;
    let as_stated = match timed.settles(&stated) {
        true => Some(timed.stability(&stated).map_err(LoopError::from)?),
        false => None,
    };
    let cost = match &as_stated {
        Some(_) => timed.cost(&stated).map_err(LoopError::from)?,
        None => f64::INFINITY,
    };
    let mut advice = LinearAdvice {
        growth: as_stated.as_ref().map_or(stability.growth, |own| own.growth),
        cost: Some(cost).filter(|cost| cost.is_finite()),
        unstable_motions,
        // A change that stabilises the loop without its latency may not do so in a stability window of the latency.
        remedies: as_stated.is_none().then(|| timed.stabilising_changes(&stated)),
        motion: match (&as_stated, request.system_loop()) {
            (Some(own), Some(system)) => system.motion(&timed.linear, &stated, own.growth, work)?,
            _ => None,
        },
        stable_as_stated: as_stated,
        map: request.stability_map(work, &[])?,
        ..LinearAdvice::of_request(request)
    };
    advice.conclude(request, &stability);
    Ok(advice)
}

impl LinearAdvice {
    /// The advice on a loop whose stability rounding hides, since the plant alone grows by the factor `plant` in a period. No search of a
    /// limit would know more.
    fn unknown(request: &LinearRequest, stability: &LoopStability, plant: f64) -> Self {
        let mut advice = LinearAdvice {
            growth: stability.growth,
            unstable_motions: vec![hidden_loop(plant)],
            ..LinearAdvice::of_request(request)
        };
        advice.conclude(request, stability);
        advice
    }

    /// The plant and the controller of a request, without any result.
    fn of_request(request: &LinearRequest) -> Self {
        let timed = &request.timed;
        let (plant, controllers) = (timed.linear.plant(), timed.linear.controllers());
        let (plant_modes, part_modes) = request.modes();
        let names = |signals: &[_]| signals.iter().map(SignalName::from).collect();
        LinearAdvice {
            answer: String::new(),
            verdict: Verdict::unknown("not computed"),
            unstable_motions: Vec::new(),
            stable_as_stated: None,
            warnings: Vec::new(),
            states: names(&plant.states),
            inputs: names(&plant.inputs),
            outputs: names(&Part::read(&request.parts, &plant.outputs)),
            operating_point: request.operating_point.clone(),
            plant_modes,
            part_modes,
            controller: request.described_controller(),
            gain: request.design.gain.clone(),
            filter: request.design.filter.clone(),
            controller_matrices: (controllers.periods() == 1).then(|| controllers.at(0).into()),
            schedule: match controllers.periods() {
                1 => Vec::new(),
                periods => (0..periods).map(|k| controllers.at(k).into()).collect(),
            },
            period: timed.period(),
            budgets: Vec::new(),
            fails_first: None,
            chain: Vec::new(),
            margins: Vec::new(),
            growth: f64::NAN,
            margin: None,
            margin_tried_up_to: None,
            ideal_cost: f64::INFINITY,
            cost: None,
            cost_increase: None,
            cost_tolerance: request.cost_tolerance,
            deviations: Vec::new(),
            simulated: None,
            motion: None,
            deadline_misses: None,
            remedies: None,
            redesign: None,
            repeat_command: request.invocation.clone(),
            map: None,
            is_linearised: request.is_linearised,
            live: live_setting(request),
        }
    }

    /// Sets the verdict, the warnings and the answer.
    fn conclude(&mut self, request: &LinearRequest, stability: &LoopStability) {
        self.verdict = self.judged(stability);
        self.warnings = self.warnings_of();
        self.warnings.extend(request.stiffness_warning());
        self.warnings.extend(request.hidden_modes_warning());
        self.answer = self.summary();
    }
}

impl LinearRequest {
    /// The map of stability, if the request asks for it and the plant has one input.
    fn stability_map(
        &self,
        work: &Work<'_>,
        budgets: &[Budget],
    ) -> Result<Option<StabilityMap>, AdviseError> {
        if !self.map || self.timed.linear.plant().inputs.len() != 1 {
            return Ok(None);
        }
        let limit = budgets.iter().find(|budget| budget.kind == Imperfection::Latency);
        self.timed.map(work, limit.and_then(|budget| budget.stable_up_to)).map(Some)
    }

    /// The controller in words, and what its design does not know.
    fn described_controller(&self) -> String {
        let mut text = self.design.description.clone();
        let filters = self.parts.iter().filter(|part| part.is_discrete());
        let filters: Vec<&str> = filters.map(|part| part.name.as_str()).collect();
        if self.design.weights.is_some() && !filters.is_empty() {
            text += &format!("; the design does not know {}", filters.join(", "));
        }
        text
    }

    /// The standard deviations of the states under noise.
    fn deviations(&self, stable: bool) -> Result<Vec<Deviation>, AdviseError> {
        let timed = &self.timed;
        let known = stable && timed.timing.record.is_none();
        let stated = match known {
            true => {
                let stated = timed.stated().map_err(LoopError::from)?;
                timed.linear.stationary(&stated).map_err(LoopError::from)?
            }
            false => None,
        };
        let ideal = timed.linear.stationary(&timed.ideal()).map_err(LoopError::from)?;
        let ideal = ideal.map(|ideal| ideal.deviations).unwrap_or_default();
        let row = |(i, (signal, ideal)): (usize, (&Signal, f64))| Deviation {
            state: signal.name.clone(),
            unit: signal.unit.clone(),
            ideal,
            stated: stated.as_ref().map(|stated| stated.deviations[i]),
        };
        Ok(timed.linear.plant().states.iter().zip(ideal).enumerate().map(row).collect())
    }
}
