//! A linear plant with one degree of freedom and its discretisation.

use std::rc::Rc;

use libration_core::control::Feedback;
use libration_core::number::Wide;
use libration_core::{Integrator, Model, Scalar, State};

use super::ZohStep;
use crate::UpdateMatrix;

/// Steps of any size.
type Steps<'a> = Rc<dyn Fn(Wide) -> ZohStep + 'a>;

/// A plant with one degree of freedom, linear or linearised, with the step that is taken on it.
pub struct Plant<'a> {
    /// A step of any size.
    pub(super) step: Steps<'a>,
    /// The number of equal substeps and their kind.
    pub(super) grid: Option<(u64, Steps<'a>)>,
    /// The Jacobian of the rate of change.
    pub(super) generator: UpdateMatrix<Wide>,
    /// The time step in seconds.
    pub(super) dt: Wide,
    /// Whether steps have no error, so that all is known of what lies between their ends.
    pub(super) exact: bool,
    /// Whether steps are those of the flow of the generator.
    pub(super) flows: bool,
}

impl<'a> Plant<'a> {
    /// `model` about the state `at`, in steps of `dt` seconds by `integrator`.
    pub fn new(
        integrator: impl Integrator + 'a,
        model: impl Model<1> + 'a,
        at: State<f64, 1>,
        dt: f64,
    ) -> Self {
        let generator = UpdateMatrix::of_rates(model, &at);
        let step = Rc::new(move |h| ZohStep::of(integrator, model, &at, h));
        Plant { step, generator, dt: Wide::from_f64(dt), exact: false, flows: false, grid: None }
    }

    /// A plant with exact steps, without an integrator.
    pub fn exact(model: impl Model<1> + 'a, at: State<f64, 1>, dt: f64) -> Self {
        let generator = UpdateMatrix::of_rates(model, &at);
        let step = Rc::new(move |h| ZohStep::exact(model, &at, h));
        Plant { step, generator, dt: Wide::from_f64(dt), exact: true, flows: true, grid: None }
    }

    /// The plant with `count` equal integrator steps per period of the loop.
    pub fn substeps(self, count: u64) -> Self {
        let fine = Rc::clone(&self.step);
        let one = Rc::clone(&fine);
        let many = move |h: Wide| repeated(&one(h / Wide::from_f64(count as f64)), count);
        Plant { step: Rc::new(many), grid: Some((count, fine)), ..self }
    }

    /// The natural frequency or growth rate of the plant, in rad/s.
    pub fn rate(&self) -> f64 {
        let [aq, av] = [0, 1].map(|j| self.generator.entry(1, j).to_f64().abs());
        aq.sqrt().max(av)
    }

    /// This, with noise and cost as a simulation has them though its steps be exact: see [`Plant::cost`].
    pub fn with_simulated_noise(self) -> Self {
        Plant { exact: false, ..self }
    }

    /// A step of the loop that `feedback` closes at once, of `dt` seconds.
    pub(super) fn closed(&self, feedback: Feedback, dt: Wide) -> UpdateMatrix<Wide> {
        let ZohStep { phi, gamma } = (self.step)(dt);
        UpdateMatrix::from_map(|e| phi.apply(&e).plus(-fed_back(feedback, &e), gamma))
    }
}

/// The repeated step.
pub(super) fn repeated(step: &ZohStep, count: u64) -> ZohStep {
    let none = ZohStep { phi: UpdateMatrix::identity(), gamma: State::origin() };
    (0..count).fold(none, |all, _| all.then(step))
}

/// `K·y`: minus the command.
pub(super) fn fed_back(feedback: Feedback, y: &State<Wide, 1>) -> Wide {
    Wide::from_f64(feedback.position) * y.q[0] + Wide::from_f64(feedback.velocity) * y.v[0]
}
