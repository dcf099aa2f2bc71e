//! Analysis of a control loop with latency, jitter, skew and losses.

use libration::analysis::Plant;
use libration::control::{Feedback, Jitter, Latency};
use libration::number::Wide;
use libration::{AnySystem, Model, Scalar, State};
use libration_settings::units;
use serde::Serialize;

use super::modes::unless_rounding;
use super::timing::Timing;
use super::{AnalyzeError, LoopCost, LoopGrowth, Request, Stepping};

/// The analysis of a loop; the fields are keys of `analyze --json`.
#[derive(Debug, Default, Serialize)]
pub struct LoopAnalysis {
    /// The quantity of the command: `force` if the mass of the system is given, else `acceleration`.
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
    /// The spectral radius of the loop with its latency, without jitter and losses.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed_loop_spectral_radius: Option<f64>,
    /// The same minus one, without cancellation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed_loop_spectral_radius_minus_one: Option<f64>,
    /// The latencies with which the loop is stable.
    #[serde(flatten)]
    pub critical: Option<StableLatencies>,
    /// Whether the law has negative steps, which are set to zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jitter_clips: Option<bool>,
    /// The growth of the loop, or of the plant without feedback, under random steps or losses.
    #[serde(flatten)]
    pub growth: Option<LoopGrowth>,
    /// Number of steps after which the mean over an ensemble of clocks falls to 1/e, for the plant without feedback; none if it
    /// does not oscillate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dephasing_steps: Option<Option<f64>>,
    /// The cost under noise, and its increase by the timing.
    #[serde(flatten)]
    pub cost: Option<LoopCost>,
}

/// The latencies with which a loop is stable.
#[derive(Debug, Serialize)]
pub struct StableLatencies {
    /// The end of the stable interval of latencies from zero on, in steps; none without an end. Between whole steps it
    /// follows the textbook's `λᵈ`.
    pub critical_latency_steps: Option<f64>,
    /// The same if a command within a step splits it, as in a simulation; none beyond 256 steps.
    pub critical_latency_split_steps: Option<f64>,
    /// The same in s.
    pub critical_latency_seconds: Option<f64>,
    /// The intervals of stable latencies, in steps; a missing end is `null`. If an eigenvalue can pass through −1, they are
    /// runs of whole latencies up to 64 steps.
    pub latency_windows: Vec<(f64, Option<f64>)>,
    /// The delay margin of the continuous loop, in s; none if it is infinite.
    pub delay_margin_seconds: Option<f64>,
}

/// The analysis of the loop of `request`; none without timing options.
///
/// # Errors
/// If the system has more than one degree of freedom, or the latency is invalid.
pub(crate) fn answer(request: &Request) -> Result<Option<LoopAnalysis>, AnalyzeError> {
    Ok(ClosedLoop::new(request)?.map(|looped| looped.answer(request)))
}

/// The growth of the loop of `request`, without a search for its limits; none without random steps or losses.
///
/// # Errors
/// If the system has more than one degree of freedom, or the latency is too long.
pub fn loop_growth(request: &Request) -> Result<Option<LoopGrowth>, AnalyzeError> {
    Ok(ClosedLoop::new(request)?.and_then(|looped| looped.growth()))
}

/// A plant and the loop around it.
struct ClosedLoop {
    plant: Plant<'static>,
    feedback: Feedback,
    latency: Latency,
    /// The timing options for commands as accelerations.
    timing: Timing,
}

impl ClosedLoop {
    /// The loop of `request`; none without timing options.
    fn new(request: &Request) -> Result<Option<Self>, AnalyzeError> {
        let Some(flag) = request.timing.first() else { return Ok(None) };
        let latency = request.timing.latency_of(request.dt);
        let latency =
            latency.map_err(|steps| match request.timing.excessive_latency(request.dt) {
                Some(text) => AnalyzeError::ExcessiveLatency(text),
                None => AnalyzeError::Latency { steps },
            })?;
        let plant = match request.compiled() {
            Some(AnySystem::Oscillator(model)) if request.system.q.len() == 1 => {
                plant(model, request)
            }
            Some(AnySystem::DampedOscillator(model)) => plant(model, request),
            Some(AnySystem::Pendulum(model)) => plant(model, request),
            Some(AnySystem::Duffing(model)) => plant(model, request),
            _ => {
                let (system, dimension) = (request.system.name.clone(), request.system.q.len());
                return Err(AnalyzeError::Loop { flag, system, dimension });
            }
        };
        let timing = request.timing.per_mass(request.actuation().mass());
        let feedback = timing.feedback.unwrap_or_default();
        Ok(Some(ClosedLoop { plant, feedback, latency, timing }))
    }

    fn growth(&self) -> Option<LoopGrowth> {
        let ClosedLoop { plant, feedback, latency, timing } = self;
        timing.draws().then(|| LoopGrowth::of(plant, *feedback, *latency, timing))
    }

    fn critical(&self, dt: f64) -> StableLatencies {
        let ClosedLoop { plant, feedback, .. } = self;
        let windows = plant.latency_windows(*feedback);
        let steps = windows.critical();
        StableLatencies {
            critical_latency_steps: steps,
            critical_latency_split_steps: plant.split_critical_latency(*feedback),
            critical_latency_seconds: steps.map(|steps| steps * dt),
            latency_windows: windows.stable,
            delay_margin_seconds: plant.delay_margin(*feedback).map(Wide::to_f64),
        }
    }

    fn answer(&self, request: &Request) -> LoopAnalysis {
        let ClosedLoop { plant, feedback, latency, timing } = self;
        let closed = timing.feedback.is_some();
        let gains = request.compiled().map(|system| units::of(system, request.actuation()).gains);
        let radius = closed.then(|| plant.spectral_radius(*feedback, *latency));
        LoopAnalysis {
            command: closed.then(|| request.actuation().name()),
            feedback: request.timing.feedback.map(|f| [f.position, f.velocity]),
            feedback_units: gains
                .filter(|_| closed)
                .map(|[position, velocity, _]| [position, velocity]),
            latency_steps: closed.then(|| latency.steps()),
            closed_loop_spectral_radius: radius.map(Wide::to_f64),
            closed_loop_spectral_radius_minus_one: radius
                .map(|r| unless_rounding(r - Wide::one()).to_f64()),
            critical: closed.then(|| self.critical(request.dt)),
            jitter_clips: timing.jitter.map(Jitter::clips),
            growth: self.growth(),
            dephasing_steps: timing.skew.map(|law| plant.dephasing_steps(law).map(Wide::to_f64)),
            cost: closed.then(|| {
                let given = request.timing.weights;
                LoopCost::of(plant, *feedback, *latency, timing).with_given_weights(given)
            }),
        }
    }
}

/// The plant of `request` in steps of its integrator, which is not implicit.
fn plant(model: impl Model<1> + 'static, request: &Request) -> Plant<'static> {
    let at = State { q: [request.system.q[0]], v: [request.system.v[0]] };
    match request.stepping {
        Stepping::Method(method) => Plant::new(method, model, at, request.dt),
        // Implicit steps have been refused.
        Stepping::Implicit(_) | Stepping::Exact => Plant::exact(model, at, request.dt),
    }
}
