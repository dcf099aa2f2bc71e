//! The finding about an equilibrium that was searched for.

use libration_report::notation::number;

use crate::modes::ProbedMode;
use crate::{Finding, FindingKind, OperatingPoint};

/// The fault of an equilibrium that is not what was requested, or that does not hold.
pub(crate) fn of_operating_point(point: &OperatingPoint, modes: &[ProbedMode]) -> Option<Finding> {
    let fault = |text| Some(Finding::fault(FindingKind::OperatingPoint, text));
    let remedy = point.remedy();
    if point.is_far() {
        return fault(format!(
            "the audited state is not the requested one: the only equilibrium that was found is {}{remedy}",
            point.distance()
        ));
    }
    if !point.run.stands {
        return fault(format!(
            "the model does not hold the requested state: the equilibrium is {}{remedy}",
            point.distance()
        ));
    }
    let leading = modes.first()?;
    let grows = |rate: f64| rate > 10.0 * leading.error;
    let of_system = leading.flow.filter(|flow| grows(flow.growth_rate))?;
    (grows(leading.step.growth_rate) && point.run.tried_up_to >= 1.0).then(|| {
        Finding::fault(
            FindingKind::OperatingPoint,
            format!(
                "the equilibrium near the request is unstable in the system itself: a mode grows at {} 1/s ({}), whatever the step",
                number(of_system.growth_rate, 3),
                leading.names()
            ),
        )
    })
}
