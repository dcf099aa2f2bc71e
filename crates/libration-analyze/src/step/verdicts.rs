//! Verdicts on a step of a system of the catalogue.

use std::sync::atomic::AtomicBool;

use libration::AnySystem;
use libration::control::Jitter;
use libration::equations::StepProgram;
use libration::linear::GROWTH_ROUNDING;
use libration_report::verdict::{FOLLOWED, Outcome, Verdict};
use serde::Serialize;

use super::limits::is_free;
use super::{Analysis, AnalyzeError, LoopAnalysis, Request, analyze_until};
use crate::digits::{change_per_step, significant};
use crate::motion::{MotionExamination, MotionState, MotionSubject, examine};
use crate::step_verdict::StepGrowth;

/// The verdicts on a step of a system of the catalogue. Of a loop there is that of the loop alone.
#[derive(Clone, Debug, Default, Serialize)]
pub struct StepVerdicts {
    /// Whether the loop is stable; none without a loop.
    #[serde(rename = "loop", skip_serializing_if = "Option::is_none")]
    pub closed_loop: Option<Verdict>,
    /// Whether the step lets deviations grow more than exact steps do; of nonlinear systems only at an equilibrium at which they rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<Verdict>,
    /// Whether the steps resolve the motion of a nonlinear system.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<Verdict>,
}

impl StepVerdicts {
    pub(super) fn new(analysis: &Analysis, request: &Request) -> Self {
        let closed_loop = analysis.timing.as_ref().and_then(of_loop);
        let is_loop = closed_loop.is_some();
        let is_at_rest = analysis.motion.as_ref().is_some_and(MotionExamination::is_at_rest);
        let motion = analysis.motion.as_ref().filter(|_| !is_at_rest);
        StepVerdicts {
            closed_loop: closed_loop.map(|own| at_start(own, request)),
            step: match (is_loop, request.system.is_linear()) {
                (true, _) => None,
                (false, true) => Some(of_step(analysis, request)),
                (false, false) => is_at_rest.then(|| {
                    of_rest(&growing_moments(analysis).unwrap_or_else(|| at_rest(analysis)))
                }),
            },
            motion: motion.map(|motion| under_clocks(motion.verdict.clone(), request)),
        }
    }

    /// The same for the clocks of an ensemble: a good verdict is that of the worst of nine clocks, and names the others as not examined.
    ///
    /// # Errors
    /// As [`analyze_until`](super::analyze_until).
    pub(super) fn of_clocks(
        self,
        request: &Request,
        stop: &AtomicBool,
    ) -> Result<Self, AnalyzeError> {
        let Some(law) = request.timing.skew else { return Ok(self) };
        let StepVerdicts { mut closed_loop, mut step, motion } = self;
        for error in clock_errors(law) {
            if ![&closed_loop, &step].into_iter().flatten().any(Verdict::is_good) {
                break;
            }
            let mut own = request.clone();
            own.dt *= 1.0 + error;
            own.timing.skew = None;
            let found = analyze_until(&own, stop)?.verdicts;
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

    /// All that there are.
    pub fn all(&self) -> impl Iterator<Item = &Verdict> {
        self.closed_loop.iter().chain(&self.step).chain(&self.motion)
    }
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
pub(crate) fn of_rest(step: &Verdict) -> Verdict {
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

/// The step at an equilibrium of a nonlinear system, by the rule of systems by equations.
fn at_rest(analysis: &Analysis) -> Verdict {
    let dt = analysis.request.dt;
    let growth = StepGrowth {
        dt,
        radius: Some(1.0 + analysis.matrix.spectral_radius_minus_one),
        exact_rate: analysis.matrix.flow_spectral_radius_minus_one.ln_1p() / dt,
        has_parted: false,
        stable_dt: None,
        has_stability_function: false,
        modes: Vec::new(),
    };
    growth.verdict()
}

/// The verdict on steps of random length whose second moments grow; none if they do not.
fn growing_moments(analysis: &Analysis) -> Option<Verdict> {
    let growth = analysis.timing.as_ref()?.growth?.mean_square_growth?;
    let moments = change_per_step(growth);
    (growth > GROWTH_ROUNDING).then(|| {
        Verdict::new(
            Outcome::Unstable,
            format!("second moments {moments} under the stated time steps"),
        )
    })
}

fn of_step(analysis: &Analysis, request: &Request) -> Verdict {
    let excess = analysis.matrix.spectral_radius_minus_one;
    let exact = analysis.matrix.flow_spectral_radius_minus_one;
    // What rounded parameters change in the growth of exact steps.
    let rounding = 0.5 * f64::EPSILON * exact.abs();
    let motions = format!("motions {}", change_per_step(excess));
    if let Some(unstable) = growing_moments(analysis) {
        return unstable;
    }
    if excess != 0.0 && excess.abs() <= rounding {
        return Verdict::unknown(
            "at the limit of stability, motions neither grow nor decay beyond the rounding of its parameters",
        );
    }
    let turn = match request.compiled() {
        Some(AnySystem::Oscillator(model)) => model.omega2 * request.dt * request.dt,
        _ => 0.0,
    };
    if excess > 0.0 && excess <= COEFFICIENTS * turn {
        return Verdict::unknown(
            "motions grow by less than the rounding of the coefficients of the integrator",
        );
    }
    if exact > GROWTH_ROUNDING && FOLLOWED * excess.ln_1p() < exact.ln_1p() {
        return Verdict::new(
            Outcome::NotResolved,
            format!("{motions}, and those of exact steps {}", change_per_step(exact)),
        );
    }
    match analysis.bounded {
        Some(true) if excess < 0.0 => Verdict::new(Outcome::Stable, motions),
        Some(true) => Verdict::new(Outcome::Stable, "every motion stays bounded"),
        Some(false) if excess == 0.0 && request.compiled().is_some_and(is_free) => Verdict::new(
            Outcome::Stable,
            "motions grow in proportion to time, as those of exact steps do",
        ),
        Some(false) if excess == 0.0 => {
            Verdict::new(Outcome::Unstable, "motions grow without bound, but not exponentially")
        }
        Some(false) if exact > 0.0 => {
            let outcome =
                if excess <= FASTER * exact { Outcome::Stable } else { Outcome::Unstable };
            let evidence =
                format!("{motions}, and those of exact steps {}", change_per_step(exact));
            Verdict::new(outcome, evidence)
        }
        Some(false) => Verdict::new(Outcome::Unstable, motions),
        None => Verdict::unknown("its coupled modes neither grow nor decay"),
    }
}

/// Growth per step, for each squared radian of it, that roundings of a dozen coefficients of an integrator may cause.
const COEFFICIENTS: f64 = 8.0 * f64::EPSILON;

/// A motion that grows in exact steps may grow by this part faster: the step is inaccurate then, not unstable.
const FASTER: f64 = 1.5;

/// None without feedback.
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

/// The motion of a nonlinear system; none of linear ones, and with a loop.
///
/// # Errors
/// [`AnalyzeError::Interrupted`].
pub(super) fn motion(
    request: &Request,
    stop: &AtomicBool,
) -> Result<Option<MotionExamination>, AnalyzeError> {
    let (Some(method), false) = (request.stepping.any_method(), request.system.is_linear()) else {
        return Ok(None);
    };
    if request.timing.feedback.is_some() {
        return Ok(None);
    }
    let system = &request.system;
    let (start, states) = (system.start(), MotionState::all(system));
    let subject = MotionSubject {
        dynamics: system.equations.dynamics(),
        start: &start,
        states: &states,
        is_affine: false,
        energy_unit: &system.energy_unit,
    };
    let step = StepProgram::of(method, subject.dynamics);
    Ok(Some(examine(&subject, &step, request.dt, request.steps, stop)?))
}
