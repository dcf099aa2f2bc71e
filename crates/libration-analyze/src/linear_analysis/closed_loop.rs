//! A loop around a linear plant as results.

use core::f64::consts::{PI, TAU};

use libration::linear::{GROWTH_ROUNDING, LoopStability, LoopTiming, StabilityOutcome};
use libration_report::notation::number;
use libration_report::verdict::{Outcome, Verdict};
use libration_work::Work;
use serde::Serialize;

use super::{LinearAnalysisError, LinearRequest, SystemMotion};

/// A loop around a linear plant.
#[derive(Clone, Debug, Serialize)]
pub struct ClosedLoop {
    /// The period of the controller in s.
    pub period: f64,
    /// The length of a period in s with the skew.
    pub mean_period: f64,
    /// Number of states of plant and controller, and of commands and measurements in transit.
    pub size: usize,
    /// The factor by which the loop grows in a period of mean length without losses: the spectral radius of its matrix. Of a cascade
    /// the mean over its periods.
    pub spectral_radius: f64,
    /// The logarithm of the factor by which second moments grow in a period with jitter and losses.
    pub mean_square_growth: f64,
    /// Whether second moments decay for certain.
    pub stable: bool,
    /// Whether the loop is stable.
    pub verdict: Verdict,
    /// The motion of the nonlinear system under the loop; none where it was not simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<SystemMotion>,
    /// The modes, the one that grows fastest first; of a pair one. They belong to periods of mean length without losses.
    pub modes: Vec<LoopMode>,
    /// Number of modes that vanish within a period, which `modes` leaves out.
    pub vanishing_modes: usize,
    /// The stationary cost per second under the noise of the plant and its measurements; none if second moments grow.
    pub cost: Option<f64>,
    /// The standard deviation of each state at the beginning of a period; empty if second moments grow.
    pub deviations: Vec<StateDeviation>,
}

/// A mode of a loop.
#[derive(Clone, Debug, Serialize)]
pub struct LoopMode {
    /// The eigenvalue `[re, im]` of one period; of a pair the upper one.
    pub eigenvalue: [f64; 2],
    /// The factor by which the mode grows in a period.
    pub growth: f64,
    /// The growth rate in 1/s.
    pub growth_rate: f64,
    /// The frequency of its oscillation in Hz; 0 without oscillation.
    pub frequency: f64,
    /// The natural frequency `|ln μ|/T` of an eigenvalue `μ` of a period `T`, in rad/s.
    pub natural_frequency: f64,
    /// The damping ratio `−Re ln μ/|ln μ|`; none of `μ = 1`.
    pub damping_ratio: Option<f64>,
    /// The time in s in which it decays to 1/e; none if it does not decay.
    pub time_constant: Option<f64>,
    /// The states that move most, with their sizes relative to the largest.
    pub states: Vec<(String, f64)>,
}

/// The standard deviation of a state.
#[derive(Clone, Debug, Serialize)]
pub struct StateDeviation {
    /// The state.
    pub state: String,
    /// Its unit.
    pub unit: String,
    /// The standard deviation.
    pub deviation: f64,
}

/// Growth per period below which a mode counts as vanished: commands in transit have the eigenvalue zero several times, which rounding
/// parts by roots.
const VANISHED: f64 = 1e-3;

/// The part of a verdict that no linearisation shows.
pub const NOT_SIMULATED: &str = "the motion of the nonlinear system";

impl ClosedLoop {
    pub(super) fn new(
        request: &LinearRequest,
        timing: &LoopTiming,
        work: &Work<'_>,
    ) -> Result<Self, LinearAnalysisError> {
        let linear = &request.linear;
        let period = linear.period();
        let mean_period = period * (1.0 + timing.skew);
        let all = linear.modes(timing, usize::MAX)?;
        let spectral_radius = all.first().map_or(0.0, |mode| mode.radius);
        let count = all.len();
        let modes: Vec<LoopMode> = all
            .into_iter()
            .filter(|mode| mode.radius >= VANISHED)
            .map(|mode| {
                let (growth, angle) = (mode.radius.ln() / mean_period, mode.angle / mean_period);
                let size = growth.hypot(angle);
                let (sine, cosine) = match mode.angle {
                    PI => (0.0, -1.0),
                    angle => angle.sin_cos(),
                };
                LoopMode {
                    eigenvalue: [mode.radius * cosine, mode.radius * sine],
                    growth: mode.radius,
                    growth_rate: growth,
                    frequency: angle / TAU,
                    natural_frequency: size,
                    damping_ratio: (size > 0.0).then(|| 0.0 - growth / size),
                    time_constant: (growth < 0.0).then(|| -growth.recip()),
                    states: mode.states,
                }
            })
            .collect();
        let stability = linear.stability(timing)?;
        let mean_square_growth = stability.growth;
        let motion = match &request.system {
            Some(system) if stability.is_stable() => {
                system.motion(linear, timing, mean_square_growth, work)?
            }
            _ => None,
        };
        let mut verdict = loop_verdict(&stability);
        if let Some(motion) = &motion {
            verdict = motion.judged(verdict);
        } else if request.is_linearised && verdict.is_good() {
            verdict = verdict.without(NOT_SIMULATED);
        }
        let stationary = linear.stationary(timing)?;
        let deviations = stationary.as_ref().map(|own| own.deviations.as_slice());
        let signals = linear.plant().states.iter();
        let deviations = signals.zip(deviations.unwrap_or_default()).map(|(signal, &deviation)| {
            let (state, unit) = (signal.name.clone(), signal.unit.clone());
            StateDeviation { state, unit, deviation }
        });
        Ok(ClosedLoop {
            period,
            mean_period,
            size: linear.size(timing)?,
            spectral_radius,
            mean_square_growth,
            stable: stability.is_stable(),
            verdict,
            motion,
            vanishing_modes: count - modes.len(),
            modes,
            deviations: deviations.collect(),
            cost: stationary.map(|own| own.cost),
        })
    }
}

/// The verdict on a loop of this stability, for all commands.
pub fn loop_verdict(stability: &LoopStability) -> Verdict {
    if let Some(plant) = stability.hidden_by {
        return Verdict::unknown(hidden_loop(plant));
    }
    let percent = 100.0 * stability.growth.exp_m1().abs();
    let (outcome, verb) = match stability.outcome {
        StabilityOutcome::Stable => (Outcome::Stable, "fall"),
        StabilityOutcome::Unstable => (Outcome::Unstable, "grow"),
        StabilityOutcome::Undecided => (Outcome::Unknown, "change"),
    };
    let change = match stability.is_near_neutral() {
        true => format!(
            "second moments {verb} by less than {} % per period",
            number(100.0 * GROWTH_ROUNDING, 2)
        ),
        false => format!("second moments {verb} by {} % per period", number(percent, 4)),
    };
    Verdict::new(
        outcome,
        match (stability.outcome, stability.is_near_neutral()) {
            (StabilityOutcome::Undecided, _) => format!("{change}, which may be rounding"),
            (_, true) => format!("{change}: by the equations of rest"),
            (_, false) => change,
        },
    )
}

/// Why the stability of a loop is unknown whose plant alone grows by a factor in a period.
pub fn hidden_loop(plant: f64) -> String {
    format!(
        "the plant alone grows by the factor {plant:.3e} in a period, of which commands leave less than the rounding of f64"
    )
}
