//! The vectors of a step in memory, and the arithmetic on them.

use libration_batch::ensemble::Execution;

use super::forces::Forces;
use super::step_plan::{Action, Register, StepPlan};

/// A vector and, with compensated sums, what its sums lost (see `number::Compensated` of `libration-core`).
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyVector {
    pub(crate) values: Vec<f64>,
    /// As long as the values, or empty.
    pub(crate) lost: Vec<f64>,
}

impl BodyVector {
    pub(crate) fn new(values: Vec<f64>, is_compensated: bool) -> Self {
        let lost = if is_compensated { vec![0.0; values.len()] } else { Vec::new() };
        BodyVector { values, lost }
    }
}

/// Runs the actions of one step, whose time step is multiplied by `scale`. Returns whether none was stopped; after a stop the vectors have no meaning.
pub(crate) fn run(
    plan: &StepPlan,
    scale: f64,
    vectors: &mut [BodyVector],
    forces: &Forces<'_>,
    on: &Execution,
    should_stop: &dyn Fn() -> bool,
) -> bool {
    for &(action, register) in &plan.actions {
        if matches!(action, Action::Accelerations(_)) && should_stop() {
            return false;
        }
        let action = match action {
            Action::Increment { x, factor, y } => {
                Action::Increment { x, factor: factor * scale, y }
            }
            action => action,
        };
        let mut out = core::mem::take(&mut vectors[register]);
        write(action, vectors, &mut out, forces, on);
        vectors[register] = out;
    }
    for &(a, b) in &plan.exchanges {
        vectors.swap(a, b);
    }
    true
}

fn write(
    action: Action,
    vectors: &[BodyVector],
    out: &mut BodyVector,
    forces: &Forces<'_>,
    on: &Execution,
) {
    let values = |register: Register| vectors[register].values.as_slice();
    let lost = |register: Register| vectors[register].lost.as_slice();
    if out.lost.is_empty() {
        let of_two = |out: &mut [f64], a, b, operation: fn(f64, f64, f64) -> f64, factor| {
            for ((out, &a), &b) in out.iter_mut().zip(values(a)).zip(values(b)) {
                *out = operation(a, b, factor);
            }
        };
        let out = &mut out.values;
        match action {
            Action::Increment { x, factor, y } => of_two(out, x, y, |x, y, h| x + h * y, factor),
            Action::Sum(a, b) => of_two(out, a, b, |a, b, _| a + b, 1.0),
            Action::Difference(a, b) => of_two(out, a, b, |a, b, _| a - b, 1.0),
            Action::Multiple(..) | Action::Ratio(..) => multiply(action, vectors, out),
            Action::Accelerations(at) => forces.accelerations(values(at), out, on),
        }
        return;
    }
    match action {
        Action::Increment { x, factor, y } => {
            let increments = values(y).iter().map(|y| (factor * y, 0.0));
            add(values(x), lost(x), increments, out);
        }
        Action::Sum(a, b) => {
            add(values(a), lost(a), values(b).iter().copied().zip(lost(b).iter().copied()), out);
        }
        Action::Difference(a, b) => {
            let negative = values(b).iter().zip(lost(b)).map(|(value, lost)| (-value, -lost));
            add(values(a), lost(a), negative, out);
        }
        Action::Multiple(..) | Action::Ratio(..) => {
            multiply(action, vectors, &mut out.values);
            out.lost.fill(0.0);
        }
        Action::Accelerations(at) => {
            forces.accelerations(values(at), &mut out.values, on);
            out.lost.fill(0.0);
        }
    }
}

fn multiply(action: Action, vectors: &[BodyVector], out: &mut [f64]) {
    match action {
        Action::Multiple(factor, a) => {
            out.iter_mut().zip(&vectors[a].values).for_each(|(out, a)| *out = factor * a);
        }
        Action::Ratio(a, num, den) => {
            let (num, den) = (f64::from(num), f64::from(den));
            out.iter_mut().zip(&vectors[a].values).for_each(|(out, a)| *out = a * num / den);
        }
        _ => {}
    }
}

/// Sums with their rounding errors (Kahan 1965, Neumaier 1974).
fn add(
    values: &[f64],
    lost: &[f64],
    others: impl Iterator<Item = (f64, f64)>,
    out: &mut BodyVector,
) {
    let outs = out.values.iter_mut().zip(&mut out.lost);
    for (((out, out_lost), (&a, &a_lost)), (b, b_lost)) in
        outs.zip(values.iter().zip(lost)).zip(others)
    {
        let sum = a + b;
        let part = sum - a;
        let low = (a - (sum - part)) + (b - part) + (a_lost + b_lost);
        let value = sum + low;
        (*out, *out_lost) = (value, low - (value - sum));
    }
}
