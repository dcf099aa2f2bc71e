//! Stable time steps of plants with modes that neither grow nor decay, under forces of velocities.

use libration_core::number::Wide;
use libration_core::{AnyMethod, Scalar};
use libration_equations::{Definitions, Equations, Evaluation, StepProgram};
use libration_linear::{Matrix, eigenvalues};
use num_complex::Complex64;

use super::eigenvalues::{characteristic_polynomial, largest_root, roots};
use super::{LinearStepper, StepWindow};

/// The most states, since the time of the arithmetic rises with their fourth power.
pub(crate) const MOST_EXACT: usize = 12;

/// Growth of 1024-bit numbers that is rounding: several equal eigenvalues round by a root of 2⁻¹⁰²⁴.
const EXACT: f64 = 1e-50;

/// Roundings of the entries of a plant, per time of its fastest mode, that count as none.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// The first step of the search, times the size of the fastest mode.
const FIRST: f64 = 1.0 / 1024.0;

/// Growth in `f64` that is no rounding: a double eigenvalue is parted by the root of one.
const CLEAR: f64 = 1e-6;

/// Steps of the search in each doubling.
const POINTS: f64 = 3.0;

/// Halvings of the interval in which a window ends.
const HALVINGS: usize = 30;

/// The windows of steps from a 1024th of the time `1/|λ|` of the fastest mode to `most` of them, by eigenvalues of the update matrix in
/// 1024-bit arithmetic: growth as small as that of the fifth power of a step is one.
///
/// None of a plant with too many states. Windows narrower than a quarter of their end may be missed.
pub(crate) fn neutral_windows(
    stepper: &LinearStepper,
    method: AnyMethod,
    values: &[Complex64],
    most: f64,
) -> Option<Vec<StepWindow>> {
    let fastest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
    if values.len() > MOST_EXACT || fastest == 0.0 || !most.is_finite() {
        return None;
    }
    let equations = equations_of(stepper)?;
    let program = StepProgram::of(method, equations.dynamics());
    let mut run = program.program().on::<Wide>();
    // Roundings of the entries may let an exact mode grow.
    let exact = largest_rate(&stepper.rates);
    let is_neutral = exact.abs() <= EXACT * fastest;
    let mut is_stable = |z: f64| {
        let dt = z / fastest;
        let step = stepper.with_step::<f64>(method, dt).map(|step| step.update_matrix());
        let known = step.and_then(|matrix| eigenvalues(&matrix)).unwrap_or_default();
        if known.iter().any(|value| value.norm() > 1.0 + CLEAR) {
            return false;
        }
        let allowed = if is_neutral { EXACT } else { ROUNDINGS * z + exact.max(0.0) * dt };
        growth(&mut run, values.len(), dt) <= allowed
    };
    let count = (POINTS * (most / FIRST).log2()).ceil() as i32;
    let place = |k: i32| most * (FIRST / most).powf(1.0 - f64::from(k) / f64::from(count));
    let states: Vec<bool> = (0..=count).map(|k| is_stable(place(k))).collect();
    if states[count as usize] && matches!(method, AnyMethod::Implicit(_)) {
        return None;
    }
    let mut windows: Vec<StepWindow> = Vec::new();
    let mut from = states[0].then_some(0.0);
    for k in 1..=count {
        let (before, own) = (states[k as usize - 1], states[k as usize]);
        if before != own {
            let (mut inside, mut outside) = (place(k - 1), place(k));
            for _ in 0..HALVINGS {
                let middle = 0.5 * (inside + outside);
                if is_stable(middle) == before { inside = middle } else { outside = middle }
            }
            match from.take() {
                Some(from) => windows.push(StepWindow { from, to: inside }),
                None => from = Some(outside),
            }
        }
    }
    windows.extend(from.map(|from| StepWindow { from, to: most }));
    Some(windows.into_iter().map(|window| window.scaled(fastest.recip())).collect())
}

/// The plant as equations, whose constants are its entries to the last bit.
fn equations_of(stepper: &LinearStepper) -> Option<Equations> {
    let (rates, d) = (&stepper.rates, stepper.positions);
    let acceleration = |i: usize| {
        let term = |j: usize| {
            let (name, prime) = if j < d { (j, "") } else { (j - d, "'") };
            format!("({:?})*x{name}{prime}", rates[(d + i, j)])
        };
        let terms: Vec<String> =
            (0..2 * d).filter(|&j| rates[(d + i, j)] != 0.0).map(term).collect();
        let sum = if terms.is_empty() { format!("0*x{i}") } else { terms.join(" + ") };
        (format!("x{i}"), sum)
    };
    let definitions = Definitions {
        coordinates: (0..d).map(|i| format!("x{i}")).collect(),
        accelerations: (0..d).map(acceleration).collect(),
        ..Definitions::default()
    };
    Equations::new(&definitions).ok()
}

/// The largest size of an eigenvalue of the update matrix, less 1.
fn growth(run: &mut Evaluation<'_, Wide>, states: usize, dt: f64) -> f64 {
    let mut rows = vec![vec![Wide::ZERO; states]; states];
    for j in 0..states {
        let mut inputs = vec![Wide::ZERO; states + 1];
        inputs[j] = Wide::one();
        inputs[states] = Wide::from_f64(dt);
        for (i, x) in run.run(&inputs).enumerate() {
            rows[i][j] = x;
        }
    }
    let size = largest_root(&characteristic_polynomial(&rows));
    let growth = (size - Wide::one()).to_f64();
    if growth.is_nan() { f64::INFINITY } else { growth }
}

/// The largest real part of an eigenvalue.
fn largest_rate(rates: &Matrix) -> f64 {
    let row = |i: usize| rates.row(i).iter().map(|&x| Wide::from_f64(x)).collect();
    let rows: Vec<Vec<Wide>> = (0..rates.rows()).map(row).collect();
    let all = roots(&characteristic_polynomial(&rows));
    all.iter().map(|root| root.re.to_f64()).fold(f64::NEG_INFINITY, f64::max)
}
