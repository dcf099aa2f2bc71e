//! A short run of the simulator beside its linearised step.

use serde::Serialize;

use crate::BlackBoxError;
use crate::convergence::displaced;
use crate::linearised_step::LinearisedStep;
use crate::prober::Prober;

/// Most steps of the run.
const STEPS: usize = 50;
/// Displacement in units of the scales: nonlinear terms are about as large relative to it.
const DISPLACEMENT: f64 = 1e-5;
/// Growth at which the run ends, so that the deviation remains small.
const MOST_GROWTH: f64 = 1000.0;

/// How well the matrices predict a run of the simulator from a small deviation.
#[derive(Clone, Debug, Serialize)]
pub struct Confirmation {
    /// Steps of the run.
    pub steps: usize,
    /// The deviation at the start in units of the scales.
    pub displacement: f64,
    /// The largest distance of a deviation from the predicted one, relative to the largest deviation.
    pub error: f64,
}

impl Confirmation {
    pub(crate) fn run(
        prober: &mut Prober<'_>,
        step: &LinearisedStep,
    ) -> Result<Self, BlackBoxError> {
        let subject = prober.subject;
        let (action, scale) = (&subject.action, &subject.state_scale);
        let mut base = subject.state.clone();
        let mut moved = displaced(prober, DISPLACEMENT);
        let mut predicted: Vec<f64> = moved.iter().zip(&base).map(|(a, b)| a - b).collect();
        let size =
            |x: &[f64]| x.iter().zip(scale).map(|(x, scale)| (x / scale).abs()).fold(0.0, f64::max);
        let (mut largest, mut error, mut steps) = (size(&predicted), 0.0_f64, 0);
        while steps < STEPS && largest < MOST_GROWTH * DISPLACEMENT {
            base = prober.step_one(&base, action, subject.dt)?;
            moved = prober.step_one(&moved, action, subject.dt)?;
            predicted = step.a.apply(&predicted);
            let deviation: Vec<f64> = moved.iter().zip(&base).map(|(a, b)| a - b).collect();
            largest = largest.max(size(&deviation));
            let apart: Vec<f64> = deviation.iter().zip(&predicted).map(|(a, b)| a - b).collect();
            error = error.max(size(&apart) / largest);
            steps += 1;
        }
        Ok(Confirmation { steps, displacement: DISPLACEMENT, error })
    }
}
