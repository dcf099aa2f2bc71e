//! Defects of a step: volume, symplecticity, reversibility and energy.

use libration::linear::{Matrix, eigenvalues};
use serde::Serialize;

use crate::convergence::displaced;
use crate::flow::Flow;
use crate::linearised_step::LinearisedStep;
use crate::prober::Prober;
use crate::{BlackBoxError, EnergyDrift, Subject};

/// Part of the scales by which the state is displaced.
const DISPLACEMENT: f64 = 0.1;

/// Roundings of the size of each factor of a step.
const ROUNDINGS: f64 = 8.0;

/// What a step does that the flow of a conservative system does not.
#[derive(Clone, Debug, Serialize)]
pub struct Defects {
    /// Rate of change of phase-space volume by the step, `ln|det A|/dt`, in 1/s.
    pub volume_rate: f64,
    /// That of the flow, the trace of its rates.
    pub flow_volume_rate: Option<f64>,
    /// `‖AᵀJA − J‖/‖J‖` with the momenta `M q̇`; none without known positions, velocities and masses, or of one degree of freedom.
    pub symplecticity: Option<f64>,
    /// Distance from the start after a step, reversed velocities, a step and reversed velocities, relative to the length of the step;
    /// none without known positions and velocities.
    pub reversibility: Option<f64>,
    /// The same of half the step.
    pub reversibility_halved: Option<f64>,
    /// Drift of the energy; none if the energy is unknown.
    pub energy: Option<EnergyDrift>,
}

impl Defects {
    pub(crate) fn measure(
        prober: &mut Prober<'_>,
        step: &LinearisedStep,
        flow: Option<&Flow>,
        pairs: Option<&[(usize, usize)]>,
        is_at_rest: bool,
    ) -> Result<Self, BlackBoxError> {
        let subject = prober.subject;
        let sizes = eigenvalues(&step.a).unwrap_or_default();
        let volume_rate = sizes.iter().map(|z| z.norm().ln()).sum::<f64>() / step.dt;
        // A rate within its error is zero, as are those of modes.
        let rounding = ROUNDINGS * f64::EPSILON * sizes.len() as f64 / step.dt;
        let known = |rate: f64, error: f64| if rate.abs() <= error { 0.0 } else { rate };
        let of_flow =
            |flow: &Flow| known(flow.a.trace(), rounding.max(flow.a_errors.trace().abs()));
        let all_paired = pairs.filter(|pairs| pairs.len() * 2 == subject.state.len());
        let (mut reversibility, mut halved) = (None, None);
        if let Some(pairs) = all_paired {
            reversibility = Some(irreversibility(prober, pairs, subject.dt)?);
            if !subject.has_fixed_dt {
                halved = Some(irreversibility(prober, pairs, subject.dt / 2.0)?);
            }
        }
        let velocities = pairs.filter(|pairs| !pairs.is_empty());
        let energy = EnergyDrift::measure(prober, longest_period(flow), is_at_rest, velocities)?;
        Ok(Defects {
            volume_rate: known(volume_rate, rounding),
            flow_volume_rate: flow.map(of_flow),
            symplecticity: all_paired.and_then(|pairs| symplecticity(&step.a, pairs, subject)),
            reversibility,
            reversibility_halved: halved,
            energy,
        })
    }
}

/// The longest period of an oscillation of the system, in s; 0 without one.
fn longest_period(flow: Option<&Flow>) -> f64 {
    let values = flow.and_then(|flow| eigenvalues(&flow.a)).unwrap_or_default();
    let largest = values.iter().map(|s| s.norm()).fold(0.0, f64::max);
    let slowest = values.iter().map(|s| s.im.abs()).filter(|omega| *omega > 1e-6 * largest);
    slowest.fold(f64::INFINITY, f64::min).recip() * core::f64::consts::TAU
}

fn irreversibility(
    prober: &mut Prober<'_>,
    pairs: &[(usize, usize)],
    dt: f64,
) -> Result<f64, BlackBoxError> {
    let subject = prober.subject;
    let start = displaced(prober, DISPLACEMENT);
    let flip = |x: &mut Vec<f64>| pairs.iter().for_each(|&(_, v)| x[v] = -x[v]);
    let mut x = prober.step_one(&start, &subject.action, dt)?;
    let distance = |a: &[f64], b: &[f64]| {
        let parts = a.iter().zip(b).zip(&subject.state_scale);
        parts.map(|((a, b), scale)| ((a - b) / scale).abs()).fold(0.0, f64::max)
    };
    let length = distance(&x, &start);
    flip(&mut x);
    let mut x = prober.step_one(&x, &subject.action, dt)?;
    flip(&mut x);
    Ok(if length > 0.0 { distance(&x, &start) / length } else { 0.0 })
}

fn symplecticity(a: &Matrix, pairs: &[(usize, usize)], subject: &Subject) -> Option<f64> {
    let d = pairs.len();
    let mass = match &subject.mass {
        Some(mass) => mass.clone(),
        None if d == 1 => Matrix::identity(1),
        None => return None,
    };
    let order: Vec<usize> =
        pairs.iter().map(|pair| pair.0).chain(pairs.iter().map(|pair| pair.1)).collect();
    let a = Matrix::from_fn(2 * d, 2 * d, |i, j| a[(order[i], order[j])]);
    // q̇ᵀ M dq: the form is that of momenta M q̇ at a fixed M.
    let mut form = Matrix::zeros(2 * d, 2 * d);
    form.set_block((0, d), &mass);
    form.set_block((d, 0), &mass.transposed().scaled(-1.0));
    let moved = &(&a.transposed() * &form) * &a;
    Some(moved.plus(&form.scaled(-1.0)).row_sum_norm() / form.row_sum_norm())
}
