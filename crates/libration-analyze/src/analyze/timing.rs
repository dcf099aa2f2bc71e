//! What timing does to the loop that a request describes.

use libration::analysis::Plant;
use libration::control::{Feedback, Jitter, Latency, LqrWeights};
use libration::number::Wide;
use libration::{AnySystem, Model, Scalar, State};
use libration_settings::units;
use serde::Serialize;

use super::{AnalyzeError, CostAnswer, GrowthAnswer, Request, Stepping};

/// What is asked of timing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timing {
    /// The feedback that closes the loop.
    pub feedback: Option<Feedback>,
    /// How late its command arrives; at once if nothing is said.
    pub latency: Option<Late>,
    /// The law of step times.
    pub jitter: Option<Jitter>,
    /// The law of clock rates over an ensemble.
    pub skew: Option<Jitter>,
    /// The probability that a command is lost on its way.
    pub loss: Option<f64>,
    /// The weights of what the loop costs; of its energy if nothing is said.
    pub weights: Option<LqrWeights>,
}

/// A latency as it is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Late {
    /// In seconds.
    Seconds(f64),
    /// In steps.
    Steps(f64),
}

impl Timing {
    /// The first flag that is given.
    pub(crate) fn first(&self) -> Option<&'static str> {
        let given = [
            (self.feedback.is_some(), "feedback"),
            (self.latency.is_some(), "latency"),
            (self.jitter.is_some(), "jitter"),
            (self.skew.is_some(), "skew"),
            (self.loss.is_some(), "loss"),
            (self.weights.is_some(), "cost-weights"),
        ];
        given.into_iter().find_map(|(given, name)| given.then_some(name))
    }

    /// The same of commands that are accelerations, where these are forces on `mass`.
    fn per_mass(self, mass: f64) -> Self {
        Timing {
            feedback: self.feedback.map(|gains| gains.per_mass(mass)),
            weights: self.weights.map(|weights| weights.per_mass(mass)),
            ..self
        }
    }

    /// Whether steps or losses are drawn.
    pub fn draws(&self) -> bool {
        self.jitter.is_some() || self.loss.is_some()
    }

    /// How many times as long as the time step the longest step of a simulation may be.
    pub(crate) fn longest(&self) -> f64 {
        [self.jitter, self.skew].into_iter().flatten().map(|law| 1.0 + law.largest()).product()
    }

    /// The latency in steps of `dt` seconds.
    ///
    /// # Errors
    /// The number of steps, if it is negative, not finite or too large.
    pub(crate) fn latency_of(&self, dt: f64) -> Result<Latency, f64> {
        match self.latency {
            None => Ok(Latency::NONE),
            Some(Late::Steps(steps)) => Latency::of_steps(steps).ok_or(steps),
            Some(Late::Seconds(s)) => Latency::of_seconds(s, dt).ok_or(s / dt),
        }
    }
}

/// What timing does to a loop; the fields are keys of `analyze --json`.
#[derive(Debug, Default, Serialize)]
pub struct TimingAnswer {
    /// The quantity of the command: `force` where the mass of the system is given, else `acceleration`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<&'static str>,
    /// The gains `[K_p, K_d]` of the command.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feedback: Option<[f64; 2]>,
    /// Their units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feedback_units: Option<[&'static str; 2]>,
    /// The latency in steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub latency_steps: Option<f64>,
    /// The largest absolute value of an eigenvalue of the loop with its latency, its steps even and no command lost.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed_loop_spectral_radius: Option<f64>,
    /// The same minus one, without cancellation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed_loop_spectral_radius_minus_one: Option<f64>,
    /// What the feedback makes of the loop, whatever the latency.
    #[serde(flatten)]
    pub critical: Option<Critical>,
    /// Whether some steps would be negative, and are of length zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jitter_clips: Option<bool>,
    /// How the loop, or the plant without feedback, grows where something is drawn.
    #[serde(flatten)]
    pub growth: Option<GrowthAnswer>,
    /// Steps after which the mean of an ensemble of clocks has fallen to 1/e, of the plant without feedback; none where
    /// nothing turns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dephasing_steps: Option<Option<f64>>,
    /// What the loop costs under noise, and what timing adds to that.
    #[serde(flatten)]
    pub cost: Option<CostAnswer>,
}

/// At which latencies a loop is stable.
#[derive(Debug, Serialize)]
pub struct Critical {
    /// The end of the stable latencies that begin with none, in steps; none if there is none. Between whole steps it
    /// follows the textbook's `λᵈ`.
    pub critical_latency_steps: Option<f64>,
    /// The same where a command that arrives within a step splits it, as in a simulation; none beyond 256 steps.
    pub critical_latency_split_steps: Option<f64>,
    /// The same in s.
    pub critical_latency_seconds: Option<f64>,
    /// The intervals of latency, in steps, within which the loop is stable; an end that does not exist is
    /// `null`. Where an eigenvalue can pass through −1, runs of whole latencies up to 64 steps.
    pub latency_windows: Vec<(f64, Option<f64>)>,
    /// The delay margin of the continuous loop, in s; none if it has none.
    pub delay_margin_seconds: Option<f64>,
}

/// Answers what `request` asks of timing; none if it asks nothing.
///
/// # Errors
/// If the system has more than one degree of freedom, or the latency cannot be.
pub(super) fn answer(request: &Request) -> Result<Option<TimingAnswer>, AnalyzeError> {
    Ok(Looped::new(request)?.map(|looped| looped.answer(request)))
}

/// How the loop of `request` grows, without a search for its limits; none if it has no loop.
///
/// # Errors
/// If the system has more than one degree of freedom, or the latency is too long.
pub fn growth(request: &Request) -> Result<Option<GrowthAnswer>, AnalyzeError> {
    Ok(Looped::new(request)?.and_then(|looped| looped.growth()))
}

/// A plant and the loop around it.
struct Looped {
    plant: Plant<'static>,
    feedback: Feedback,
    latency: Latency,
    /// With commands that are accelerations.
    timing: Timing,
}

impl Looped {
    /// The loop of `request`; none if it asks nothing of timing.
    fn new(request: &Request) -> Result<Option<Self>, AnalyzeError> {
        let Some(flag) = request.timing.first() else { return Ok(None) };
        let latency = request.timing.latency_of(request.dt);
        let latency = latency.map_err(|steps| AnalyzeError::Latency { steps })?;
        let plant = match request.system {
            AnySystem::Oscillator(model) if request.q.len() == 1 => plant(model, request),
            AnySystem::DampedOscillator(model) => plant(model, request),
            AnySystem::Pendulum(model) => plant(model, request),
            AnySystem::Duffing(model) => plant(model, request),
            _ => {
                let (system, dimension) = (request.system.name(), request.q.len());
                return Err(AnalyzeError::Loop { flag, system, dimension });
            }
        };
        let timing = request.timing.per_mass(request.actuation.mass());
        let feedback = timing.feedback.unwrap_or_default();
        Ok(Some(Looped { plant, feedback, latency, timing }))
    }

    fn growth(&self) -> Option<GrowthAnswer> {
        let Looped { plant, feedback, latency, timing } = self;
        timing.draws().then(|| GrowthAnswer::of(plant, *feedback, *latency, timing))
    }

    fn critical(&self, dt: f64) -> Critical {
        let Looped { plant, feedback, .. } = self;
        let windows = plant.latency_windows(*feedback);
        let steps = windows.critical();
        Critical {
            critical_latency_steps: steps,
            critical_latency_split_steps: plant.split_critical_latency(*feedback),
            critical_latency_seconds: steps.map(|steps| steps * dt),
            latency_windows: windows.stable,
            delay_margin_seconds: plant.delay_margin(*feedback).map(Wide::to_f64),
        }
    }

    fn answer(&self, request: &Request) -> TimingAnswer {
        let Looped { plant, feedback, latency, timing } = self;
        let closed = timing.feedback.is_some();
        let [of_position, of_velocity, _] = units::of(request.system, request.actuation).gains;
        let radius = closed.then(|| plant.spectral_radius(*feedback, *latency));
        TimingAnswer {
            command: closed.then(|| request.actuation.name()),
            feedback: request.timing.feedback.map(|f| [f.position, f.velocity]),
            feedback_units: closed.then_some([of_position, of_velocity]),
            latency_steps: closed.then(|| latency.steps()),
            closed_loop_spectral_radius: radius.map(Wide::to_f64),
            closed_loop_spectral_radius_minus_one: radius.map(|r| (r - Wide::one()).to_f64()),
            critical: closed.then(|| self.critical(request.dt)),
            jitter_clips: timing.jitter.map(Jitter::clips),
            growth: self.growth(),
            dephasing_steps: timing.skew.map(|law| plant.dephasing_steps(law).map(Wide::to_f64)),
            cost: closed.then(|| {
                let given = request.timing.weights;
                CostAnswer::of(plant, *feedback, *latency, timing).told_with(given)
            }),
        }
    }
}

/// The plant of `request`, in its steps.
fn plant(model: impl Model<1> + 'static, request: &Request) -> Plant<'static> {
    let at = State { q: [request.q[0]], v: [request.v[0]] };
    match request.stepping {
        Stepping::Method(method) => Plant::new(method, model, at, request.dt),
        Stepping::Exact => Plant::exact(model, at, request.dt),
    }
}
