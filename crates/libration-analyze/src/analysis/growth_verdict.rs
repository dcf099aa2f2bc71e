//! Verdicts on the growth of deviations in steps.

use libration::analysis::jacobian;
use libration::equations::StepProgram;
use libration::linear::{Complex64, GROWTH_ROUNDING, eigenvalues};
use libration_report::verdict::{Outcome, Verdict};

use super::{Analysis, MotionSteps, SteppedMotion};
use crate::digits::change_per_step;
use crate::linear_analysis::LinearAnalysis;
use crate::oscillator::CommonOscillator;
use crate::step::{Request, StepMatrix, spectral_radius};
use crate::step_verdict::{StepGrowth, has_multiple};

/// The verdict on a step: of oscillators that are alike by the numbers of its matrix, of other systems at the equilibrium near the motion,
/// and of linear ones without an equilibrium at any state.
pub(super) fn of_step(
    analysis: &Analysis,
    oscillator: Option<CommonOscillator>,
    request: &Request,
) -> Option<Verdict> {
    if let (Some(oscillator), Some(matrix)) = (oscillator, &analysis.matrix) {
        return Some(of_oscillator(analysis, matrix, oscillator));
    }
    let system = &request.system;
    let about = analysis.equilibrium.as_ref()?;
    if let Some(motion) = &analysis.motion {
        let places = system.states.iter().map(|state| state.place);
        let allows = |along: &MotionSteps| along.allows(motion.dt);
        let is_allowed = analysis.steps_along_motion.as_ref().is_some_and(allows);
        let point = about.operating_point.as_ref().map(|point| point.state_of(system));
        let is_near = |at: &Vec<f64>| motion.examination.is_near(at, places.clone());
        let is_examined = is_allowed && !motion.examination.is_at_rest();
        let is_relevant =
            point.is_some_and(|at| system.is_linear() || (is_near(&at) && !is_examined));
        if let (true, Some(linear)) = (is_relevant, &about.linear) {
            return about_equilibrium(motion, linear);
        }
    }
    if system.is_linear() { of_affine(request) } else { None }
}

fn about_equilibrium(motion: &SteppedMotion, linear: &LinearAnalysis) -> Option<Verdict> {
    let own = linear.steps.iter().find(|step| step.integrator == motion.integrator);
    if let Some(verdict) = own.and_then(|step| step.verdict.clone()) {
        return Some(verdict);
    }
    let growth = StepGrowth {
        dt: motion.dt,
        radius: Some(motion.spectral_radius?),
        exact_rate: linear.modes.first()?.growth_rate,
        has_parted: linear.modes.iter().any(|mode| mode.natural_frequency == 0.0)
            || has_multiple(
                linear
                    .modes
                    .iter()
                    .map(|mode| Complex64::new(mode.eigenvalue[0], mode.eigenvalue[1])),
            ),
        stable_dt: None,
        has_stability_function: false,
        modes: Vec::new(),
    };
    Some(growth.verdict())
}

/// The step of a linear system without an equilibrium: its derivatives are the same everywhere.
fn of_affine(request: &Request) -> Option<Verdict> {
    let Request { system, dt, .. } = request;
    let start = system.start();
    let rates = jacobian(system.equations.dynamics(), &start);
    let values = eigenvalues(&system.state_matrix(&rates))?;
    let exact_rate = values.iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max);
    let radius = match request.stepping.any_method() {
        Some(method) => {
            let step = StepProgram::of(method, system.equations.dynamics());
            spectral_radius(&step, system, &start, *dt)?
        }
        None => (exact_rate * dt).exp(),
    };
    let growth = StepGrowth {
        dt: *dt,
        radius: Some(radius),
        exact_rate,
        // Without an equilibrium there is one.
        has_parted: true,
        stable_dt: None,
        has_stability_function: false,
        modes: Vec::new(),
    };
    Some(growth.verdict())
}

/// The verdict on steps of random length whose second moments grow; none if they do not.
pub(super) fn growing_moments(analysis: &Analysis) -> Option<Verdict> {
    let growth = analysis.timing.as_ref()?.growth?.mean_square_growth?;
    let moments = change_per_step(growth);
    (growth > GROWTH_ROUNDING).then(|| {
        Verdict::new(
            Outcome::Unstable,
            format!("second moments {moments} under the stated time steps"),
        )
    })
}

/// The exact motions of these oscillators do not grow exponentially, so that growth is that of the steps.
fn of_oscillator(
    analysis: &Analysis,
    matrix: &StepMatrix,
    oscillator: CommonOscillator,
) -> Verdict {
    let excess = matrix.spectral_radius_minus_one;
    let exact = matrix.flow_spectral_radius_minus_one;
    // Rounded parameters change the growth of exact steps by so much.
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
    // Damping has more coefficients than those of the integrator.
    let is_undamped = oscillator.gamma == 0.0;
    let turn = if is_undamped { oscillator.omega2 * analysis.dt * analysis.dt } else { 0.0 };
    if excess > 0.0 && excess.is_finite() && excess <= COEFFICIENTS * turn {
        return Verdict::unknown(
            "motions grow by less than the rounding of the coefficients of the integrator",
        );
    }
    match analysis.bounded {
        Some(true) if excess < 0.0 => Verdict::new(Outcome::Stable, motions),
        Some(true) => Verdict::new(Outcome::Stable, "every motion stays bounded"),
        Some(false) if excess == 0.0 && oscillator.is_free() => Verdict::new(
            Outcome::Stable,
            "motions grow in proportion to time, as those of exact steps do",
        ),
        Some(false) if excess == 0.0 && oscillator.gamma > 0.0 => {
            Verdict::unknown("a step is too short for the digits of its decay")
        }
        Some(false) if excess == 0.0 => {
            Verdict::new(Outcome::Unstable, "motions grow without bound, but not exponentially")
        }
        Some(false) => Verdict::new(Outcome::Unstable, motions),
        None => Verdict::unknown("it is not known whether its motions stay bounded"),
    }
}

/// Growth per step, for each squared radian of it, that roundings of a dozen coefficients of an integrator may cause.
const COEFFICIENTS: f64 = 8.0 * f64::EPSILON;
