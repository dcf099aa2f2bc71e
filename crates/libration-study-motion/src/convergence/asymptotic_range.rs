//! The range of steps in which errors show the order.

use libration::Method;
use libration_report::record::{Record, Relation};
use libration_study::Fit;

use super::Case;

/// The mark of an order that is not decided, in the text of a finding.
const UNDECIDED: &str = "undecided: ";

impl Case<'_> {
    /// Why errors of a system of the user’s own do not decide an order; none if they do.
    ///
    /// An order is a limit of small steps. Where the coefficient of its term is small, the next term is larger at all tried steps, and errors
    /// fall faster. Errors that fall more slowly contradict the order where their slopes are settled, and else are those of larger steps.
    pub(super) fn undecided(
        &self,
        relation: Relation,
        order: f64,
        fit: Fit,
        [dt, errors]: [&[f64]; 2],
    ) -> Option<String> {
        let tolerance = self.tolerance(fit).tolerance.unwrap_or(0.0);
        let why = match fit.exponent - order {
            _ if !self.is_own => return None,
            off if off > tolerance && relation == Relation::Equal => format!(
                "at the steps that were tried the term of order {order} is smaller than the next one"
            ),
            off if off < -tolerance && !Fit::is_settled(dt, errors) => {
                "the slopes between the smallest steps that were tried still change".to_owned()
            }
            _ => return None,
        };
        Some(format!("{UNDECIDED}{why}"))
    }
}

/// The integrators whose order over orbits is not decided on a system.
pub(super) fn undecided_methods(record: &Record, system: &str) -> Vec<&'static str> {
    let is_undecided = |method: &Method| {
        let id = format!("convergence.{system}.{}.global-order", method.name());
        record.finding(&id).is_ok_and(|finding| finding.text.contains(UNDECIDED))
    };
    Method::ALL.into_iter().filter(is_undecided).map(Method::title).collect()
}
