//! Timing options of a control loop.

use clap::Args;
use libration::control::{Feedback, Jitter, LqrWeights};
use libration_analyze::{LatencyOption, Timing};
use libration_settings::duration;
use libration_settings::latency_presets::LatencyPreset;
use libration_settings::limits::{MOST_GAIN, MOST_RMS};
use libration_settings::suggestions;

/// Options of the feedback, its latency and the clock.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct TimingArgs {
    /// Gains of the feedback −KP·q − KD·v [default: no loop; in s⁻² and s⁻¹, with --set m= in N/m and N·s/m]
    #[arg(long, value_name = "KP,KD", value_parser = feedback, allow_hyphen_values = true, group = "loop")]
    pub(crate) feedback: Option<Feedback>,
    /// Latency of a command, e.g. 0.015 (in s), 15ms, 1.5steps (of --dt) or preset:NAME; at most 4096 steps [default: 0]
    #[arg(
        long,
        value_name = "TIME",
        value_parser = latency,
        requires = "timed",
        allow_hyphen_values = true
    )]
    pub(crate) latency: Option<LatencyOption>,
    /// Jitter of each step: gaussian or uniform, and its rms relative to --dt, e.g. gaussian:0.1 [default: none]
    #[arg(long, value_name = "LAW:RMS", value_parser = law, allow_hyphen_values = true)]
    pub(crate) jitter: Option<Jitter>,
    /// Skew (relative rate error) of the clocks of an ensemble: gaussian or uniform, and its rms, e.g. gaussian:0.01
    /// [default: none]
    #[arg(long, value_name = "LAW:RMS", value_parser = law, allow_hyphen_values = true)]
    pub(crate) skew: Option<Jitter>,
}

impl TimingArgs {
    /// Returns the options as a [`Timing`].
    pub(crate) fn timing(self) -> Timing {
        let TimingArgs { feedback, latency, jitter, skew } = self;
        Timing { feedback, latency, jitter, skew, ..Timing::default() }
    }
}

/// Options of the losses and the cost of a loop.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct CostArgs {
    /// Probability that a command is lost (0 to below 1); the previous command then stays active
    #[arg(
        long,
        value_name = "P",
        value_parser = loss,
        requires = "timed",
        allow_hyphen_values = true
    )]
    pub(crate) loss: Option<f64>,
    /// Weights of the mean cost QQ·q² + VV·v² + UU·u² under noise [default: the energy, ½(ω²q² + v²)]
    #[arg(
        long,
        value_name = "QQ,VV,UU",
        value_parser = weights,
        requires = "feedback",
        allow_hyphen_values = true
    )]
    pub(crate) cost_weights: Option<LqrWeights>,
}

pub(super) fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|x: &f64| x.is_finite())
}

pub(super) fn feedback(text: &str) -> Result<Feedback, String> {
    let gain = |text| finite(text).filter(|x| x.abs() <= MOST_GAIN);
    let gains = text.split_once(',').and_then(|(kp, kd)| Some((gain(kp)?, gain(kd)?)));
    let (position, velocity) =
        gains.ok_or("expected two finite numbers of at most 1e50 in size, e.g. 10,2")?;
    Ok(Feedback { position, velocity })
}

fn loss(text: &str) -> Result<f64, String> {
    let number = finite(text).filter(|x| (0.0..1.0).contains(x));
    number.ok_or_else(|| "expected a number of at least 0 and below 1".to_owned())
}

pub(super) fn weights(text: &str) -> Result<LqrWeights, String> {
    let rule = "expected three numbers from 0 to 1e50: weights of the squares of position, velocity and command, e.g. 5,0.5,0";
    let weight = |text| finite(text).filter(|x| (0.0..=MOST_GAIN).contains(x)).ok_or(rule);
    let [q, v, u]: [&str; 3] = text.split(',').collect::<Vec<_>>().try_into().map_err(|_| rule)?;
    Ok(LqrWeights { position: weight(q)?, velocity: weight(v)?, command: weight(u)? })
}

/// Parses a latency: a duration, steps, or the name of a preset.
pub(super) fn latency(text: &str) -> Result<LatencyOption, String> {
    if let Some(seconds) = LatencyPreset::parse(text)? {
        return Ok(LatencyOption::Seconds(seconds));
    }
    let latency = match text.trim().strip_suffix("steps") {
        Some(steps) => finite(steps).map(LatencyOption::Steps),
        None => duration::seconds(text).map(LatencyOption::Seconds),
    };
    let allowed = |latency: &LatencyOption| match *latency {
        LatencyOption::Seconds(x) | LatencyOption::Steps(x) => x.is_finite() && x >= 0.0,
    };
    latency.filter(allowed).ok_or_else(|| {
        "expected a finite number of at least 0, e.g. 0.015 (in s), 15ms or 1.5steps, or preset:NAME of `libration list --presets`".to_owned()
    })
}

pub(super) fn law(text: &str) -> Result<Jitter, String> {
    let rule = "expected gaussian or uniform, and an rms from 0 to 100, e.g. gaussian:0.1";
    let (name, rms) = text.split_once(':').ok_or(rule)?;
    let rms = finite(rms).filter(|x| (0.0..=MOST_RMS).contains(x)).ok_or(rule)?;
    match name {
        "gaussian" => Ok(Jitter::Gaussian(rms)),
        "uniform" => Ok(Jitter::Uniform(rms)),
        other => Err(match suggestions::law_meant(other) {
            Some(meant) => format!("{rule}; did you mean {meant}:{rms}?"),
            None => rule.to_owned(),
        }),
    }
}
