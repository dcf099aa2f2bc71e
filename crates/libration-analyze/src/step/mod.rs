//! Analysis of one step of an integrator, and of the control loop around it.

mod analysis;
mod checks;
mod cost;
mod criteria;
mod error;
mod growth;
mod implicit_step;
mod limits;
mod loop_analysis;
mod modes;
mod request;
mod timing;
mod verdicts;

use std::sync::atomic::{AtomicBool, Ordering};

pub use analysis::{Analysis, Drift, ModifiedHamiltonian, RequestSummary};
use checks::{check_exact, check_implicit, check_sizes, check_turn};
pub use cost::LoopCost;
pub use criteria::Criteria;
pub use error::AnalyzeError;
pub use growth::LoopGrowth;
use libration::analysis::{Linearisation, RationalStep, Spectrum, SymbolicStep, forecast_drift};
use libration::number::Wide;
use libration::simulation::{EnergyDrift, Simulator};
use libration::{AnySystem, Elementary, Integrator, Model, Scalar, State, System, with_system};
pub(crate) use limits::stability_windows;
pub use limits::{LargestDt, OrderOfWord};
pub use loop_analysis::{LoopAnalysis, StableLatencies, loop_growth};
use modes::{Modes, flow_radius_minus_one};
pub use request::{Request, Stepping};
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
    if request.q.len() != request.v.len() {
        return Err(AnalyzeError::Coordinates { q: request.q.len(), v: request.v.len() });
    }
    if let (Some(flag), None) = (request.criteria.first(), omega(request.system)) {
        return Err(AnalyzeError::Criterion { flag, system: request.system.name() });
    }
    if request.stepping == Stepping::Exact {
        check_exact(request)?;
    }
    check_implicit(request)?;
    let dimension = request.q.len();
    check_turn(request)?;
    check_sizes(request)?;
    let timing = loop_analysis::answer(request)?;
    let mut analysis = with_system!(
        request.system,
        dimension,
        |model, D| {
            let start = State {
                q: std::array::from_fn::<_, D, _>(|i| request.q[i]),
                v: std::array::from_fn(|i| request.v[i]),
            };
            let step = match (request.system, request.stepping) {
                // Its dimensions do not depend on each other, so that a step in one is enough.
                (AnySystem::Oscillator(one), Stepping::Method(method)) if D > 1 => {
                    let first = State { q: [start.q[0]], v: [start.v[0]] };
                    Step::take(method, one, first, request, stop)?.in_dimensions()
                }
                (_, Stepping::Method(method)) if const { D <= 2 } => {
                    Step::take(method, model, start, request, stop)?
                }
                (AnySystem::Oscillator(one), Stepping::Implicit(method)) if D > 1 => {
                    let first = State { q: [start.q[0]], v: [start.v[0]] };
                    Step::solve(method, one, first, request, stop)?.in_dimensions()
                }
                (_, Stepping::Implicit(method)) if const { D <= 2 } => {
                    Step::solve(method, model, start, request, stop)?
                }
                (_, Stepping::Method(_) | Stepping::Implicit(_)) => {
                    return Err(request.system.entry().wrong_dimension(dimension).into());
                }
                (_, Stepping::Exact) => {
                    let linear = Linearisation::exact(model, &start, request.dt);
                    Step { linear, evaluations: 0, drift: None }
                }
            };
            answer(model, &start, step, timing, request)
        },
        Err(request.system.entry().wrong_dimension(dimension).into())
    )?;
    analysis.motion = verdicts::motion(request, stop)?;
    analysis.verdicts = StepVerdicts::new(&analysis, request).of_clocks(request, stop)?;
    analysis.newton_residual = implicit_step::residual(request, stop);
    Ok(analysis)
}

/// The results that depend on the integrator; [`answer`] is compiled per system only.
struct Step<const D: usize> {
    linear: Linearisation<D>,
    evaluations: u64,
    /// The simulated drift of a nonlinear system.
    drift: Option<Drift>,
}

impl Step<1> {
    /// The same in `D` degrees of freedom that do not depend on each other.
    fn in_dimensions<const D: usize>(self) -> Step<D> {
        let Step { linear, evaluations, drift } = self;
        Step { linear: linear.in_dimensions(), evaluations, drift }
    }
}

impl<const D: usize> Step<D> {
    fn take(
        integrator: impl Integrator,
        model: impl Model<D>,
        start: State<f64, D>,
        request: &Request,
        stop: &AtomicBool,
    ) -> Result<Self, AnalyzeError> {
        let mut simulator = Simulator::new(model.on::<f64>(), integrator, start, request.dt)?;
        let linear = Linearisation::new(integrator, model, &start, request.dt);
        check_jacobian(&linear, request)?;
        let drift = match request.system.is_linear() {
            true => None,
            false => simulated_drift(&mut simulator.clone(), model, request.steps, stop)?,
        };
        simulator.run(1, &mut ()).ok();
        Ok(Step { linear, evaluations: simulator.evaluations(), drift })
    }
}

/// Fails if the Jacobian of the step does not exist.
fn check_jacobian<const D: usize>(
    linear: &Linearisation<D>,
    request: &Request,
) -> Result<(), AnalyzeError> {
    if linear.step.rows().iter().flatten().any(|x| x.is_nan()) {
        let (q, v) = (request.q.clone(), request.v.clone());
        return Err(AnalyzeError::Singular { allowed: regular_starts(request.system), q, v });
    }
    Ok(())
}

fn answer<const D: usize>(
    model: impl Model<D>,
    start: &State<f64, D>,
    step: Step<D>,
    timing: Option<LoopAnalysis>,
    request: &Request,
) -> Result<Analysis, AnalyzeError> {
    let Step { linear, evaluations, drift } = step;
    let method = request.stepping.method();
    // A free mass has no frequency, so `z` is undefined.
    let polynomials =
        method.filter(|_| omega(request.system).is_some()).and_then(SymbolicStep::new);
    let exact = polynomials.as_ref().zip(omega(request.system));
    let modes = Modes::new(
        &linear,
        exact.and_then(|(step, omega)| Spectrum::of_polynomials(step, omega * linear.dt)),
    );
    let reversibility = exact
        .and_then(|(step, omega)| reversibility_defect::<D>(step, omega, linear.dt))
        .unwrap_or_else(|| linear.reversibility_defect());
    let update_matrix_in_z = match request.stepping {
        Stepping::Implicit(method) => omega(request.system)
            .and_then(|_| RationalStep::new(method))
            .map(|step| texts(&step.matrix.rows())),
        _ => polynomials.as_ref().map(|step| texts(&step.matrix.rows())),
    };
    let linear_system = request.system.is_linear();
    let drift = match linear_system {
        true => forecast_drift(model, &linear.step, start, request.steps).map(Drift::from),
        false => drift,
    };
    Ok(Analysis {
        request: RequestSummary::new(request),
        update_matrix: to_f64(&linear.step.rows()),
        update_matrix_in_z,
        determinant: modes.determinant.to_f64(),
        determinant_minus_one: modes.determinant_minus_one.to_f64(),
        trace: linear.step.trace().to_f64(),
        eigenvalues: modes.eigenvalues(),
        spectral_radius: modes.radius.to_f64(),
        spectral_radius_minus_one: modes.radius_minus_one.to_f64(),
        flow_spectral_radius_minus_one: flow_radius_minus_one(&linear),
        bounded: modes.bounded.filter(|_| linear_system),
        stability_windows: request
            .stepping
            .any_method()
            .and_then(|method| stability_windows(method, request.system)),
        largest_dt: method.and_then(|_| limits::largest_dt(polynomials.as_ref(), start, request)),
        modified_hamiltonian: linear_system
            .then(|| ModifiedHamiltonian::of(&linear.step, modes.determinant_minus_one.is_zero()))
            .flatten(),
        order_of_word: method.filter(|_| is_positional(&model)).and_then(OrderOfWord::of),
        symplecticity_defect: defect(modes.symplecticity_defect, exact.is_some()),
        reversibility_defect: defect(reversibility, exact.is_some()),
        phase_error_per_step: modes.followed_phase_error(),
        loses_oscillation: modes.loses_oscillation(),
        force_evaluations_per_step: evaluations,
        drift,
        motion: None,
        verdicts: StepVerdicts::default(),
        newton_residual: None,
        timing,
    })
}

/// The starts at which the force of a system has a derivative, in words.
fn regular_starts(system: AnySystem) -> &'static str {
    match system {
        AnySystem::Kepler(_) => "--q must not be the origin, where the attraction has no bound",
        AnySystem::Pendulum(_) | AnySystem::DrivenOscillator(_) => {
            "coordinates must stay so small that angles are below 10¹⁵⁴ rad"
        }
        _ => "coordinates must stay within the range of floats",
    }
}

/// A defect in `f64`. An inexact defect below the rounding of 1024 bits is zero.
fn defect(norm: Wide, exact: bool) -> f64 {
    let value = norm.to_f64();
    if value < 1e-270 && !exact { 0.0 } else { value }
}

/// Whether the force depends on positions alone, which the order of a word requires.
fn is_positional<M: Model<D>, const D: usize>(_: &M) -> bool {
    <M::On<f64> as System<f64, D>>::POSITIONAL
}

/// The angular frequency of an oscillator, in rad/s; none of a free mass.
fn omega(system: AnySystem) -> Option<Wide> {
    match system {
        AnySystem::Oscillator(model) if model.omega2 > 0.0 => {
            Some(Wide::from_f64(model.omega2).sqrt())
        }
        _ => None,
    }
}

/// `‖M(−Δt)·M(Δt) − 1‖` of an oscillator in `D` dimensions, from the polynomials of one.
fn reversibility_defect<const D: usize>(
    step: &SymbolicStep,
    omega: Wide,
    dt: Wide,
) -> Option<Wide> {
    let residual = step.reversibility_residual()?.map(|p| p.eval_wide(omega * dt));
    let entry = |i, j, unit: Wide| residual.entry(i, j) * unit;
    let one = Wide::one();
    let entries =
        [entry(0, 0, one), entry(0, 1, omega.recip()), entry(1, 0, omega), entry(1, 1, one)];
    let squares = entries.into_iter().fold(Wide::ZERO, |sum, x| sum + x * x);
    Some((squares * Wide::from_f64(D as f64)).sqrt())
}

fn texts<T: ToString>(rows: &[Vec<T>]) -> Vec<Vec<String>> {
    rows.iter().map(|row| row.iter().map(ToString::to_string).collect()).collect()
}

fn to_f64(rows: &[Vec<Wide>]) -> Vec<Vec<f64>> {
    rows.iter().map(|row| row.iter().map(|x| x.to_f64()).collect()).collect()
}

/// Steps between two checks of the stop flag.
const PIECE: u64 = 1 << 16;

/// The energy drift of a nonlinear system, simulated.
fn simulated_drift<Sys, I, const D: usize>(
    simulator: &mut Simulator<Sys, I, f64, D>,
    model: impl Model<D>,
    steps: u64,
    stop: &AtomicBool,
) -> Result<Option<Drift>, AnalyzeError>
where
    Sys: System<f64, D> + Copy,
    I: Integrator,
{
    let mut drift = EnergyDrift::new(model.on::<f64>(), &simulator.sample().state);
    let (mut left, mut stopped) = (steps, None);
    while left > 0 && stopped.is_none() {
        if stop.load(Ordering::Relaxed) {
            return Err(AnalyzeError::Interrupted);
        }
        let piece = left.min(PIECE);
        stopped = simulator.run(piece, &mut drift).err();
        left -= piece;
    }
    Ok((drift.initial() != 0.0).then(|| Drift::simulated(&drift, stopped)))
}
