//! The regulator for the latency that is there, and what it buys.

use libration_work::Work;
use serde::Serialize;

use super::LinearRequest;
use super::advice::ControllerMatrices;
use crate::AdviseError;
use crate::budget::Budget;
use crate::loops::LoopError;
use crate::request::Tolerance;
use crate::timed_loop::TimedLoop;

/// The regulator of least cost for the stated latency of the inputs.
///
/// It feeds back the states and the commands under way. Jitter, skew and losses have no part in its design, but in its cost and its
/// limits.
#[derive(Clone, Debug, Serialize)]
pub struct Redesign {
    /// The controller, whose memory is the commands under way.
    pub controller_matrices: ControllerMatrices,
    /// The growth of second moments with all stated imperfections.
    pub growth: f64,
    /// The cost with all stated imperfections; none if it is infinite.
    pub cost: Option<f64>,
    /// The cost with the given controller over this; none if one of the two is infinite.
    pub cost_ratio: Option<f64>,
    /// The sizes of each imperfection with which the loop is stable, without others but the latency that it is designed for.
    pub budgets: Vec<Budget>,
}

impl LinearRequest {
    /// Why there is no redesign for this request.
    pub(super) fn redesign_obstacle(&self) -> Option<&'static str> {
        let late = self.timed.timing.output_latency.iter().any(|late| *late > 0.0);
        match () {
            () if self.design.weights.is_none() || self.design.filter.is_some() => {
                Some("only a controller by [controller.lqr] can be redesigned")
            }
            () if late => Some(
                "the measurements have latency; a redesign requires measurements without latency",
            ),
            () if !self.parts.is_empty() => {
                Some("a channel has a lag or a filter, whose states no measurement shows")
            }
            () => None,
        }
    }

    /// The regulator for the stated latency.
    pub(super) fn redesigned(
        &self,
        work: &Work<'_>,
        tolerance: Tolerance,
        cost_before: Option<f64>,
    ) -> Result<Redesign, AdviseError> {
        let timed = &self.timed;
        let stated = timed.stated().map_err(LoopError::from)?;
        let plant = timed.linear.plant();
        let form = timed.linear.cost_form();
        let controller =
            plant.design_latency_regulator(form, &stated.input_latency, timed.period());
        let controller = controller.map_err(LoopError::from)?;
        let linear = timed.linear.with_controller(controller).map_err(LoopError::from)?;
        let after = TimedLoop { linear, ..timed.clone() };
        let growth = after.growth(&stated).map_err(LoopError::from)?;
        let cost = match growth < 0.0 {
            true => after.cost(&stated).map_err(LoopError::from)?,
            false => f64::INFINITY,
        };
        let cost = Some(cost).filter(|cost| cost.is_finite());
        let command = |_: &_| format!("{} --json", self.invocation);
        let budgets = match after.linear.is_stable(&after.ideal()).map_err(LoopError::from)? {
            true => after.budgets(work, &after.subjects(true), tolerance, &command)?,
            // It needs its latency.
            false => Vec::new(),
        };
        Ok(Redesign {
            controller_matrices: after.linear.controller().into(),
            growth,
            cost,
            cost_ratio: cost_before.zip(cost).map(|(before, after)| before / after),
            budgets,
        })
    }
}
