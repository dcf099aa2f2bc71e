//! Causes of overflows by the stability of a step.

use libration::analysis::jacobian;
use libration::equations::StepProgram;
use libration::linear::eigenvalues;
use libration::{AnyMethod, AnySystem, Float};
use libration_settings::equations::{EquationSystem, Twin};

use super::three_digits::{short, short_above, short_below};
use super::{FloatType, Request};
use crate::motion::undefined_function;
use crate::oscillator::CommonOscillator;
use crate::step::loop_answer;
use crate::{Criteria, StableLatencies};

/// Distance from a limit, in unit roundoffs, within which rounding decides.
const MARGIN: f64 = 16.0;

/// The cause of an overflow of `request` in the float type `S`, with a suggestion; none if neither the step, linearised at the
/// start, nor the float type explains it.
/// `last` has the positions and velocities before the overflow, if they are known.
pub(super) fn cause<S: Float>(request: &Request, last: Option<&[f64]>) -> Option<String> {
    let undefined = || {
        let method = request.stepping.any_method()?;
        let dynamics = request.system.equations.dynamics();
        let mut from = last?.to_vec();
        from.resize(from.len() + dynamics.inputs(), 0.0);
        let dt = S::from_f64(request.dt).to_f64();
        let why = undefined_function(&StepProgram::of(method, dynamics), &from, dt)?;
        Some(why.trim_end_matches(',').to_owned())
    };
    match request.loop_option() {
        Some(_) => loop_cause(request),
        None => step_cause::<S>(request).or_else(undefined),
    }
}

/// The cause of an overflow without a loop.
fn step_cause<S: Float>(request: &Request) -> Option<String> {
    let rounded = |x: f64| S::from_f64(x).to_f64();
    let Some(method) = request.stepping.any_method() else {
        return Some(range_cause(request.float, "the exact step"));
    };
    let [dt, roundoff] = [rounded(request.dt), S::UNIT_ROUNDOFF];
    match oscillator_of(&request.system, rounded) {
        Some(system) => linear_cause(method, system, dt, roundoff, request.float),
        None => {
            let omega = start_frequency(&request.system)?;
            let near = CommonOscillator { omega2: omega * omega, gamma: 0.0 };
            let why = instability_cause(method, near, [dt, 1.0])?;
            Some(format!("linearised at the start, {why}"))
        }
    }
}

/// The oscillator whose coordinates all those of a linear system are, with the numbers of the float type; none of other systems.
fn oscillator_of(
    system: &EquationSystem,
    rounded: impl Fn(f64) -> f64,
) -> Option<CommonOscillator> {
    let own = match system.twin {
        // A drive adds a bounded force.
        Some(Twin { system: AnySystem::DrivenOscillator(driven), .. }) => {
            CommonOscillator { omega2: driven.omega2, gamma: driven.gamma }
        }
        _ => CommonOscillator::of(system)?,
    };
    Some(CommonOscillator { omega2: rounded(own.omega2), gamma: rounded(own.gamma) })
}

/// The cause of an overflow of a loop or an uneven clock: it is unstable, or unstable in the mean square.
fn loop_cause(request: &Request) -> Option<String> {
    let Request { stepping, dt, timing, .. } = *request;
    let system = oscillator_of(&request.system, |x| x);
    if let (None, Some(method), Some(system)) = (timing.feedback, stepping.any_method(), system) {
        let why = instability_cause(method, system, [dt, 1.0])
            .or_else(|| uneven_clock_cause(method, request, system));
        if why.is_some() {
            return why;
        }
    }
    let (whole, criteria) = (request.system.clone(), Criteria::default());
    let step = crate::Request { system: whole, stepping, dt, steps: 1, criteria, timing };
    let answer = loop_answer(&step).ok()??;
    let about = if step.system.is_linear() { "" } else { "linearised at the start, " };
    if let Some(excess) = answer.closed_loop_spectral_radius_minus_one.filter(|x| *x > 0.0) {
        let way_out = answer.critical.as_ref().map_or_else(String::new, stable_latency_help);
        // Three digits do not distinguish a radius near 1 from 1.
        let radius =
            if excess < 0.01 { format!("1 + {}", short(excess)) } else { short(1.0 + excess) };
        return Some(format!(
            "{about}the closed loop is unstable: its spectral radius is {radius}; {way_out}"
        ));
    }
    let growth = answer.growth.and_then(|growth| growth.mean_square_growth);
    growth.filter(|growth| *growth > 0.0).map(|growth| {
        format!(
            "{about}second moments grow by {} % per step under the jitter: choose less --jitter or a shorter --dt",
            short(100.0 * growth)
        )
    })
}

/// The latencies with which an unstable loop becomes stable, in words.
fn stable_latency_help(critical: &StableLatencies) -> String {
    if let Some(latency) = critical.critical_latency_seconds {
        return format!("it is stable up to a --latency of {} s", short_below(latency));
    }
    // Windows are those of whole steps.
    let whole =
        critical.latency_windows.iter().map(|&(from, to)| (from.ceil(), to.map(f64::floor)));
    let mut windows = whole.filter(|&(from, to)| to.is_none_or(|to| from <= to));
    match windows.next() {
        Some((from, Some(to))) => {
            format!("it is stable with a --latency from {from}steps to {to}steps")
        }
        Some((from, None)) => format!("it is stable with a --latency of at least {from}steps"),
        None => "no --latency stabilises it: choose another --feedback or --dt".to_owned(),
    }
}

/// The cause of instability under a clock whose mean or slowest steps are longer than `dt`.
fn uneven_clock_cause(
    method: AnyMethod,
    request: &Request,
    system: CommonOscillator,
) -> Option<String> {
    let Request { dt, timing, record, .. } = request;
    if let Some(record) = record {
        let mean = record.iter().sum::<f64>() / record.len() as f64;
        if let Some(why) = instability_cause(method, system, [*dt, mean]) {
            return Some(format!("at the mean recorded step, {why}"));
        }
    }
    let slowest = 1.0 + timing.skew?.largest();
    instability_cause(method, system, [*dt, slowest])
        .map(|why| format!("at the steps of the slowest clocks, {why}"))
}

/// The cause of an overflow of a linear system: an unstable step, or the range of the float type.
fn linear_cause(
    method: AnyMethod,
    system: CommonOscillator,
    dt: f64,
    roundoff: f64,
    float: FloatType,
) -> Option<String> {
    if system.is_free() {
        // A free mass exceeds every range; each method steps it exactly.
        return Some(range_cause(float, "the step"));
    }
    let margin = MARGIN * roundoff;
    let windows = system.stability_windows(method)?;
    let is_stable = windows.iter().any(|&[from, to]| {
        from.is_none_or(|from| dt >= from * (1.0 + margin))
            && to.is_none_or(|to| dt <= to * (1.0 - margin))
    });
    if is_stable {
        Some(range_cause(float, "the step"))
    } else {
        instability_cause(method, system, [dt, 1.0])
    }
}

/// The message that a stable step exceeds the range of the float type.
fn range_cause(float: FloatType, step: &str) -> String {
    let way_out = match float {
        FloatType::F64 => "choose a start nearer to the origin",
        _ => "choose a wider --dtype, or a start nearer to the origin",
    };
    let largest = float.largest();
    let largest = if largest < 1e6 { format!("{largest}") } else { format!("{largest:.3e}") };
    format!("{step} is stable, but a number exceeds the range of {float}, {largest}; {way_out}")
}

/// The cause of instability of an oscillator in steps of `dt` seconds times a factor; none if the step is stable, or unknown.
fn instability_cause(
    method: AnyMethod,
    system: CommonOscillator,
    [dt, stretch]: [f64; 2],
) -> Option<String> {
    let dt = dt * stretch;
    let windows = system.stability_windows(method)?;
    let name = method.name();
    let within = |&&[from, to]: &&[Option<f64>; 2]| {
        from.is_none_or(|from| from < dt) && to.is_none_or(|to| dt < to)
    };
    if windows.iter().any(|window| within(&window)) {
        return None;
    }
    // The window of small steps, if it exists: others may be narrow.
    let width = |[from, to]: &[Option<f64>; 2]| to.unwrap_or(f64::INFINITY) - from.unwrap_or(0.0);
    let small = windows.iter().find(|[from, _]| from.is_none_or(|from| from == 0.0));
    let widest = || windows.iter().max_by(|a, b| width(a).total_cmp(&width(b)));
    let Some(&[from, to]) = small.or_else(widest) else {
        return Some(format!(
            "{name} is unstable with every time step: a smaller --dt only delays the overflow; choose another --integrator"
        ));
    };
    // Without damping the limit depends on the method alone.
    let (symbol, unit, omega) = match system.gamma == 0.0 {
        true => ("ωΔt", "", system.omega2.sqrt()),
        false => ("Δt", " s", 1.0),
    };
    let (from, to) = (from.unwrap_or(0.0), to.unwrap_or(f64::INFINITY));
    let is = format!("{symbol} = {}{unit}", short(omega * dt));
    if from == 0.0 {
        let (limit, largest) = (short(omega * to), short_below(to / stretch));
        Some(format!("{is} exceeds {name}'s limit {limit}{unit}; choose --dt below {largest}"))
    } else {
        let limits = format!("{} to {}{unit}", short(omega * from), short(omega * to));
        let choice =
            format!("between {} and {}", short_above(from / stretch), short_below(to / stretch));
        Some(format!("{is} is outside {name}'s limits {limits}; choose --dt {choice}"))
    }
}

/// The largest angular frequency of the linearisation at the start, in rad/s; none if it does not oscillate, or grows.
fn start_frequency(system: &EquationSystem) -> Option<f64> {
    let jacobian = jacobian(system.equations.dynamics(), &system.start());
    let values = eigenvalues(&system.state_matrix(&jacobian))?;
    let fastest = values.into_iter().max_by(|a, b| a.im.total_cmp(&b.im))?;
    let [re, im] = [fastest.re, fastest.im];
    (im > 0.0 && im.is_finite() && re.abs() <= 1e-9 * im).then_some(im)
}
