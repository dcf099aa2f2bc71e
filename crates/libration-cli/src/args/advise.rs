//! What `advise` takes.

use std::path::PathBuf;

use clap::Args;
use libration::catalog;
use libration::control::{Feedback, Jitter, LqrWeights};
use libration_advise::{Control, Law, Measure, Request, Tolerance};
use libration_analyze::analyze::Late;
use libration_settings::setting::Setting;

use super::SystemArgs;
use super::timing::{feedback, finite, latency, law, weights};
use crate::error::Failure;

/// What `advise` takes.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, override_usage = USAGE, args_override_self = true)]
pub(crate) struct AdviseArgs {
    /// File of what is asked; it has more than the flags, such as controllers that remember
    #[arg(long, value_name = "FILE", conflicts_with_all = ASKED)]
    pub(crate) config: Option<PathBuf>,
    #[command(flatten)]
    system: Option<SystemArgs>,
    /// Close the loop with the command −KP·q − KD·v: a force where --set m= is given (gains in N/m and N·s/m), else an
    /// acceleration (gains in s⁻² and s⁻¹);
    /// without it the system is simulated as it is
    #[arg(long, value_name = "KP,KD", value_parser = feedback, allow_hyphen_values = true)]
    feedback: Option<Feedback>,
    /// Between two samples of the loop, in s
    #[arg(
        long,
        value_name = "SECONDS",
        value_parser = number,
        default_value = "0.01",
        allow_hyphen_values = true
    )]
    period: f64,
    /// How late a command arrives, as 0.015 (in s) or 1.5steps, of --period
    #[arg(
        long,
        value_name = "TIME",
        value_parser = latency,
        allow_hyphen_values = true
    )]
    latency: Option<Late>,
    /// The law of sample times with its relative rms up to 1, as gaussian:0.05 or uniform:0.05
    #[arg(
        long,
        value_name = "LAW:RMS",
        value_parser = law,
        allow_hyphen_values = true
    )]
    jitter: Option<Jitter>,
    /// Time stamps that were measured, in place of --jitter: what `measure-jitter --output` writes, or a log
    #[arg(long, value_name = "FILE", conflicts_with_all = ["jitter", "skew"])]
    pub(crate) jitter_file: Option<PathBuf>,
    /// The part by which the clock is slow, as 1e-4; negative where it is fast
    #[arg(
        long,
        value_name = "PART",
        value_parser = number,
        allow_hyphen_values = true
    )]
    skew: Option<f64>,
    /// The probability that a command is lost
    #[arg(
        long,
        value_name = "P",
        value_parser = number,
        allow_hyphen_values = true
    )]
    loss: Option<f64>,
    /// What the loop costs under noise: the mean of QQ·q² + VV·v² + UU·u². If nothing is said that of its energy, ½(ω²q² + v²)
    #[arg(
        long,
        value_name = "QQ,VV,UU",
        value_parser = weights,
        requires = "feedback",
        allow_hyphen_values = true
    )]
    cost_weights: Option<LqrWeights>,
    /// From so far off the operating point --q the loop must return, in m or rad
    #[arg(
        long,
        value_name = "FAR",
        value_parser = number,
        requires = "feedback",
        default_value = "0.1",
        allow_hyphen_values = true
    )]
    deviation: f64,
    /// What is tolerated, of energy, phase, trajectory or cost
    #[arg(
        long,
        value_name = "OF=MOST",
        value_parser = tolerance,
        default_value = "trajectory=1e-3",
        allow_hyphen_values = true
    )]
    tolerance: ToleranceArg,
    /// For how long, in s
    #[arg(
        long,
        value_name = "SECONDS",
        value_parser = number,
        default_value = "10",
        allow_hyphen_values = true
    )]
    horizon: f64,
    /// File for a page with all of it and a map of stability, as HTML
    #[arg(long, value_name = "FILE")]
    pub(crate) page: Option<PathBuf>,
    /// Print JSON, with all digits
    #[arg(long)]
    pub(crate) json: bool,
    /// Print a file of what can be asked, with comments, and stop
    #[arg(long, conflicts_with_all = ["config", "page", "json", "jitter_file"], conflicts_with_all = ASKED)]
    pub(crate) print_config: bool,
}

/// The flags that a file takes the place of.
const ASKED: [&str; 10] = [
    "system",
    "set",
    "q",
    "v",
    "feedback",
    "period",
    "cost_weights",
    "deviation",
    "tolerance",
    "horizon",
];

const USAGE: &str = "\
libration advise --system <NAME> [OPTIONS]
       libration advise --config <FILE> [OPTIONS]
       libration advise --print-config";

const EXAMPLES: &str = "\
Examples:
  libration advise --system oscillator --set omega2=10 --feedback 10,2 --period 0.01 --latency 0.02 \
                   --jitter gaussian:0.05 --loss 0.01
  libration advise --system kepler --tolerance energy=1e-6 --horizon 100
  libration advise --print-config > mine.toml
  libration advise --config mine.toml --jitter-file robot.csv --page budget.html

Limits are those of the loop in exact steps of its period, linearised at --q; what acts together is simulated as well.
Exit code 1 if the loop does not stand what is stated, costs more than is tolerated, or no integrator is
accurate enough.";

/// What is tolerated.
#[derive(Clone, Copy, Debug)]
struct ToleranceArg(Tolerance);

impl AdviseArgs {
    /// What is asked by flags.
    pub(crate) fn request(&self) -> Result<Request, Failure> {
        let Some(system) = &self.system else {
            return Err(Failure::usage(
                "nothing is asked: it must be --config FILE, or --system NAME with what else is to be said of it",
            ));
        };
        let Setting { system, actuation, q, mut v } = {
            let mut given = system.clone();
            one_degree_of_freedom(&given.system, self.feedback)?;
            // A loop is held where it is: at the origin, if nothing is said.
            if self.feedback.is_some() && given.q.is_none() {
                given.q = Some(super::number::Coordinates::origin());
            }
            given.resolve()?
        };
        if self.feedback.is_some() && self.system.as_ref().is_some_and(|given| given.v.is_none()) {
            v = vec![0.0; q.len()];
        }
        let control = self.feedback.map(|gains| Control {
            law: Law::Pd(gains),
            period: self.period,
            latency: 0.0,
            jitter: Jitter::Gaussian(0.0),
            skew: 0.0,
            loss: 0.0,
            record: None,
            weights: self.cost_weights,
            deviation: self.deviation,
        });
        self.instead(Request {
            system,
            actuation,
            q,
            v,
            control,
            tolerance: self.tolerance.0,
            horizon: self.horizon,
            rollout: [4096, 1024],
            map: false,
            asked_by: String::new(),
        })
    }

    /// What is asked, with that in place of it which flags say is wrong with the loop.
    pub(crate) fn instead(&self, mut request: Request) -> Result<Request, Failure> {
        let Some(control) = &mut request.control else {
            let given = [
                (self.latency.is_some(), "latency"),
                (self.jitter.is_some(), "jitter"),
                (self.skew.is_some(), "skew"),
                (self.loss.is_some(), "loss"),
            ];
            return match given.into_iter().find(|(given, _)| *given) {
                Some((_, flag)) => Err(Failure::usage(format!(
                    "--{flag} is given, but there is no loop: it needs --feedback, or a controller in the file"
                ))),
                None => Ok(request),
            };
        };
        control.latency = match self.latency {
            Some(Late::Seconds(seconds)) => seconds,
            Some(Late::Steps(steps)) => steps * control.period,
            None => control.latency,
        };
        match (self.jitter, &control.record) {
            (Some(jitter), Some(_)) => {
                (control.jitter, control.record, control.skew) = (jitter, None, 0.0);
            }
            (Some(jitter), None) => control.jitter = jitter,
            (None, Some(_)) if self.skew.is_some() => {
                return Err(Failure::usage(
                    "--skew is given, but the time stamps of the file say how far the clock is off",
                ));
            }
            (None, _) => {}
        }
        control.skew = self.skew.unwrap_or(control.skew);
        control.loss = self.loss.unwrap_or(control.loss);
        Ok(request)
    }
}

/// Fails where a loop is to be closed around a system with several degrees of freedom.
fn one_degree_of_freedom(system: &str, feedback: Option<Feedback>) -> Result<(), Failure> {
    match catalog::find(system) {
        Ok(entry) if feedback.is_some() && !entry.dimensions.contains(&1) => {
            let fewest = entry.dimensions.start();
            Err(Failure::usage(format!(
                "--feedback closes a loop around one degree of freedom, but --system {system} has {fewest}"
            )))
        }
        _ => Ok(()),
    }
}

fn number(text: &str) -> Result<f64, String> {
    finite(text).ok_or_else(|| "it must be a finite number".to_owned())
}

fn tolerance(text: &str) -> Result<ToleranceArg, String> {
    let rule =
        "it must be one of energy, phase, trajectory and cost, and how much of it, as energy=1e-6";
    let (name, most) = text.split_once('=').ok_or(rule)?;
    let of = Measure::ALL.into_iter().find(|measure| measure.name() == name.trim()).ok_or(rule)?;
    let most = finite(most).filter(|most| *most > 0.0).ok_or(rule)?;
    Ok(ToleranceArg(Tolerance { of, most }))
}
