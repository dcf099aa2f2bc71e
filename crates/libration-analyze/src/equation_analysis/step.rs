//! The order and the eigenvalues of a step of a system by equations.

use libration::equations::StepProgram;
use libration::linear::{Matrix, eigenvalues};
use libration::number::{Dual, Wide};
use libration::{Elementary, Scalar};
use libration_settings::equations::EquationSystem;

/// The powers of two by which the time step is multiplied to find the order, from the least on: the first at which the error is seen beside
/// the rounding of the weights of a method to `f64` is taken, since the next term of the error is smallest there.
const POWERS: core::ops::RangeInclusive<i64> = -11..=11;

/// The part of a change of the state above which a difference is no rounding of weights: a few dozens of roundings.
const SEEN: f64 = 64.0 * f64::EPSILON;

/// Distances of the places at which the order is computed from the start. At the nearer one, functions are defined where they are at
/// the start.
const SHIFTS: [f64; 2] = [1.0, 0.01];

/// The order of a step on a system, from the error of a small step against two of half the length, and that of a smaller one. It is
/// the least of all states at two places near the start, since in special states, such as at rest, terms of the error vanish.
///
/// `start` has positions, velocities and inputs, and `places` those of the states that count.
pub fn step_order(step: &StepProgram, start: &[f64], places: &[usize], dt: f64) -> Option<u32> {
    SHIFTS.into_iter().filter_map(|shift| order_at(step, start, places, dt, shift)).min()
}

/// The order at a state that is the start but for parts of the golden ratio, `shift` times as large as a coordinate or as 1.
fn order_at(
    step: &StepProgram,
    start: &[f64],
    places: &[usize],
    dt: f64,
    shift: f64,
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
    // The change of each state in a step, and its difference from that in two steps of half the length.
    let mut differences = |power: i64| -> Vec<[Wide; 2]> {
        let (one, two) = (after(&state, power, 1), after(&state, power - 1, 2));
        let each = state.iter().zip(one.iter().zip(&two));
        each.map(|(&start, (&one, &two))| [one - start, one - two]).collect()
    };
    let mut found: Vec<Option<f64>> = vec![None; states];
    for power in POWERS.step_by(2) {
        if places.iter().all(|&place| found[place].is_some()) {
            break;
        }
        let (larger, smaller) = (differences(power), differences(power - 1));
        for &place in places {
            let ([_, larger], [change, smaller]) = (larger[place], smaller[place]);
            let part = (smaller * change.recip()).abs().to_f64();
            let ratio = (larger * smaller.recip()).abs().to_f64();
            if found[place].is_none() && part > SEEN && ratio.is_finite() {
                found[place] = Some(ratio.log2().round() - 1.0);
            }
        }
    }
    let orders = places.iter().filter_map(|&place| found[place]);
    let least = orders.reduce(f64::min)?;
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
