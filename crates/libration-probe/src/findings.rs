//! Findings about the bits of a step, and about the linearised step and its flow.

use libration_report::notation::number;

use crate::FindingKind::*;
use crate::energy_finding::{energy_drift, energy_leak, mode_loss, negative_damping};
use crate::report::ProbeReport;
use crate::{Bits, Finding, Subject};

/// Rounding from which a step is rough, far above that of `f64`.
const COARSE: f64 = 1e-9;
/// Largest distance of the linear prediction from a short run.
const LINEAR: f64 = 0.01;

/// Findings about the bits of a step.
pub(crate) fn of_bits(bits: &Bits, found: &mut Vec<Finding>) {
    if let Some(random) = &bits.randomness {
        let size = random.deviations.iter().copied().fold(0.0, f64::max);
        found.push(match size > 0.0 {
            true => Finding::fault(
                NotReproducible,
                format!(
                    "the same call gives different results (standard deviation {}): random numbers, a clock, or a state that the step hides",
                    number(size, 3)
                ),
            ),
            false => Finding::fault(
                HiddenState,
                "the same call gives different results after other calls, and the same ones when it is repeated: the step has a state that it does not return".into(),
            ),
        });
        match (random.environments_differ, random.generator_is_shared) {
            (_, Some(true)) => found.push(Finding::fault(
                SharedGenerator,
                "the results of the first environment depend on the number of environments: they share a generator of random numbers".into(),
            )),
            (Some(false), _) => found.push(Finding::fault(
                SameNoise,
                "all environments of a batch draw the same random numbers".into(),
            )),
            _ => {}
        }
        return;
    }
    for check in &bits.checks {
        let Some(difference) = &check.difference else { continue };
        let ulps = difference.ulps.map_or_else(String::new, |ulps| format!(", {ulps} ulps apart"));
        found.push(Finding::fault(
            BitsDiffer,
            format!(
                "{} gives other bits: first in {} ({:e} and {:e}{ulps}); {} numbers differ",
                check.name,
                difference.place(),
                difference.first,
                difference.second,
                difference.differing
            ),
        ));
    }
    let Some(rounding) = &bits.rounding else { return };
    match &rounding.single_precision[..] {
        [] => {}
        [whole] if whole == "the step" => found.push(Finding::fault(
            SinglePrecision,
            format!(
                "the step computes in single precision, or prints few digits: its rounding is {} of its results, that of f64 is 10⁻¹⁶",
                number(rounding.results, 2)
            ),
        )),
        parts => found.push(Finding::fault(
            SinglePrecision,
            format!("the step rounds {} to single precision", parts.join(", ")),
        )),
    }
    if rounding.single_precision.is_empty() && rounding.results > COARSE {
        found.push(Finding::warning(
            Rough,
            format!(
                "the step is rough: along a line of points 10⁻⁶ apart its results jump by {} of their size",
                number(rounding.results, 2)
            ),
        ));
    }
}

/// Findings about the linearised step, its flow and its energy.
pub(crate) fn of_report(report: &ProbeReport, subject: &Subject, found: &mut Vec<Finding>) {
    found.extend(
        subject.validity.iter().map(|text| Finding::warning(LimitedValidity, text.clone())),
    );
    if report.ignores_dt {
        found.push(Finding::fault(
            IgnoresDt,
            "a step of half the length gives the same bits: the simulator ignores dt".into(),
        ));
    }
    found.extend(
        report.inner_step.iter().map(|inner| Finding::warning(FixedInnerStep, inner.in_words())),
    );
    if !report.is_differentiable() {
        found.push(Finding::warning(
            NotDifferentiable,
            format!(
                "the step has no derivative at this state (relative error {}): a contact, a limit, dry friction or another switch changes there, or its results are coarse",
                number(report.jacobian_error, 2)
            ),
        ));
    }
    // Coarse results have no fine derivatives, and a finding of their own.
    let rounding = report.bits.rounding.as_ref();
    let is_coarse = rounding.is_some_and(|rounding| rounding.results > COARSE);
    let known = report.unclear_inputs.iter().filter(|_| report.is_differentiable() && !is_coarse);
    for input in known {
        found.push(Finding::warning(
            NotDifferentiable,
            format!("the step has no derivative by `{input}` at this action: a limit or a dead zone begins there"),
        ));
    }
    let equilibrium = &report.equilibrium;
    if !equilibrium.holds && equilibrium.stated != Some(false) {
        found.push(Finding::warning(
            NoEquilibrium,
            format!(
                "the state is no equilibrium: `{}` changes by {} per step; the modes are those of deviations from a motion",
                equilibrium.state,
                number(equilibrium.change, 3)
            ),
        ));
    }
    if let Some(confirmation) =
        report.confirmation.as_ref().filter(|c| c.error > LINEAR || c.error.is_nan())
        && equilibrium.holds
        && report.is_differentiable()
        && !is_coarse
    {
        found.push(Finding::warning(
            Nonlinear,
            format!(
                "after {} steps from a deviation of {} the simulator is {} % off the linear prediction",
                confirmation.steps,
                number(confirmation.displacement, 1),
                number(100.0 * confirmation.error, 2)
            ),
        ));
    }
    if let Some(difference) = report.reference.as_ref().filter(|r| r.difference > r.allowed) {
        found.push(Finding::warning(
            DerivativesDiffer,
            format!(
                "the matrices of {} differ from the differences of the step by {} of the largest entry of a row; errors explain {}",
                difference.source,
                number(difference.difference, 2),
                number(difference.allowed, 2)
            ),
        ));
    }
    for audit in &report.delays {
        let Some(first) = audit.first_change else { continue };
        let shares: Vec<String> = audit
            .delays
            .iter()
            .map(|(delay, count)| {
                let share = 100.0 * *count as f64 / audit.steps as f64;
                format!("{} steps late in {} %", number(*delay, 4), number(share, 3))
            })
            .collect();
        found.push(Finding::fault(
            IrregularDelay,
            format!(
                "the delay of `{}` changes from step to step, first at step {first}: {}",
                audit.input,
                shares.join(", ")
            ),
        ));
    }
    // A step cannot tell whether its author wants a drive, unless the system conserves energy.
    let is_fault = report.is_conservative;
    found.extend(
        report
            .driven_velocities
            .iter()
            .map(|driven| Finding::new(NegativeDamping, is_fault, negative_damping(driven))),
    );
    if report.is_conservative {
        let leak = energy_leak(report.defects.as_ref(), &report.modes, equilibrium.holds);
        found.extend(leak.map(|text| Finding::fault(EnergyLeak, text)));
        let loss = if equilibrium.holds { mode_loss(report) } else { None };
        found.extend(loss.map(|text| Finding::fault(EnergyDrift, text)));
    }
    let drift = report.defects.as_ref().and_then(|defects| defects.energy.as_ref());
    let drift = drift.and_then(|drift| energy_drift(drift, report.is_conservative, report.dt));
    found.extend(drift.map(|text| Finding::fault(EnergyDrift, text)));
    let grows = report.spectral_radius > 1.0 + COARSE;
    if report.flow.is_none()
        && grows
        && report.is_differentiable()
        && !subject.has_fixed_dt
        && !report.ignores_dt
        && report.inner_step.is_none()
    {
        found.push(Finding::warning(
            UnstableStep,
            format!(
                "a mode of the step of {} s grows by a factor of {} per step; whether it grows in the system, too, is unknown: shorter steps have no limit",
                number(report.dt, 6),
                number(report.spectral_radius, 6)
            ),
        ));
    }
    if let Some(limit) = &report.largest_dt {
        if limit.grows_always {
            found.push(Finding::new(
                GrowsAlways,
                equilibrium.holds,
                format!(
                    "the mode of {} grows with every step length though it does not grow in the system",
                    limit.mode
                ),
            ));
        } else if limit.dt.is_some_and(|dt| dt < report.dt) {
            found.push(Finding::new(
                UnstableStep,
                equilibrium.holds,
                format!(
                    "the step of {} s is unstable: a mode grows that does not grow so in the system; the longest stable step is {} s, limited by the mode of {}",
                    number(report.dt, 6),
                    number(limit.dt.unwrap_or(0.0), 6),
                    limit.mode
                ),
            ));
        }
    }
}
