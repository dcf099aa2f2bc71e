//! How an analysis is judged.

use std::sync::atomic::AtomicBool;

use libration::control::Jitter;
use libration_report::verdict::{Outcome, Verdict};

use super::growth_verdict::{growing_moments, of_step};
use super::{Analysis, StepVerdicts, analyze_until, without_motion};
use crate::digits::{change_per_step, significant};
use crate::oscillator::CommonOscillator;
use crate::step::{AnalyzeError, LoopAnalysis, Request};

/// The verdicts of an analysis.
pub(super) fn verdicts_of(
    analysis: &Analysis,
    oscillator: Option<CommonOscillator>,
    request: &Request,
) -> StepVerdicts {
    if let Some(own) = analysis.timing.as_ref().and_then(of_loop) {
        let closed_loop = Some(at_start(own, request));
        return StepVerdicts { closed_loop, ..StepVerdicts::default() };
    }
    let step = of_step(analysis, oscillator, request);
    let examination = analysis.motion.as_ref().map(|motion| &motion.examination);
    let is_at_rest = examination.is_some_and(|examination| examination.is_at_rest());
    if let (Some(step), true) = (&step, is_at_rest) {
        let step = growing_moments(analysis).unwrap_or_else(|| step.clone());
        return StepVerdicts { step: Some(of_rest(&step)), ..StepVerdicts::default() };
    }
    // The motion shows what rounding hides at the equilibrium, and whether steps follow a growing mode for as long as it is asked for.
    let is_decided = |own: &Verdict| match own.outcome {
        Outcome::NotResolved => false,
        Outcome::Unknown => oscillator.is_some(),
        _ => true,
    };
    let step = step.filter(|own| examination.is_none() || is_decided(own));
    // Second moments are those of the random steps of an oscillator.
    let is_random = request.timing.jitter.is_some() || request.timing.skew.is_some();
    let examination = examination.filter(|_| !(is_random && oscillator.is_some()));
    let motion = examination.map(|own| under_clocks(own.verdict.clone(), request));
    StepVerdicts { closed_loop: None, step, motion }
}

/// The same for the clocks of an ensemble: a good verdict is that of the worst of nine clocks, and names the others as not examined.
///
/// # Errors
/// As [`analyze_until`](super::analyze_until).
pub(super) fn of_clocks(
    own: StepVerdicts,
    oscillator: Option<CommonOscillator>,
    request: &Request,
    stop: &AtomicBool,
) -> Result<StepVerdicts, AnalyzeError> {
    let Some(law) = request.timing.skew else { return Ok(own) };
    let StepVerdicts { mut closed_loop, mut step, motion } = own;
    for error in clock_errors(law) {
        if ![&closed_loop, &step].into_iter().flatten().any(Verdict::is_good) {
            break;
        }
        let mut own = request.clone();
        own.dt *= 1.0 + error;
        own.timing.skew = None;
        let found = match oscillator {
            // The step of an oscillator is judged by its matrix.
            Some(_) => verdicts_of(&without_motion(&own, oscillator)?, oscillator, &own),
            None => analyze_until(&own, stop)?.verdicts,
        };
        for (all, one) in [(&mut closed_loop, found.closed_loop), (&mut step, found.step)] {
            let is_worse = |one: &Verdict| !one.is_good();
            if let (Some(all), Some(one)) = (all, one.filter(is_worse)) {
                let percent = significant(100.0 * error.abs(), 3);
                let how = if error > 0.0 { "longer" } else { "shorter" };
                all.outcome = one.outcome;
                all.evidence = format!(
                    "steps of a clock that are {percent} % {how} ({} s): {}",
                    significant(own.dt, 4),
                    one.evidence
                );
            }
        }
    }
    let of_good = [&mut closed_loop, &mut step].into_iter().flatten();
    for verdict in of_good.filter(|verdict| verdict.is_good()) {
        verdict.not_examined.push("clocks between and beyond nine of the ensemble".to_owned());
    }
    Ok(StepVerdicts { closed_loop, step, motion })
}

/// Relative errors of the steps of clocks besides 0, at equal distances: up to four standard deviations of a Gaussian law, which one clock
/// in 16,000 exceeds, and up to the ends of a uniform one.
fn clock_errors(law: Jitter) -> impl Iterator<Item = f64> {
    let last = match law {
        Jitter::Gaussian(rms) => 4.0 * rms,
        Jitter::Uniform(_) => law.largest(),
    };
    let parts = [1.0, 0.75, 0.5, 0.25];
    parts.into_iter().flat_map(move |part| [part * last, -part * last]).filter(|e| *e > -1.0)
}

/// A verdict on deviations from a system that rests at its start.
fn of_rest(step: &Verdict) -> Verdict {
    let evidence = format!("the system rests at its start; {}", step.evidence);
    Verdict { evidence, ..step.clone() }.without("a motion")
}

/// The verdict on a motion whose steps have random lengths or clocks: what is compared are steps of the stated length.
fn under_clocks(motion: Verdict, request: &Request) -> Verdict {
    let is_random = request.timing.jitter.is_some() || request.timing.skew.is_some();
    match is_random && motion.is_good() {
        true => Verdict::unknown(format!(
            "the motion is compared in steps of the stated length alone, not with jitter or skew; in these {}",
            motion.evidence
        )),
        false => motion,
    }
}

/// Acceleration left at an equilibrium that a user types with ten digits, as a part of the command and of the position.
const REST: f64 = 1e-9;

/// The verdict on a loop around a nonlinear system: that of its linearisation decides where its start is an equilibrium.
fn at_start(own: Verdict, request: &Request) -> Verdict {
    let feedback = request.timing.feedback.filter(|_| !request.system.is_linear());
    let (Some(gains), true) = (feedback, own.is_good()) else { return own };
    let (q, v) = (request.system.q[0], request.system.v[0]);
    let command = gains.position * q + gains.velocity * v;
    let program = request.system.equations.dynamics().accelerations();
    let left = program.on::<f64>().run(&request.system.start()).next();
    let left = left.map(|a| (a - command / request.actuation().mass()).abs());
    let size = REST * (command.abs() + q.abs());
    match left {
        Some(left) if left <= size && v == 0.0 => own,
        _ => Verdict::unknown(format!(
            "the start is no equilibrium of the loop, and the loop is not simulated from it; linearised there, {}",
            own.evidence
        )),
    }
}

/// The verdict on a loop; none without feedback.
fn of_loop(analysis: &LoopAnalysis) -> Option<Verdict> {
    let excess = analysis.closed_loop_spectral_radius_minus_one?;
    let moments = analysis.growth.and_then(|growth| growth.mean_square_growth);
    let motions = format!("its motions {}", change_per_step(excess));
    let squares =
        moments.map(|growth| format!(", and their second moments {}", change_per_step(growth)));
    let worst = moments.map_or(excess, |growth| excess.max(growth));
    let is_known = analysis.growth.is_none() || moments.is_some();
    let evidence = motions + &squares.unwrap_or_default();
    Some(match (worst > 0.0, worst < 0.0) {
        (true, _) => Verdict::new(Outcome::Unstable, evidence),
        _ if !is_known => Verdict::unknown(format!(
            "stable without jitter and losses, and with them it is not known: {evidence}"
        )),
        (_, true) => Verdict::new(Outcome::Stable, evidence),
        _ => Verdict::unknown(format!("at the limit of stability: {evidence}")),
    })
}
