//! Analysis of steps of an integrator on a system: the step, the motion, the equilibrium near it, and the control loop around it.

mod about_equilibrium;
mod growth_verdict;
mod motion_steps;
mod result;
mod step_verdicts;
mod stepped_motion;
mod verdicts;

use std::sync::atomic::AtomicBool;

pub use about_equilibrium::AboutEquilibrium;
use libration::analysis::{RationalStep, Spectrum, SymbolicStep};
use libration::number::Wide;
use libration::{AnyMethod, Elementary, Scalar};
pub use motion_steps::MotionSteps;
pub use result::Analysis;
use result::SCHEMA;
pub use step_verdicts::StepVerdicts;
pub use stepped_motion::{StateError, SteppedMotion};
use verdicts::{of_clocks, verdicts_of};

use crate::newton_residual;
use crate::oscillator::CommonOscillator;
use crate::step::{
    AnalyzeError, Modes, ModifiedHamiltonian, OrderOfWord, Request, StartStep, StepMatrix,
    Stepping, check_criteria, check_exact, check_implicit, check_sizes, check_start, check_turn,
    largest_dt, loop_answer,
};
use crate::system_summary::SystemSummary;

/// Analyses steps of the request.
///
/// # Errors
/// If the request does not fit the system, before any work.
pub fn analyze(request: &Request) -> Result<Analysis, AnalyzeError> {
    analyze_until(request, &AtomicBool::new(false))
}

/// As [`analyze`], until `stop` is set.
///
/// # Errors
/// As [`analyze`], and [`AnalyzeError::Interrupted`].
pub fn analyze_until(request: &Request, stop: &AtomicBool) -> Result<Analysis, AnalyzeError> {
    let oscillator = CommonOscillator::of(&request.system);
    let mut analysis = without_motion(request, oscillator)?;
    if request.timing.feedback.is_none() {
        follow_motion(&mut analysis, request, stop)?;
    }
    let own = verdicts_of(&analysis, oscillator, request);
    analysis.verdicts = of_clocks(own, oscillator, request, stop)?;
    Ok(analysis)
}

/// The step and the loop of a request.
fn without_motion(
    request: &Request,
    oscillator: Option<CommonOscillator>,
) -> Result<Analysis, AnalyzeError> {
    check_criteria(request, oscillator)?;
    if request.stepping == Stepping::Exact {
        check_exact(request)?;
    }
    check_implicit(request)?;
    check_turn(request, oscillator)?;
    check_sizes(request)?;
    let timing = loop_answer(request)?;
    check_start(request)?;
    let step = StartStep::new(request)?;
    let mut analysis = of_start(step.as_ref(), oscillator, request);
    analysis.timing = timing;
    Ok(analysis)
}

/// The properties of a step at the start, which is that of a linear system everywhere.
fn of_start(
    step: Option<&StartStep>,
    oscillator: Option<CommonOscillator>,
    request: &Request,
) -> Analysis {
    let Request { system, stepping, dt, steps, .. } = request;
    let method = stepping.method();
    // A free mass has no frequency, so `z` is undefined.
    let omega = oscillator.and_then(CommonOscillator::frequency);
    let polynomials = method.filter(|_| omega.is_some()).and_then(SymbolicStep::new);
    let exact = polynomials.as_ref().zip(omega);
    let modes = step.map(|StartStep { linear, .. }| {
        let spectrum =
            exact.and_then(|(step, omega)| Spectrum::of_polynomials(step, omega * linear.dt));
        Modes::new(linear, spectrum)
    });
    let own = step.zip(modes.as_ref());
    let matrix = own.map(|(StartStep { linear, evaluations }, modes)| {
        let reversibility = exact
            .and_then(|(step, omega)| reversibility_defect(step, omega, linear.dt, system.q.len()))
            .unwrap_or_else(|| linear.reversibility_defect());
        StepMatrix::new(linear, modes, reversibility, *evaluations, exact.is_some())
    });
    let update_matrix_in_z = match (omega, stepping) {
        (Some(_), Stepping::Implicit(method)) => {
            RationalStep::new(*method).map(|step| texts(&step.matrix.rows()))
        }
        _ => polynomials.as_ref().map(|step| texts(&step.matrix.rows())),
    };
    let of_oscillator = own.zip(oscillator);
    Analysis {
        schema: SCHEMA,
        system: SystemSummary::new(system),
        integrator: stepping.name(),
        dt: *dt,
        steps: *steps,
        note: method.and_then(|method| system.caveat(method)),
        matrix,
        update_matrix_in_z,
        bounded: modes.as_ref().and_then(|modes| modes.bounded).filter(|_| system.is_linear()),
        stability_windows: stepping
            .any_method()
            .zip(oscillator)
            .and_then(|(method, oscillator)| oscillator.stability_windows(method)),
        largest_dt: oscillator.and_then(|own| largest_dt(polynomials.as_ref(), own, request)),
        modified_hamiltonian: of_oscillator.and_then(|((step, modes), _)| {
            ModifiedHamiltonian::of(&step.linear.step, modes.determinant_minus_one.is_zero())
        }),
        order_of_word: method
            .filter(|_| system.equations.dynamics().is_positional())
            .and_then(OrderOfWord::of),
        drift: of_oscillator.and_then(|((step, _), own)| step.drift(request, own)),
        motion: None,
        newton_residual: None,
        equilibrium: None,
        steps_along_motion: None,
        verdicts: StepVerdicts::default(),
        timing: None,
    }
}

/// Adds the motion from the start and the system about the equilibrium near it.
fn follow_motion(
    analysis: &mut Analysis,
    request: &Request,
    stop: &AtomicBool,
) -> Result<(), AnalyzeError> {
    let Request { system, stepping, dt, steps, .. } = request;
    let about = AboutEquilibrium::new(request, stop)?;
    let point = about.operating_point.as_ref().map(|point| point.state_of(system));
    analysis.equilibrium = Some(about);
    let Some(method) = stepping.any_method() else { return Ok(()) };
    let motion = SteppedMotion::new(system, method, *dt, *steps, point.as_deref(), stop)?;
    let horizon = motion.error_steps as f64 * dt;
    analysis.motion = Some(motion);
    analysis.steps_along_motion = Some(MotionSteps::new(system, method, horizon, stop)?);
    if let AnyMethod::Implicit(_) = method {
        let places = system.states.iter().map(|state| state.place).collect();
        let (dynamics, start) = (system.equations.dynamics(), system.start());
        analysis.newton_residual =
            newton_residual::of_run(method, dynamics, &start, places, (*dt, *steps), stop);
    }
    Ok(())
}

/// `‖M(−Δt)·M(Δt) − 1‖` of an oscillator in so many dimensions, from the polynomials of one.
fn reversibility_defect(
    step: &SymbolicStep,
    omega: Wide,
    dt: Wide,
    dimensions: usize,
) -> Option<Wide> {
    let residual = step.reversibility_residual()?.map(|p| p.eval_wide(omega * dt));
    let entry = |i, j, unit: Wide| residual.entry(i, j) * unit;
    let one = Wide::one();
    let entries =
        [entry(0, 0, one), entry(0, 1, omega.recip()), entry(1, 0, omega), entry(1, 1, one)];
    let squares = entries.into_iter().fold(Wide::ZERO, |sum, x| sum + x * x);
    Some((squares * Wide::from_f64(dimensions as f64)).sqrt())
}

fn texts<T: ToString>(rows: &[Vec<T>]) -> Vec<Vec<String>> {
    rows.iter().map(|row| row.iter().map(ToString::to_string).collect()).collect()
}
