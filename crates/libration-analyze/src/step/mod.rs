//! Analysis of one step of an integrator, and of the control loop around it.

mod analysis;
mod checks;
mod cost;
mod criteria;
mod error;
mod growth;
mod limits;
mod linear_step;
mod loop_analysis;
mod modes;
mod request;
mod step_matrix;
mod timing;
mod verdicts;

use std::sync::atomic::AtomicBool;

pub use analysis::{Analysis, Drift, ModifiedHamiltonian, RequestSummary};
use checks::{check_exact, check_implicit, check_sizes, check_start, check_turn};
pub use cost::LoopCost;
pub use criteria::Criteria;
pub use error::AnalyzeError;
pub use growth::LoopGrowth;
use libration::analysis::{RationalStep, Spectrum, SymbolicStep};
use libration::number::Wide;
use libration::{AnySystem, Elementary, Scalar};
pub(crate) use limits::stability_windows;
pub use limits::{LargestDt, OrderOfWord};
use linear_step::LinearStep;
pub use loop_analysis::{LoopAnalysis, StableLatencies, loop_growth};
use modes::Modes;
pub use request::{Request, Stepping};
pub use step_matrix::StepMatrix;
pub use timing::{LatencyOption, Timing};
pub use verdicts::StepVerdicts;
pub(crate) use verdicts::of_rest;

/// Analyses one step of the request.
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
    if let (Some(flag), None) = (request.criteria.first(), omega(request)) {
        return Err(AnalyzeError::Criterion { flag, system: request.system.name.clone() });
    }
    if request.stepping == Stepping::Exact {
        check_exact(request)?;
    }
    check_implicit(request)?;
    check_turn(request)?;
    check_sizes(request)?;
    let timing = loop_analysis::answer(request)?;
    check_start(request)?;
    let step = LinearStep::new(request, stop)?;
    let mut analysis = answer(step, timing, request);
    analysis.motion = verdicts::motion(request, stop)?;
    analysis.verdicts = StepVerdicts::new(&analysis, request).of_clocks(request, stop)?;
    analysis.newton_residual = linear_step::newton_residual(request, stop);
    Ok(analysis)
}

fn answer(step: LinearStep, timing: Option<LoopAnalysis>, request: &Request) -> Analysis {
    let LinearStep { linear, evaluations, drift } = step;
    let method = request.stepping.method();
    // A free mass has no frequency, so `z` is undefined.
    let polynomials = method.filter(|_| omega(request).is_some()).and_then(SymbolicStep::new);
    let exact = polynomials.as_ref().zip(omega(request));
    let modes = Modes::new(
        &linear,
        exact.and_then(|(step, omega)| Spectrum::of_polynomials(step, omega * linear.dt)),
    );
    let reversibility = exact
        .and_then(|(step, omega)| {
            reversibility_defect(step, omega, linear.dt, request.system.q.len())
        })
        .unwrap_or_else(|| linear.reversibility_defect());
    let update_matrix_in_z = match request.stepping {
        Stepping::Implicit(method) => omega(request)
            .and_then(|_| RationalStep::new(method))
            .map(|step| texts(&step.matrix.rows())),
        _ => polynomials.as_ref().map(|step| texts(&step.matrix.rows())),
    };
    let linear_system = request.system.is_linear();
    Analysis {
        request: RequestSummary::new(request),
        matrix: StepMatrix::new(&linear, &modes, reversibility, evaluations, exact.is_some()),
        update_matrix_in_z,
        bounded: modes.bounded.filter(|_| linear_system),
        stability_windows: request
            .stepping
            .any_method()
            .zip(request.compiled())
            .and_then(|(method, system)| stability_windows(method, system)),
        largest_dt: method.and_then(|_| limits::largest_dt(polynomials.as_ref(), request)),
        modified_hamiltonian: linear_system
            .then(|| ModifiedHamiltonian::of(&linear.step, modes.determinant_minus_one.is_zero()))
            .flatten(),
        order_of_word: method
            .filter(|_| request.system.equations.dynamics().is_positional())
            .and_then(OrderOfWord::of),
        drift,
        motion: None,
        verdicts: StepVerdicts::default(),
        newton_residual: None,
        timing,
    }
}

/// The starts at which the force of a system has a derivative, in words.
fn regular_starts(system: Option<AnySystem>) -> &'static str {
    match system {
        Some(AnySystem::Kepler(_)) => {
            "--q must not be the origin, where the attraction has no bound"
        }
        Some(AnySystem::Pendulum(_) | AnySystem::DrivenOscillator(_)) => {
            "coordinates must stay so small that angles are below 10¹⁵⁴ rad"
        }
        _ => "coordinates must stay within the range of floats",
    }
}

/// The angular frequency of an oscillator, in rad/s; none of a free mass.
fn omega(request: &Request) -> Option<Wide> {
    match request.compiled() {
        Some(AnySystem::Oscillator(model)) if model.omega2 > 0.0 => {
            Some(Wide::from_f64(model.omega2).sqrt())
        }
        _ => None,
    }
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
