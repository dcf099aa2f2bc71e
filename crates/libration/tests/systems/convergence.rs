//! Every system under every method converges to the exact solution, at the method's order.

use std::iter::zip;

use libration::{Float, Integrator, Method, Model, State, with_method, with_system};

use crate::case::Case;

/// The order of `method`: a force that depends on the velocity turns the splitting methods into
/// methods of order 1, since a kick is no longer an exact flow.
fn order(case: &Case, method: Method) -> u32 {
    if case.is_damped() && method != Method::Rk4 { 1 } else { method.order() }
}

/// The errors of position and velocity, Euclidean, at the end of `steps` steps.
fn errors<const D: usize>(
    model: impl Model<D>,
    case: &Case,
    method: Method,
    steps: u32,
) -> [f64; 2] {
    let system = model.on::<f64>();
    let dt = case.time / f64::from(steps);
    let start = case.start.state::<D>();
    let end: State<f64, D> =
        with_method!(method, |m| (0..steps).fold(start, |state, _| m.step(&system, state, dt)));
    [distance(&end.q, &case.end.q), distance(&end.v, &case.end.v)]
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    zip(a, b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// The largest coordinate at either end.
fn scale(case: &Case) -> f64 {
    [&case.start, &case.end]
        .into_iter()
        .flat_map(|point| point.q.iter().chain(&point.v))
        .fold(0.0, |largest, x| x.abs().max(largest))
}

/// Halves the step twice and measures the order twice, in position and in velocity.
///
/// The error is `C Δtᵖ(1 + cΔt + …)`, hence the measured order `p + δ` with `δ = O(Δt)`. From one
/// halving to the next δ halves, or better: the change between the two measurements is at least
/// the δ of the second. The tolerance is twice that change, for the terms beyond, plus the effect
/// of rounding: ten roundings a step of relative size `u`, all of one sign.
#[test]
fn every_method_converges_at_its_order_in_position_and_velocity() {
    for case in Case::all() {
        for method in Method::ALL {
            let order = order(&case, method);
            // Fine enough for the leading term to dominate, coarse enough to stand out of the
            // rounding errors.
            let steps = match order {
                1 => 1 << 13,
                2 => 1 << 9,
                // Its error is so small that with more steps rounding would show.
                _ if method == Method::Suzuki4 => 1 << 6,
                _ => 1 << 7,
            };
            let [coarse, middle, fine] = [steps, 2 * steps, 4 * steps].map(|steps| {
                with_system!(
                    case.system,
                    case.dimension(),
                    |model, D| errors::<D>(model, &case, method, steps),
                    panic!("{} does not exist in that dimension", case.name)
                )
            });
            for (i, part) in ["position", "velocity"].into_iter().enumerate() {
                let first = (coarse[i] / middle[i]).log2();
                let second = (middle[i] / fine[i]).log2();
                let rounding = 10.0 * f64::from(4 * steps) * f64::UNIT_ROUNDOFF * scale(&case);
                let tolerance =
                    2.0 * (first - second).abs() + 2.0 * rounding / fine[i] / f64::ln(2.0);
                let what = format!("{}, {}, {part}", case.name, method.name());
                assert!(tolerance < 0.25, "{what}: {first} then {second}: not yet asymptotic");
                assert!(
                    (second - f64::from(order)).abs() <= tolerance,
                    "{what}: order {second}, not {order} within {tolerance}; errors {coarse:?}, \
                     {middle:?}, {fine:?}"
                );
            }
        }
    }
}
