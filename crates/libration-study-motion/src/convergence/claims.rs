//! The claims of the source report about orders.

use libration::Method;
use libration_report::notation::number;
use libration_report::record::{Finding, Judgement, Record, Ruling};

/// Judges them from the findings of the record.
pub(super) fn judge(record: &mut Record) {
    let of = |method: Method, what: &str| -> Vec<String> {
        let end = format!(".{}.{what}", method.name());
        record.findings.iter().filter(|f| f.id.ends_with(&end)).map(|f| f.id.clone()).collect()
    };
    let pair = |method| [of(method, "global-order"), of(method, "local-order")].concat();
    let (euler, rk4) = (pair(Method::ExplicitEuler), pair(Method::Rk4));
    let verlet = of(Method::VelocityVerlet, "global-order");
    let symmetries =
        [of(Method::VelocityVerlet, "symplecticity"), of(Method::VelocityVerlet, "reversibility")]
            .concat();
    if !euler.is_empty() && !rk4.is_empty() {
        let all = [euler, rk4].concat();
        rule(
            record,
            "C07",
            "2.6, 3.5-3.8",
            "A method of order p errs by O(Δt^{p+1}) in a step and by O(Δt^p) over an orbit: \
             explicit Euler has order 1, RK4 order 4.",
            &all,
            |f| {
                let worst = f.iter().map(|f| off(f)).fold(0.0, f64::max);
                Judgement::holds_if(
                    f.iter().all(|f| near_its_order(f)),
                    format!(
                        "the exponents that were fitted lie within {} of these on every system \
                         studied, in phase space. In position alone a method may show more: \
                         symplectic Euler shows order 2 from a start without force",
                        number(worst, 2)
                    ),
                )
            },
        );
    }
    if !verlet.is_empty() && !symmetries.is_empty() {
        let all = [verlet, symmetries].concat();
        rule(
            record,
            "C24",
            "3.7",
            "Velocity Verlet is of second order, time-reversible and symplectic.",
            &all,
            |f| {
                let (orders, defects): (Vec<&Finding>, Vec<&Finding>) =
                    f.iter().copied().partition(|f| f.id.ends_with("-order"));
                let worst = orders.iter().map(|f| off(f)).fold(0.0, f64::max);
                let vanish =
                    defects.iter().all(|f| f.tolerance.tolerance.is_some_and(|t| f.measured <= t));
                Judgement::holds_if(
                    vanish && orders.iter().all(|f| near_its_order(f)),
                    format!(
                        "also on nonlinear systems: the order is 2 within {}, and both defects of \
                         the Jacobian of a step, computed with dual numbers along the orbit, \
                         vanish in 1024 bits",
                        number(worst, 2)
                    ),
                )
            },
        );
    }
}

/// [`Record::judge`] with identifiers that were made at run time.
fn rule(
    record: &mut Record,
    id: &str,
    source: &str,
    text: &str,
    findings: &[String],
    judge: impl FnOnce(&[&Finding]) -> Judgement,
) {
    let findings: Vec<&str> = findings.iter().map(String::as_str).collect();
    record.judge(Ruling { id, source, text, findings: &findings }, judge);
}

/// Returns the distance of an exponent from its order.
fn off(finding: &Finding) -> f64 {
    finding.predicted.map_or(f64::NAN, |order| (finding.measured - order).abs())
}

/// Whether an exponent is nearer to its order than to any other.
fn near_its_order(finding: &Finding) -> bool {
    off(finding) < 0.5
}
