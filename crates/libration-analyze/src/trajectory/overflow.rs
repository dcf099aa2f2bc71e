//! Why a trajectory overflows, where the stability of its step tells.

use libration::analysis::{Linearisation, eigenvalues};
use libration::system::{DampedOscillator, Oscillator};
use libration::{AnySystem, Float, Method, Model, State, with_system};

use super::{FloatType, Request};
use crate::analyze;
use crate::analyze::{Criteria, Critical, Stepping, stability_windows};

/// Unit roundoffs by which a step may lie beside a limit before rounding decides.
const MARGIN: f64 = 16.0;

/// Why a trajectory of `request` overflows in the float type `S`, and what to do; none where neither the step, as linearised at the
/// start, nor the float type explains it.
pub(super) fn cause<S: Float>(request: &Request) -> Option<String> {
    match request.looped() {
        Some(_) => looped(request),
        None => of_step::<S>(request),
    }
}

/// The same without a loop.
fn of_step<S: Float>(request: &Request) -> Option<String> {
    let rounded = |x: f64| S::from_f64(x).to_f64();
    let dt = rounded(request.dt);
    let method = match request.stepping {
        Stepping::Method(method) => method,
        Stepping::Exact => return Some(range(request.float, "the exact step")),
    };
    // What is stepped has the parameters of the float type. A drive adds a bounded force.
    let linear = match request.system {
        AnySystem::Oscillator(Oscillator { omega2 }) => {
            Some(AnySystem::Oscillator(Oscillator { omega2: rounded(omega2) }))
        }
        AnySystem::DampedOscillator(DampedOscillator { omega2, gamma }) => {
            let (omega2, gamma) = (rounded(omega2), rounded(gamma));
            Some(AnySystem::DampedOscillator(DampedOscillator { omega2, gamma }))
        }
        AnySystem::DrivenOscillator(driven) => {
            let (omega2, gamma) = (rounded(driven.omega2), rounded(driven.gamma));
            Some(AnySystem::DampedOscillator(DampedOscillator { omega2, gamma }))
        }
        _ => None,
    };
    match linear {
        Some(system) => of_linear(method, system, dt, S::UNIT_ROUNDOFF, request.float),
        None => {
            let omega = start_frequency(request)?;
            let near = AnySystem::Oscillator(Oscillator { omega2: omega * omega });
            let why = unstable(method, near, [dt, 1.0])?;
            Some(format!("linearised at the start, {why}"))
        }
    }
}

/// Why a loop, or a step under an uneven clock, overflows: it is unstable, in the mean square where something is drawn.
fn looped(request: &Request) -> Option<String> {
    let Request { system, actuation, stepping, dt, timing, .. } = *request;
    if let (None, Some(method)) = (timing.feedback, stepping.method()) {
        let why = unstable(method, system, [dt, 1.0]).or_else(|| uneven(method, request));
        if why.is_some() {
            return why;
        }
    }
    let (q, v, criteria) = (request.q.clone(), request.v.clone(), Criteria::default());
    let step =
        analyze::Request { system, actuation, stepping, dt, q, v, steps: 1, criteria, timing };
    let analysis = analyze::analyze(&step).ok()?;
    let about = if system.is_linear() { "" } else { "linearised at the start, " };
    let answer = analysis.timing?;
    if let Some(excess) = answer.closed_loop_spectral_radius_minus_one.filter(|x| *x > 0.0) {
        let way_out = answer.critical.as_ref().map_or_else(String::new, latencies);
        // Three digits of a radius near 1 would not tell it from 1.
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

/// The latencies with which a loop is stable that is not so with its own.
fn latencies(critical: &Critical) -> String {
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

/// Why a step is unstable under a clock whose mean or slowest steps are longer than `dt`.
fn uneven(method: Method, request: &Request) -> Option<String> {
    let Request { system, dt, timing, record, .. } = request;
    if let Some(record) = record {
        let mean = record.iter().sum::<f64>() / record.len() as f64;
        if let Some(why) = unstable(method, *system, [*dt, mean]) {
            return Some(format!("of the mean recorded step, {why}"));
        }
    }
    let slowest = 1.0 + timing.skew?.largest();
    unstable(method, *system, [*dt, slowest])
        .map(|why| format!("of the slowest clocks' steps, {why}"))
}

/// Of a linear system: either its step is unstable, or the numbers leave the float type.
fn of_linear(
    method: Method,
    system: AnySystem,
    dt: f64,
    roundoff: f64,
    float: FloatType,
) -> Option<String> {
    if let AnySystem::Oscillator(Oscillator { omega2: 0.0 })
    | AnySystem::DampedOscillator(DampedOscillator { omega2: 0.0, gamma: 0.0 }) = system
    {
        // A free mass leaves every range; each method steps it exactly.
        return Some(range(float, "the step"));
    }
    let margin = MARGIN * roundoff;
    let windows = stability_windows(method, system)?;
    let is_stable = windows.iter().any(|&[from, to]| {
        from.is_none_or(|from| dt >= from * (1.0 + margin))
            && to.is_none_or(|to| dt <= to * (1.0 - margin))
    });
    if is_stable { Some(range(float, "the step")) } else { unstable(method, system, [dt, 1.0]) }
}

/// That a stable step leaves the float type.
fn range(float: FloatType, step: &str) -> String {
    let way_out = match float {
        FloatType::F64 => "choose a start nearer to the origin",
        _ => "choose a wider --float, or a start nearer to the origin",
    };
    let largest = float.largest();
    let largest = if largest < 1e6 { format!("{largest}") } else { format!("{largest:.3e}") };
    format!("{step} is stable, but a number exceeds the range of {float}, {largest}; {way_out}")
}

/// Why a step of `dt` seconds, stretched by a factor, is unstable on an oscillator; none if it is stable, or nobody knows.
fn unstable(method: Method, system: AnySystem, [dt, stretch]: [f64; 2]) -> Option<String> {
    let dt = dt * stretch;
    let windows = stability_windows(method, system)?;
    let name = method.name();
    let within = |&&[from, to]: &&[Option<f64>; 2]| {
        from.is_none_or(|from| from < dt) && to.is_none_or(|to| dt < to)
    };
    if windows.iter().any(|window| within(&window)) {
        return None;
    }
    // The window of small steps, where there is one: others may be slivers.
    let width = |[from, to]: &[Option<f64>; 2]| to.unwrap_or(f64::INFINITY) - from.unwrap_or(0.0);
    let small = windows.iter().find(|[from, _]| from.is_none_or(|from| from == 0.0));
    let widest = || windows.iter().max_by(|a, b| width(a).total_cmp(&width(b)));
    let Some(&[from, to]) = small.or_else(widest) else {
        return Some(format!(
            "{name} is unstable with every time step: a smaller --dt only delays the overflow; choose another --integrator"
        ));
    };
    // Of an oscillator without damping the limit is a number of the method alone.
    let (symbol, unit, omega) = match system {
        AnySystem::Oscillator(model) => ("ωΔt", "", model.omega2.sqrt()),
        _ => ("Δt", " s", 1.0),
    };
    let (from, to) = (from.unwrap_or(0.0), to.unwrap_or(f64::INFINITY));
    let is = format!("{symbol} = {}{unit}", short(omega * dt));
    if from == 0.0 {
        let (limit, largest) = (short(omega * to), short_below(to / stretch));
        Some(format!("{is} is beyond {name}'s limit {limit}{unit}; choose --dt below {largest}"))
    } else {
        let limits = format!("{} to {}{unit}", short(omega * from), short(omega * to));
        let choice =
            format!("between {} and {}", short_above(from / stretch), short_below(to / stretch));
        Some(format!("{is} is outside {name}'s limits {limits}; choose --dt {choice}"))
    }
}

/// The largest angular frequency of the linearisation at the start, in rad/s; none if that turns nowhere, or grows.
fn start_frequency(request: &Request) -> Option<f64> {
    with_system!(request.system, request.q.len(), |model, D| fastest::<D>(&model, request), None)
}

/// The same, of a model. It is a function of its own for each, since matrices of many digits are large on the stack.
#[inline(never)]
fn fastest<const D: usize>(model: &impl Model<D>, request: &Request) -> Option<f64> {
    let start = State {
        q: std::array::from_fn::<_, D, _>(|i| request.q[i]),
        v: std::array::from_fn(|i| request.v[i]),
    };
    let values = eigenvalues(&Linearisation::generator_of(*model, &start));
    let fastest = values.iter().map(|z| [z.re.to_f64(), z.im.to_f64()]);
    let [re, im] = fastest.max_by(|a, b| a[1].total_cmp(&b[1]))?;
    (im > 0.0 && im.is_finite() && re.abs() <= 1e-9 * im).then_some(im)
}

/// Three digits of a positive number.
fn short(x: f64) -> String {
    digits(x, f64::round)
}

/// The same, not above it.
fn short_below(x: f64) -> String {
    digits(x, f64::floor)
}

/// The same, not below it.
fn short_above(x: f64) -> String {
    digits(x, f64::ceil)
}

fn digits(x: f64, round: fn(f64) -> f64) -> String {
    if !(1e-290..1e290).contains(&x) {
        return format!("{x:?}");
    }
    let exponent = x.log10().floor() as i32 - 2;
    let number = round(x / 10.0_f64.powi(exponent));
    // By way of a decimal, whose digits are these and no more.
    let rounded: f64 = format!("{number}e{exponent}").parse().unwrap_or(x);
    if (1e-4..1e7).contains(&rounded) { format!("{rounded}") } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits_and_bounds_lie_on_the_side_that_they_name() {
        for (x, rounded, below, above) in [
            (2.0, "2", "2", "2"),
            (0.632_455_5, "0.632", "0.632", "0.633"),
            (2.828_427_1, "2.83", "2.82", "2.83"),
            (1.573_4, "1.57", "1.57", "1.58"),
            (12_345.0, "12300", "12300", "12400"),
            (6.329e-9, "6.33e-9", "6.32e-9", "6.33e-9"),
            (9.999, "10", "9.99", "10"),
        ] {
            assert_eq!((&*short(x), &*short_below(x), &*short_above(x)), (rounded, below, above));
        }
    }
}
