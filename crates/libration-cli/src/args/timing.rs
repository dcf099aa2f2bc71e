//! What is asked of the timing of a loop.

use clap::Args;
use libration::control::{Feedback, Jitter, LqrWeights};
use libration_analyze::analyze::{Late, Timing};
use libration_settings::limits::{MOST_GAIN, MOST_RMS};

/// The loop, and what happens to its clock and its commands.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct TimingArgs {
    /// Close the loop with the command −KP·q − KD·v: a force where --set m= is given (gains in N/m and N·s/m), else an
    /// acceleration (gains in s⁻² and s⁻¹)
    #[arg(long, value_name = "KP,KD", value_parser = feedback, allow_hyphen_values = true)]
    pub(crate) feedback: Option<Feedback>,
    /// How late the command arrives, as 0.015 (in s) or 1.5steps; up to 4096 steps. A latency scales with the loop's own steps: in
    /// s it is that of a loop whose steps are all --dt long
    #[arg(
        long,
        value_name = "TIME",
        value_parser = latency,
        requires = "feedback",
        allow_hyphen_values = true
    )]
    pub(crate) latency: Option<Late>,
    /// The law of step times, each drawn by itself, with its relative rms: gaussian:0.1 or uniform:0.1; where a
    /// step would be negative, it is of length zero
    #[arg(long, value_name = "LAW:RMS", value_parser = law, allow_hyphen_values = true)]
    pub(crate) jitter: Option<Jitter>,
    /// The law of clock rates over an ensemble, with its relative rms: gaussian:0.01 or uniform:0.01
    #[arg(long, value_name = "LAW:RMS", value_parser = law, allow_hyphen_values = true)]
    pub(crate) skew: Option<Jitter>,
}

impl TimingArgs {
    /// As the laboratory takes it.
    pub(crate) fn timing(self) -> Timing {
        let TimingArgs { feedback, latency, jitter, skew } = self;
        Timing { feedback, latency, jitter, skew, ..Timing::default() }
    }
}

/// What else is asked of a loop that is not simulated.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct CostArgs {
    /// The probability that a command is lost on its way, each for itself: the last one goes on then; at least 0 and below 1
    #[arg(
        long,
        value_name = "P",
        value_parser = loss,
        requires = "feedback",
        allow_hyphen_values = true
    )]
    pub(crate) loss: Option<f64>,
    /// What the loop costs under noise: the mean of QQ·q² + VV·v² + UU·u². If nothing is said that of its energy,
    /// ½(ω²q² + v²)
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
        gains.ok_or("it must be two finite numbers, of at most 1e50 in size, as 10,2")?;
    Ok(Feedback { position, velocity })
}

fn loss(text: &str) -> Result<f64, String> {
    let number = finite(text).filter(|x| (0.0..1.0).contains(x));
    number.ok_or_else(|| "it must be a number that is at least 0 and below 1".to_owned())
}

pub(super) fn weights(text: &str) -> Result<LqrWeights, String> {
    let rule = "it must be three numbers from 0 to 1e50, of the squares of position, velocity and command, as 5,0.5,0";
    let weight = |text| finite(text).filter(|x| (0.0..=MOST_GAIN).contains(x)).ok_or(rule);
    let [q, v, u]: [&str; 3] = text.split(',').collect::<Vec<_>>().try_into().map_err(|_| rule)?;
    Ok(LqrWeights { position: weight(q)?, velocity: weight(v)?, command: weight(u)? })
}

pub(super) fn latency(text: &str) -> Result<Late, String> {
    let (number, make): (&str, fn(f64) -> Late) = match text.trim().strip_suffix("steps") {
        Some(steps) => (steps, Late::Steps),
        None => (text, Late::Seconds),
    };
    let number = finite(number).filter(|&x| x >= 0.0);
    number.map(make).ok_or_else(|| {
        "it must be a finite number of at least 0, as 0.015 (in s) or 1.5steps".to_owned()
    })
}

pub(super) fn law(text: &str) -> Result<Jitter, String> {
    let rule = "it must be one of the laws gaussian and uniform, and an rms from 0 to 100, as gaussian:0.1";
    let (name, rms) = text.split_once(':').ok_or(rule)?;
    let rms = finite(rms).filter(|x| (0.0..=MOST_RMS).contains(x)).ok_or(rule)?;
    match name {
        "gaussian" => Ok(Jitter::Gaussian(rms)),
        "uniform" => Ok(Jitter::Uniform(rms)),
        _ => Err(rule.to_owned()),
    }
}
