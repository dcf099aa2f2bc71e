//! The modes of a step beside those of the flow that it approximates.

use libration::linear::{Complex64, LinearPlant, Matrix, eigenvalues};
use serde::Serialize;

use crate::Subject;
use crate::flow::Flow;
use crate::linearised_step::{LinearisedStep, plant_of};

/// Matrices within the errors, from whose eigenvalues the error of an eigenvalue follows.
const SAMPLES: usize = 6;

/// A mode of the step; of a pair one.
#[derive(Clone, Debug, Serialize)]
pub struct ProbedMode {
    /// The states that move most, with their sizes relative to the largest.
    pub states: Vec<(String, f64)>,
    /// Real and imaginary part of the factor `z` of a step.
    pub factor: [f64; 2],
    /// `|z|`: above 1 the mode grows.
    pub radius: f64,
    /// Growth rate, frequency and damping of the step.
    pub step: Rates,
    /// The same of the flow; none if it is unknown.
    pub flow: Option<Rates>,
    /// Damping ratio that the step adds; negative: it takes damping away. None of a mode that changes its sign in each step.
    pub numerical_damping: Option<f64>,
    /// Estimated error of the growth rates in 1/s.
    pub error: f64,
}

/// Rates of a mode in continuous time.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Rates {
    /// The growth rate in 1/s; below zero the mode decays.
    pub growth_rate: f64,
    /// The frequency in Hz.
    pub frequency: f64,
    /// The damping ratio `−Re s/|s|`; none of `s = 0`.
    pub damping_ratio: Option<f64>,
}

impl Rates {
    /// The same with a growth rate of zero where it is no more than an error.
    pub fn without_error(self, error: f64) -> Self {
        let growth_rate = if self.growth_rate.abs() <= error { 0.0 } else { self.growth_rate };
        Rates { growth_rate, ..self }
    }

    fn of(s: Complex64) -> Self {
        let size = s.norm();
        Rates {
            growth_rate: s.re,
            frequency: s.im.abs() / core::f64::consts::TAU,
            damping_ratio: (size > 0.0).then(|| 0.0 - s.re / size),
        }
    }
}

/// Relative imaginary part of a factor up to which it is a real one.
const SPLIT: f64 = 1e-9;

/// The modes of a step, the one that grows fastest first.
pub(crate) fn modes(
    step: &LinearisedStep,
    flow: Option<&Flow>,
    subject: &Subject,
) -> Vec<ProbedMode> {
    let Some(plant) = step.plant(subject) else { return Vec::new() };
    let all = eigenvalues(&step.a).unwrap_or_default();
    let own_errors = eigenvalue_errors(&step.a, &step.a_errors, &all);
    let of_flow = flow.map(|flow| flow_values(flow, &all));
    let flow_errors = flow
        .zip(of_flow.as_ref())
        .map(|(flow, values)| eigenvalue_errors(&flow.a, &flow.a_errors, values));
    let details = plant.mode_details();
    let mut found = Vec::new();
    for detail in details {
        let z = if step.dt.is_finite() { (detail.value * step.dt).exp() } else { detail.value };
        let Some(k) = nearest(&all, z) else { continue };
        let s = detail.value;
        let flow_value = of_flow.as_ref().map(|values| values[k]);
        let own = Rates::of(s);
        let flow_rates = flow_value.map(Rates::of);
        let numerical_damping = flow_rates
            .and_then(|flow| Some(own.damping_ratio? - flow.damping_ratio?))
            // A factor that changes its sign in each step is no oscillation of the flow.
            .filter(|_| z.im.abs() > SPLIT * z.norm() || z.re > 0.0)
            // Of a motion at zero the ratio is that of roundings.
            .filter(|_| s.norm() > 100.0 * own_errors[k] / step.dt);
        let error = own_errors[k] / (z.norm() * step.dt);
        let error = flow_errors.as_ref().map_or(error, |errors| error.max(errors[k]));
        let is_error = |added: f64| added.abs() * s.norm() <= error;
        let numerical_damping =
            numerical_damping.map(|added| if is_error(added) { 0.0 } else { added });
        let (own, flow_rates) =
            (own.without_error(error), flow_rates.map(|flow| flow.without_error(error)));
        found.push(ProbedMode {
            states: detail.mode.states,
            factor: [z.re, z.im],
            radius: z.norm(),
            step: own,
            flow: flow_rates,
            numerical_damping,
            error,
        });
    }
    found
}

/// For each eigenvalue of the step that of the flow, followed through all halved steps.
fn flow_values(flow: &Flow, of_step: &[Complex64]) -> Vec<Complex64> {
    let rate = |z: &Complex64, dt: f64| z.ln() / dt;
    let mut current: Vec<Complex64> = of_step.iter().map(|z| rate(z, flow.steps[0].dt)).collect();
    for step in &flow.steps[1..] {
        let next: Vec<Complex64> =
            eigenvalues(&step.a).unwrap_or_default().iter().map(|z| rate(z, step.dt)).collect();
        current = matched(&current, &next);
    }
    matched(&current, &eigenvalues(&flow.a).unwrap_or_default())
}

/// The values of `others` in the order of the nearest of `values`.
pub(crate) fn matched(values: &[Complex64], others: &[Complex64]) -> Vec<Complex64> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, a) in values.iter().enumerate() {
        pairs.extend(others.iter().enumerate().map(|(j, b)| ((a - b).norm(), i, j)));
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut found: Vec<Option<Complex64>> = vec![None; values.len()];
    let mut used = vec![false; others.len()];
    for (_, i, j) in pairs {
        if found[i].is_none() && !used[j] {
            found[i] = Some(others[j]);
            used[j] = true;
        }
    }
    found.into_iter().zip(values).map(|(found, value)| found.unwrap_or(*value)).collect()
}

fn nearest(values: &[Complex64], z: Complex64) -> Option<usize> {
    (0..values.len()).min_by(|&i, &j| (values[i] - z).norm().total_cmp(&(values[j] - z).norm()))
}

/// The largest shifts of eigenvalues by errors of the matrix with irregular signs. That of a repeated one is the root of an error.
pub(crate) fn eigenvalue_errors(a: &Matrix, errors: &Matrix, values: &[Complex64]) -> Vec<f64> {
    let mut largest = vec![0.0_f64; values.len()];
    for sample in 0..SAMPLES {
        let moved = Matrix::from_fn(a.rows(), a.columns(), |i, j| {
            let turn =
                (((sample * a.rows() + i) * a.columns() + j) as f64) * 0.618_033_988_749_894_9;
            let sign = if turn.fract() < 0.5 { -1.0 } else { 1.0 };
            // At least a rounding.
            let error = errors[(i, j)].max(f64::EPSILON * a[(i, j)].abs());
            a[(i, j)] + sign * if error.is_finite() { error } else { 0.0 }
        });
        let Some(found) = eigenvalues(&moved) else { continue };
        for (largest, (value, other)) in
            largest.iter_mut().zip(values.iter().zip(matched(values, &found)))
        {
            *largest = largest.max((value - other).norm());
        }
    }
    largest
}

/// The states that move most in the mode of this factor.
pub(crate) fn name_mode(step: &LinearisedStep, z: Complex64, subject: &Subject) -> String {
    let plant: Option<LinearPlant> = plant_of(&step.a, &step.b, Some(step.dt), subject);
    let modes = plant.map(|plant| plant.mode_details()).unwrap_or_default();
    let upper = Complex64::new(z.re, z.im.abs());
    let near = |value: Complex64| ((value * step.dt).exp() - upper).norm();
    let best = modes.iter().min_by(|a, b| near(a.value).total_cmp(&near(b.value)));
    let names = |mode: &libration::linear::ModeDetails| {
        mode.mode.states.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>().join(", ")
    };
    best.map(names).unwrap_or_default()
}
