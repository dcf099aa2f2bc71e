//! What timing does to the loop that a request describes.

use libration::analysis::{CostError, Feedback, Imperfections, Jitter, Latency, LqrWeights, Plant};
use libration::number::Wide;
use libration::{AnySystem, Model, Scalar, State};
use serde::Serialize;

use super::{AnalyzeError, Request, Stepping};

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
    /// The gains `[K_p, K_d]` in s⁻² and s⁻¹.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feedback: Option<[f64; 2]>,
    /// The latency in steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub latency_steps: Option<f64>,
    /// What the feedback makes of the loop, whatever the latency.
    #[serde(flatten)]
    pub critical: Option<Critical>,
    /// Whether some steps would be negative, and are of length zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jitter_clips: Option<bool>,
    /// `ρ(E[M ⊗ M])`: the factor by which second moments grow in a step; none where steps turn by more than 2048 rad in a
    /// deviation, or with a latency of more than 90 steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_square_radius: Option<Option<f64>>,
    /// The same minus one, without cancellation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_square_growth: Option<Option<f64>>,
    /// The top Lyapunov exponent in a step; none with a latency, where the mean step does not turn, and where steps turn by more
    /// than 2048 rad in a deviation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lyapunov_exponent: Option<Option<f64>>,
    /// Steps after which the mean of an ensemble of clocks has fallen to 1/e; none where nothing turns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dephasing_steps: Option<Option<f64>>,
    /// What the loop costs under noise, and what timing adds to that.
    #[serde(flatten)]
    pub cost: Option<CostAnswer>,
    /// The spectral radius of the loop with its latency.
    #[serde(skip)]
    pub(super) radius: Option<Wide>,
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

/// The stationary cost of a loop under white noise of the acceleration of unit intensity.
#[derive(Debug, Serialize)]
pub struct CostAnswer {
    /// The weights `[q, v, u]` of the squares of which the cost is the mean.
    pub cost_weights: [f64; 3],
    /// The cost with all that is asked: latency, jitter, skew (half the clocks slow by its rms, half fast) and loss; none where
    /// it is infinite, or not known.
    pub cost: Option<f64>,
    /// Whether it is infinite: the loop is not stable in the mean square. Unknown where the loop is too large.
    pub cost_infinite: Option<bool>,
    /// `J/J₀ − 1`, with the cost `J₀` of the same loop with nothing of that; none where one of them is none.
    pub cost_increase: Option<f64>,
}

impl CostAnswer {
    fn of(plant: &Plant<'_>, feedback: Feedback, latency: Latency, timing: &Timing) -> Self {
        let weights = timing.weights.unwrap_or_else(|| plant.energy());
        let cost = |imperfections: &Imperfections| -> Result<f64, CostError> {
            plant.cost(&feedback.into(), imperfections, weights)
        };
        let none = Imperfections::NONE;
        let jitter = timing.jitter.unwrap_or(none.jitter);
        let loss = timing.loss.unwrap_or(0.0);
        let with = |skew| cost(&Imperfections { latency, jitter, skew, loss });
        let all = match timing.skew.map(Jitter::rms).filter(|&rms| rms > 0.0) {
            Some(rms) => with(rms).and_then(|slow| Ok(0.5 * (slow + with(-rms)?))),
            None => with(0.0),
        };
        let all = all.ok();
        let finite = |cost: Option<f64>| cost.filter(|cost| cost.is_finite());
        let increase = finite(all).zip(finite(cost(&none).ok()));
        CostAnswer {
            cost_weights: [weights.position, weights.velocity, weights.command],
            cost: finite(all),
            cost_infinite: all.map(f64::is_infinite),
            cost_increase: increase.map(|(all, ideal)| all / ideal - 1.0),
        }
    }
}

/// Answers what `request` asks of timing; none if it asks nothing.
///
/// # Errors
/// If the system has more than one degree of freedom, or the latency cannot be.
pub(super) fn answer(request: &Request) -> Result<Option<TimingAnswer>, AnalyzeError> {
    let Some(flag) = request.timing.first() else { return Ok(None) };
    let latency = request.timing.latency_of(request.dt);
    let latency = latency.map_err(|steps| AnalyzeError::Latency { steps })?;
    let answer = match request.system {
        AnySystem::Oscillator(model) if request.q.len() == 1 => of_model(model, latency, request),
        AnySystem::DampedOscillator(model) => of_model(model, latency, request),
        AnySystem::Pendulum(model) => of_model(model, latency, request),
        AnySystem::Duffing(model) => of_model(model, latency, request),
        _ => {
            let (system, dimension) = (request.system.name(), request.q.len());
            return Err(AnalyzeError::Loop { flag, system, dimension });
        }
    };
    Ok(Some(answer))
}

fn of_model(model: impl Model<1>, latency: Latency, request: &Request) -> TimingAnswer {
    let timing = &request.timing;
    let at = State { q: [request.q[0]], v: [request.v[0]] };
    let plant = match request.stepping {
        Stepping::Method(method) => Plant::new(method, model, at, request.dt),
        Stepping::Exact => Plant::exact(model, at, request.dt),
    };
    let feedback = timing.feedback.unwrap_or_default();
    let finite = |[radius, growth]: [f64; 2]| radius.is_finite().then_some([radius, growth]);
    let mean_square = timing.jitter.map(|law| {
        if latency == Latency::NONE {
            let radius = plant.mean_square(feedback, law).radius;
            finite([radius, radius - Wide::one()].map(Wide::to_f64))
        } else {
            let drawn = Imperfections { latency, jitter: law, ..Imperfections::NONE };
            let rate = plant.mean_square_growth(&feedback.into(), &drawn).ok()?;
            finite([rate.exp(), rate.exp_m1()])
        }
    });
    let exponent = |law: Jitter| {
        let found = (latency == Latency::NONE).then(|| plant.lyapunov_exponent(feedback, law));
        found.flatten().filter(|exponent| exponent.is_finite())
    };
    let critical = || {
        let windows = plant.latency_windows(feedback);
        let steps = windows.critical();
        Critical {
            critical_latency_steps: steps,
            critical_latency_split_steps: plant.split_critical_latency(feedback),
            critical_latency_seconds: steps.map(|steps| steps * request.dt),
            latency_windows: windows.stable,
            delay_margin_seconds: plant.delay_margin(feedback).map(Wide::to_f64),
        }
    };
    TimingAnswer {
        feedback: timing.feedback.map(|f| [f.position, f.velocity]),
        latency_steps: timing.feedback.map(|_| latency.steps()),
        critical: timing.feedback.map(|_| critical()),
        jitter_clips: timing.jitter.map(Jitter::clips),
        mean_square_radius: mean_square.map(|found| found.map(|[radius, _]| radius)),
        mean_square_growth: mean_square.map(|found| found.map(|[_, growth]| growth)),
        lyapunov_exponent: timing.jitter.map(exponent),
        dephasing_steps: timing.skew.map(|law| plant.dephasing_steps(law).map(Wide::to_f64)),
        cost: timing.feedback.map(|_| CostAnswer::of(&plant, feedback, latency, timing)),
        radius: timing.feedback.map(|_| plant.spectral_radius(feedback, latency)),
    }
}
