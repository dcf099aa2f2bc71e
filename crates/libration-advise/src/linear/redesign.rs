//! The controller of least cost for the stated timing, and its effect.

use libration::linear::{
    DiscreteController, LoopTiming, Redesign as Design, RedesignKind, eigenvalues,
};
use libration_settings::linear_loop::Part;
use libration_work::Work;
use serde::Serialize;

use super::advice::ControllerMatrices;
use super::margins::{InputMargins, margins};
use super::redesign_limits::RedesignLimit;
use super::request::LinearRequest;
use crate::AdviseError;
use crate::loops::LoopError;
use crate::timed_loop::TimedLoop;

/// The controller of least cost for the stated timing.
#[derive(Clone, Debug, Serialize)]
pub struct Redesign {
    /// The method in a sentence.
    pub method: String,
    /// What the user must know of it: assumed noise, a record, a cost above that of the given controller.
    pub notes: Vec<String>,
    /// The controller.
    pub controller_matrices: ControllerMatrices,
    /// The controller and its cost for a request file.
    pub toml: String,
    /// The growth of second moments with all stated imperfections.
    pub growth: f64,
    /// The cost with all stated imperfections; none if it is infinite.
    pub cost: Option<f64>,
    /// The cost with the given controller over this; none if one of the two is infinite.
    pub cost_ratio: Option<f64>,
    /// Gain and phase margins at each input, with the stated latencies.
    pub margins: Vec<InputMargins>,
    /// The sizes of each imperfection with which the loop is stable while all others are as stated.
    pub limits: Vec<RedesignLimit>,
}

impl LinearRequest {
    /// Why there is no redesign for this request.
    pub(super) fn redesign_obstacle(&self) -> Option<&'static str> {
        match () {
            () if !self.redesign_toml.has_weights => Some(
                "a redesign minimises a cost, and the request has none; expected [controller.lqr], [controller.lqg], or `cost` in \
                 [loop]",
            ),
            () if self.parts.iter().any(Part::is_discrete) => Some(
                "a redesign replaces the controller with its filters of samples; expected no [[part]] with `moving-average` or \
                 `difference`",
            ),
            () if self.timed.linear.measures_time() => Some(
                "a redesigned controller uses the nominal period; expected `clock = \"nominal\"` in [loop]",
            ),
            () => None,
        }
    }

    /// The controller of least cost for the stated timing.
    pub(super) fn redesign(&self) -> Result<Design, AdviseError> {
        let stated = self.timed.stated().map_err(LoopError::from)?;
        Ok(self.timed.linear.redesign(&stated).map_err(LoopError::from)?)
    }

    /// The effect of a redesigned controller; `cost_before` is the cost with the given one.
    pub(super) fn evaluated(
        &self,
        work: &Work<'_>,
        design: &Design,
        cost_before: Option<f64>,
    ) -> Result<Redesign, AdviseError> {
        let timed = &self.timed;
        let stated = timed.stated().map_err(LoopError::from)?;
        let linear = timed.linear.with_controller(design.controller.clone());
        let after = TimedLoop { linear: linear.map_err(LoopError::from)?, ..timed.clone() };
        let growth = after.growth(&stated).map_err(LoopError::from)?;
        let cost = match growth < 0.0 {
            true => after.cost(&stated).map_err(LoopError::from)?,
            false => f64::INFINITY,
        };
        let cost = Some(cost).filter(|cost| cost.is_finite());
        let cost_ratio = cost_before.zip(cost).map(|(before, after)| before / after);
        let limits = self.redesign_limits(work, &after)?;
        Ok(Redesign {
            method: self.method(design, &stated),
            notes: self.notes(design, [cost_before, cost]),
            controller_matrices: (&design.controller).into(),
            toml: self.redesign_toml.table(&design.controller),
            growth,
            cost,
            cost_ratio,
            margins: margins(&after.linear, &stated)?,
            limits,
        })
    }

    fn method(&self, design: &Design, stated: &LoopTiming) -> String {
        let memory = design.controller.memory();
        let drawn = match (stated.jitter.rms() > 0.0, stated.loss > 0.0) {
            (true, true) => "drawn periods and losses",
            (true, false) => "drawn periods",
            _ => "losses",
        };
        match design.kind {
            RedesignKind::StateFeedback => format!(
                "LQR of the plant with its commands under way: the feedback of all states and of {memory} commands under way"
            ),
            RedesignKind::RandomStateFeedback => format!(
                "LQR of the plant with its commands under way and {drawn}, by a Riccati equation of second moments: the feedback of all \
                 states and of {memory} commands under way (De Koning 1982)"
            ),
            RedesignKind::Lqg => format!(
                "LQG of the plant with its commands and measurements under way: a regulator of a state that a Kalman filter estimates, \
                 with a memory of {memory}"
            ),
            RedesignKind::Compensator => format!(
                "Optimal compensator of the plant with its commands and measurements under way and {drawn}, by coupled Riccati equations \
                 of regulator and filter, with a memory of {memory} (De Koning 1992); it does not know the length of a period, nor \
                 whether a command is lost"
            ),
        }
    }

    fn notes(&self, design: &Design, [before, after]: [Option<f64>; 2]) -> Vec<String> {
        let mut notes = Vec::new();
        match (before, after) {
            (_, None) => notes.push(
                "the redesigned loop is unstable with the stated imperfections; keep the given controller".to_owned(),
            ),
            (Some(before), Some(after)) if after > before * (1.0 + 1e-6) => notes.push(format!(
                "the redesign costs {:.4} times as much as the given controller; keep the given one",
                after / before
            )),
            _ => {}
        }
        if integrates(self.design.controllers.at(0)) && !integrates(&design.controller) {
            notes.push(
                "the given controller has integral action, and the redesign has none: it expects no constant disturbance".to_owned(),
            );
        }
        if self.timed.timing.record.is_some() {
            notes.push(
                "the design draws the lengths of periods with the rms of the record; its cost and its limits are those with the record"
                    .to_owned(),
            );
        }
        if !design.assumed_noise.is_empty() {
            let outputs = &self.timed.linear.plant().outputs;
            let names: Vec<&str> =
                design.assumed_noise.iter().map(|&j| outputs[j].name.as_str()).collect();
            notes.push(format!(
                "no noise is given for the measurements of {}: the filter assumes {:e} of the variance that the noise of the plant adds \
                 in a period, so that its gains suit almost exact measurements; help: give `measurement-noise` in [loop]",
                names.join(", "),
                libration::linear::ASSUMED_NOISE
            ));
        }
        notes
    }
}

/// Whether a controller keeps a constant for good.
fn integrates(controller: &DiscreteController) -> bool {
    // As far as f64 has the eigenvalue of an integrator.
    let values = eigenvalues(&controller.a).unwrap_or_default();
    values.iter().any(|value| (value - 1.0).norm() < 1e-6)
}
