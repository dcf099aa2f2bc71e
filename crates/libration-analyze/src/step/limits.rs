//! Limits of the time step, and the order of splitting methods.

use libration::analysis::{
    Criterion, LargestStep, Letter, OrbitStart, OrderCertificate, SplittingCertificate,
    SymbolicStep,
};
use libration::{Elementary, Method};
use serde::Serialize;

use super::Request;
use crate::oscillator::CommonOscillator;

/// The largest time steps, in s, up to which every step meets a criterion over the horizon of the request.
/// `null` if every step meets it; absent without the criterion, or if its polynomials exceed exact
/// arithmetic.
///
/// Drift and amplitude are taken over the whole curve of an orbit. A run of few steps may miss its extremes
/// and tolerate a larger step.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LargestDt {
    /// For bounded orbits.
    pub bounded: Option<f64>,
    /// For an energy drift below `--max-drift` from the start of the request.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_drift: Option<Option<f64>>,
    /// For an energy drift below `--max-drift` from every start.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_drift_worst_start: Option<Option<f64>>,
    /// For a length of `q` below `--max-amplitude`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amplitude: Option<Option<f64>>,
    /// For an error below `--max-error` of the amplitude from every start. This limit is searched; the others
    /// are roots of polynomials.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trajectory_error: Option<Option<f64>>,
}

/// The order of a splitting method on systems whose force depends on positions alone. With forces that depend
/// on velocities a kick is not an exact flow, and most orders fall to one.
#[derive(Clone, Debug, Serialize)]
pub struct OrderOfWord {
    /// The letters of the word in the order of time.
    pub word: Vec<String>,
    /// Force evaluations of a step, where neighbouring steps share those at their ends.
    pub stages: usize,
    /// The order for a sum of any two parts.
    pub order: usize,
    /// The order for forces of positions.
    pub nystrom_order: usize,
    /// The order of the errors that are linear in the strength of the kicks.
    pub weak_order: usize,
    /// Whether a step back undoes a step.
    pub symmetric: bool,
    /// The norm of the leading error for forces of positions, over the power of the step.
    pub error_constant: f64,
    /// The largest relative difference of a coefficient from that of the exact flow, for words of 1, 2, …
    /// letters.
    pub residuals: Vec<f64>,
}

/// Length of the compared words, or more for methods of higher order.
const LETTERS: usize = 6;

impl OrderOfWord {
    /// The order of `method`; none if it is not a product of kicks and drifts.
    pub(crate) fn of(method: Method) -> Option<Self> {
        let shown = |letter: &Letter| match letter {
            Letter::Kick(w) => format!("kick {}", w.to_f64()),
            Letter::Drift(w) => format!("drift {}", w.to_f64()),
        };
        let order = method.order() as usize;
        let certificate = SplittingCertificate::new(method, order + 1)?;
        let words = OrderCertificate::new(method, LETTERS.max(order + 1))?;
        Some(OrderOfWord {
            word: certificate.word.iter().map(shown).collect(),
            stages: certificate.stages,
            order: certificate.order,
            nystrom_order: certificate.nystrom_order,
            weak_order: certificate.weak_order,
            symmetric: certificate.is_symmetric,
            error_constant: certificate.error_constant,
            residuals: words.residuals.iter().map(|r| r.to_f64()).collect(),
        })
    }
}

/// The largest steps of an oscillator from its polynomials.
pub(crate) fn largest_dt(
    step: Option<&SymbolicStep>,
    oscillator: CommonOscillator,
    request: &Request,
) -> Option<LargestDt> {
    let (step, unit) = (step?, oscillator.frequency()?.recip());
    let in_seconds = |z: LargestStep| match z {
        LargestStep::Limit(z) => Some((z * unit).to_f64()),
        LargestStep::Unlimited => None,
    };
    let (criteria, steps) = (&request.criteria, request.steps);
    let largest = |criterion: &Criterion| step.largest_step(criterion).map(in_seconds);
    let omega = oscillator.omega2.sqrt();
    let turning: Vec<f64> = request.system.v.iter().map(|v| v / omega).collect();
    let start = OrbitStart::new(&request.system.q, &turning);
    let drift = |start| {
        criteria
            .max_drift
            .and_then(|tolerance| largest(&Criterion::EnergyDrift { tolerance, steps, start }))
    };
    Some(LargestDt {
        bounded: largest(&Criterion::Bounded)?,
        energy_drift: drift(Some(start)),
        energy_drift_worst_start: drift(None),
        amplitude: criteria
            .max_amplitude
            .and_then(|limit| largest(&Criterion::Amplitude { limit, steps, start })),
        trajectory_error: criteria
            .max_error
            .map(|tolerance| in_seconds(step.largest_step_for_error(tolerance, steps))),
    })
}
