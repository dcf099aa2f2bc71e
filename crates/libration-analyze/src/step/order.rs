//! The order and the eigenvalues of a step of a system.

use libration::equations::StepProgram;
use libration::linear::{Matrix, eigenvalues};
use libration::number::{Dual, Wide};
use libration::{Elementary, Scalar};
use libration_settings::equations::EquationSystem;

/// The powers of two by which the time step is multiplied to find the order, and by one more. The next term of the error is about 2⁻¹⁰
/// of the first, unless the first is small, as under weak friction beside stiff springs: then steps are smaller. In steps that are much
/// smaller than the first, the rounding of weights of a method to `f64` is its largest error.
const SMALL: [i64; 3] = [-10, -15, -20];

/// The largest distance of a power from a whole number: that of a next term of 3 % of the error, since `log₂((1 + κ)/(1 + κ/2))` is
/// about `0.72 κ`.
const WHOLE: f64 = 0.02;

/// Distances of the places at which the order is computed from the start. At the nearer one, functions are defined where they are at
/// the start.
const SHIFTS: [f64; 2] = [1.0, 0.01];

/// The order of a step on a system, from the error of a small step against two of half the length, and that of a smaller one. It is
/// the least of all states at two places near the start, since in special states, such as at rest, terms of the error vanish.
///
/// `start` has positions, velocities and inputs, and `places` those of the states that count.
pub fn step_order(step: &StepProgram, start: &[f64], places: &[usize], dt: f64) -> Option<u32> {
    SHIFTS.into_iter().filter_map(|shift| order_at(step, start, places, dt, shift, 0.0)).min()
}

/// The order of a table whose certificate is for other forces: that of the errors that are seen beside the rounding of its coefficients
/// to `f64`, or none of them if it has not lost its order.
pub(crate) fn lost_order(
    step: &StepProgram,
    start: &[f64],
    places: &[usize],
    dt: f64,
) -> Option<u32> {
    SHIFTS.into_iter().filter_map(|shift| order_at(step, start, places, dt, shift, SEEN)).min()
}

/// The part of the change of a state in a step above which a difference is no rounding of coefficients: some hundreds of roundings.
const SEEN: f64 = 256.0 * f64::EPSILON;

/// The order at a state that is the start but for parts of the golden ratio, `shift` times as large as a coordinate or as 1.
fn order_at(
    step: &StepProgram,
    start: &[f64],
    places: &[usize],
    dt: f64,
    shift: f64,
    least_part: f64,
) -> Option<u32> {
    let states = step.program().outputs().len();
    let mut run = step.program().on::<Wide>();
    let mut state: Vec<Wide> = start.iter().map(|&x| Wide::from_f64(x)).collect();
    for &place in places {
        let part = (0.618_033_988_749_895 * (1.0 + place as f64)).fract() - 0.5;
        let near = start[place] + shift * part * start[place].abs().max(1.0);
        state[place] = Wide::from_f64(near);
    }
    let inputs = state.split_off(states);
    let dt = Wide::from_f64(dt);
    let mut after = |state: &[Wide], power: i64, count: u32| -> Vec<Wide> {
        (0..count).fold(state.to_vec(), |state, _| {
            let dt = dt.scaled(power);
            let all: Vec<Wide> = state.iter().chain(&inputs).copied().chain([dt]).collect();
            run.run(&all).collect()
        })
    };
    let mut powers = Vec::new();
    for power in SMALL {
        let mut changes = Vec::new();
        let [larger, smaller] = [power, power - 1].map(|power| -> Vec<Wide> {
            let (one, two) = (after(&state, power, 1), after(&state, power - 1, 2));
            changes = one.iter().zip(&state).map(|(&one, &start)| one - start).collect();
            one.iter().zip(&two).map(|(&one, &two)| one - two).collect()
        });
        let ratio_of = |&place: &usize| {
            let [larger, smaller] = [larger[place], smaller[place]];
            // Errors below 2⁻⁹⁰⁰ are rounding: the step has no other.
            let is_error = larger.exponent().is_some_and(|exponent| exponent > -900);
            let part = || (smaller * changes[place].recip()).abs().to_f64();
            let is_error = is_error && (least_part == 0.0 || part() >= least_part);
            let ratio = (larger * smaller.recip()).to_f64();
            (is_error && ratio.is_finite()).then_some(ratio)
        };
        let ratios: Vec<f64> = places.iter().filter_map(ratio_of).collect();
        powers = ratios.iter().map(|ratio| ratio.abs().log2()).collect();
        // An error that changes its sign has no power.
        let is_power =
            |ratio: &f64| *ratio > 0.0 && (ratio.log2() - ratio.log2().round()).abs() < WHOLE;
        if ratios.iter().all(is_power) {
            break;
        }
    }
    let least = powers.iter().map(|power| power.round() - 1.0).reduce(f64::min)?;
    // Without an order, halved steps promise nothing.
    (least >= 1.0).then_some(least as u32)
}

/// The largest size of an eigenvalue of a step at a state: positions, velocities and inputs.
pub fn spectral_radius(
    step: &StepProgram,
    system: &EquationSystem,
    at: &[f64],
    dt: f64,
) -> Option<f64> {
    let mut run = step.program().on::<Dual<f64>>();
    let mut inputs: Vec<Dual<f64>> = at.iter().map(|&x| Dual::constant(x)).collect();
    inputs.push(Dual::constant(dt));
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for named in &system.states {
        inputs[named.place] = Dual::variable(at[named.place]);
        let end: Vec<f64> = run.run(&inputs).map(|x| x.du).collect();
        columns.push(system.states.iter().map(|state| end[state.place]).collect());
        inputs[named.place] = Dual::constant(at[named.place]);
    }
    let matrix = Matrix::from_fn(columns.len(), columns.len(), |i, j| columns[j][i]);
    eigenvalues(&matrix)?.into_iter().map(|value| value.norm()).reduce(f64::max)
}
