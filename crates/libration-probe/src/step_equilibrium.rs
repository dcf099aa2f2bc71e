//! Equilibria of steps of other lengths than that of the subject.

use libration::linear::{Matrix, solve_matrix};

use crate::BlackBoxError;
use crate::linearised_step::LinearisedStep;
use crate::prober::{Prober, row};

/// Largest change of an equilibrium in a step, in units of the scales.
const AT_REST: f64 = 1e-9;
const MOST_ITERATIONS: usize = 12;
const MOST_HALVINGS: usize = 12;
/// Part of the largest entry that counts as none: neutral directions, such as those of a free base, stay.
const NEUTRAL: f64 = 1e-7;

/// The equilibrium of a step of `dt` seconds near a state, by Newton's method with steps of least norm; none if it finds none.
///
/// # Errors
/// The simulator fails.
pub(crate) fn step_equilibrium(
    prober: &mut Prober<'_>,
    state: &[f64],
    dt: f64,
) -> Result<Option<Vec<f64>>, BlackBoxError> {
    let scale = prober.subject.state_scale.clone();
    let n = state.len();
    let mut x = state.to_vec();
    let (mut rest, mut size) = change(prober, &x, dt)?;
    for _ in 0..MOST_ITERATIONS {
        if size <= AT_REST {
            return Ok(Some(x));
        }
        let step = LinearisedStep::of_states_at(prober, &x, dt)?;
        if !size.is_finite() || !step.a.is_finite() {
            return Ok(None);
        }
        // In units of the scales: (JᵀJ + λ) shift = −Jᵀ rest.
        let slope = Matrix::from_fn(n, n, |i, j| {
            let own = if i == j { 1.0 } else { 0.0 };
            (step.a[(i, j)] - own) * scale[j] / scale[i]
        });
        let mut normal = &slope.transposed() * &slope;
        let ridge = (NEUTRAL * slope.largest()).powi(2);
        (0..n).for_each(|i| normal[(i, i)] += ridge);
        let right = Matrix::from_fn(n, 1, |i, _| {
            -(0..n).map(|k| slope[(k, i)] * rest[k] / scale[k]).sum::<f64>()
        });
        let Some(shift) = solve_matrix(&normal, &right) else { return Ok(None) };
        let mut factor = 1.0;
        let mut is_better = false;
        for _ in 0..MOST_HALVINGS {
            let tried: Vec<f64> =
                (0..n).map(|i| x[i] + factor * shift[(i, 0)] * scale[i]).collect();
            let (other, other_size) = change(prober, &tried, dt)?;
            if other_size < size {
                (x, rest, size, is_better) = (tried, other, other_size, true);
                break;
            }
            factor /= 2.0;
        }
        if !is_better {
            return Ok(None);
        }
    }
    Ok((size <= AT_REST).then_some(x))
}

/// The change of a state in a step, and its norm in units of the scales.
fn change(prober: &mut Prober<'_>, x: &[f64], dt: f64) -> Result<(Vec<f64>, f64), BlackBoxError> {
    let subject = prober.subject;
    let next = prober.step(&row(x), &row(&subject.action), dt)?;
    let change: Vec<f64> = (0..x.len()).map(|i| next[(0, i)] - x[i]).collect();
    let scaled = change.iter().zip(&subject.state_scale).map(|(x, scale)| (x / scale).powi(2));
    let size = scaled.sum::<f64>().sqrt();
    Ok((change, if size.is_nan() { f64::INFINITY } else { size }))
}
