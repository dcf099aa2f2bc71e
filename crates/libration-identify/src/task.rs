//! An identification as a task: a recording, and what is to be identified of it.

use libration_work::Work;

use crate::effort::Effort;
use crate::estimate::Estimate;
use crate::hold::Hold;
use crate::model::Model;
use crate::noise::NoiseKind;
use crate::recording::Recording;
use crate::request::Request;
use crate::response::ResponseKind;
use crate::start::Start;

/// A recording with what is to be identified of it.
#[derive(Clone, Copy)]
pub(crate) struct Task<'a, 'w> {
    pub(crate) recording: &'a Recording,
    pub(crate) request: &'a Request,
    /// The largest dead time, in s.
    pub(crate) largest: f64,
    /// Evaluations of the likelihood that the search of a model may take.
    pub(crate) evaluations: u64,
    pub(crate) work: Work<'w>,
}

impl<'w> Task<'_, 'w> {
    /// The effort of the search of a model.
    pub(crate) fn effort(&self) -> Effort<'w> {
        Effort::limited(self.work, self.evaluations, self.recording.responses.len())
    }

    /// A form of response with the first noise to search it with.
    pub(crate) fn model(&self, response: ResponseKind, hold: Hold, start: Start) -> Model<'w> {
        let Task { recording, request, .. } = self;
        let known = |key: &str| match key {
            "dead_time" => request.dead_time,
            "lag" => request.lag,
            _ => None,
        };
        Model {
            known: response.parameters().iter().map(|parameter| known(parameter.key)).collect(),
            // Without a disturbance, errors of an unstable plant would have grown beyond all bounds, and nothing would follow from its responses.
            noise: match request.noises.contains(&NoiseKind::Disturbance)
                && response.is_unstable(recording.span())
            {
                true => NoiseKind::Disturbance,
                false => NoiseKind::White,
            },
            response,
            hold,
            gain: request.gain,
            longest: self.largest,
            interval: recording.interval(),
            start,
            effort: self.effort(),
        }
    }

    /// A fit, or the name of the model whose search did not end.
    pub(crate) fn fit(
        &self,
        model: &Model<'w>,
        search: impl FnOnce(&Model<'w>) -> Option<Estimate<'w>>,
    ) -> Result<Option<Estimate<'w>>, String> {
        let found = search(model);
        match model.effort.is_exhausted() {
            true => Err(format!(
                "{} response with {} noise{} (budget of {} evaluations)",
                model.response.name(),
                model.noise.name(),
                if model.hold == Hold::Linear { " and lines between commands" } else { "" },
                self.evaluations
            )),
            false => Ok(found),
        }
    }
}
