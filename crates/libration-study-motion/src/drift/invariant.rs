//! The quadratic form that a symplectic step conserves, along a run.

use libration::analysis::{QuadraticForm, UpdateMatrix};
use libration::number::{TwoFloat, Wide};
use libration::simulation::Sample;
use libration::{Float, Scalar, State};

/// Samples of a run at which the form is taken.
const SAMPLES: u64 = 100_000;

/// Follows `Q(yₙ)/Q(y₀)`, in double-double, so that what it shows is the rounding of the run alone.
pub(super) struct Invariant {
    form: QuadraticForm<TwoFloat>,
    stride: u64,
    steps: u64,
    /// The largest `|Q(yₙ)/Q(y₀) − 1|` so far.
    pub(super) largest: f64,
}

impl Invariant {
    /// The form that `step` carries along, for a run of `steps` steps from `start`.
    pub(super) fn new(step: &UpdateMatrix<Wide>, start: &State<f64, 1>, steps: u64) -> Self {
        let form = QuadraticForm::carried_by(step);
        let initial = form.at(&start.map(Wide::from_f64));
        Invariant {
            form: form.map(|c| TwoFloat::from(c / initial)),
            stride: steps.div_ceil(SAMPLES).max(1),
            steps,
            largest: 0.0,
        }
    }

    /// Takes note of one sample.
    pub(super) fn see(&mut self, sample: &Sample<f64, 1>) {
        if sample.step.is_multiple_of(self.stride) || sample.step == self.steps {
            let value = self.form.at(&sample.state.map(TwoFloat::from_f64));
            self.largest = self.largest.max((value - TwoFloat::one()).to_f64().abs());
        }
    }
}
