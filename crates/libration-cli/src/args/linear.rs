//! Arguments of loops around linear plants.

use std::path::{Path, PathBuf};

use clap::Args;
use libration::control::Jitter;
use libration_advise::linear::{LinearRequest, RequestFile};
use libration_advise::{Measure, Tolerance};
use libration_analyze::LatencyOption;
use libration_settings::linear_loop::{
    Channels, Coordinates, LinearControllerTable, LinearLoopTable, Rows, StateFeedbackTable,
    Weights, WeightsTable, read_plant,
};
use libration_settings::{Fault, Number};

use super::advise::seconds;
use super::timing::{finite, latency};
use super::{AdviseArgs, SystemArgs};
use crate::error::Failure;

/// Arguments of a loop around a linear plant.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct LinearArgs {
    /// File of a linear plant ẋ = Ax + Bu, y = Cx + Du: .toml, .json, .csv, .npz or .mat, with matrices a, b, c, d
    #[arg(long, value_name = "FILE", conflicts_with_all = NOT_LINEAR)]
    pub(crate) plant: Option<PathBuf>,
    /// Design a linear-quadratic regulator with these weights of the squares of states and inputs, e.g. 10,1/0.1
    #[arg(long, value_name = "STATES/INPUTS", value_parser = lqr, conflicts_with = "gain")]
    lqr: Option<WeightsTable>,
    /// Gain K of the state feedback u = −Kx, rows (inputs) separated by semicolons, e.g. "10,2;0,1"
    #[arg(long, value_name = "ROWS", value_parser = rows, allow_hyphen_values = true)]
    gain: Option<Gain>,
    /// Latency of the measurements of a linear plant: of all, or of each [default: 0]
    #[arg(long, value_name = "TIME", value_parser = latency, value_delimiter = ',', allow_hyphen_values = true)]
    output_latency: Vec<LatencyOption>,
    /// Design the controller of least cost for the stated latencies, jitter, skew and losses
    #[arg(long)]
    pub(crate) redesign: bool,
}

/// Options that are about systems of the catalogue.
const NOT_LINEAR: [&str; 10] = [
    "system",
    "force",
    "set",
    "q",
    "v",
    "start",
    "feedback",
    "cost_weights",
    "deviation",
    "horizon",
];

impl LinearArgs {
    /// Whether a controller is designed from weights of the options.
    pub(crate) fn has_weights(&self) -> bool {
        self.lqr.is_some()
    }
}

/// The value of `--gain`.
#[derive(Clone, Debug)]
pub(super) struct Gain(pub(super) Rows);

impl AdviseArgs {
    /// Returns the request for a loop around the plant of `--plant`, or around that of a file of equations.
    pub(crate) fn linear_request(&self) -> Option<Result<LinearRequest, Failure>> {
        if let Some(path) = &self.linear.plant {
            return Some(self.linear_request_of(path, "--plant"));
        }
        let flag = match &self.linear {
            LinearArgs { lqr: Some(_), .. } => "--lqr",
            LinearArgs { gain: Some(_), .. } => "--gain",
            _ => return None,
        };
        match self.system_options().and_then(SystemArgs::file) {
            Some(path) => Some(
                self.ensure_no_catalogue_options()
                    .and_then(|()| self.linear_request_of(path, "--system")),
            ),
            None => Some(Err(Failure::usage(format!(
                "{flag} is given without a plant; expected --plant FILE, or --system FILE with equations"
            )))),
        }
    }

    fn linear_request_of(&self, path: &Path, flag: &str) -> Result<LinearRequest, Failure> {
        let mut plant = read_plant(path).map_err(|why| {
            Failure::usage(format!("cannot use `{}` ({flag}): {why}", path.display()))
        })?;
        if let Some(options) = self.system_options() {
            plant.parameters = options.equation_parameters()?;
            plant.at = start_of_search(options)?.or(plant.at);
        }
        let controller = match (&self.linear.lqr, &self.linear.gain) {
            (Some(weights), _) => LinearControllerTable::Lqr(weights.clone()),
            (None, Some(Gain(gain))) => {
                LinearControllerTable::StateFeedback(StateFeedbackTable { gain: gain.clone() })
            }
            (None, None) => {
                return Err(Failure::usage(
                    "--plant is given without a controller; expected --lqr or --gain, or a file with --config",
                ));
            }
        };
        let looped = LinearLoopTable { period: self.period().map(Number), ..Default::default() };
        let mut file = RequestFile { controller: Some(controller), looped, ..Default::default() };
        file.system.linear = plant;
        self.set_timing(&mut file);
        if let Some((name, most)) = self.linear_tolerance()? {
            file.tolerance.insert(name.to_owned(), Number(most));
        }
        LinearRequest::new(file).map_err(|fault| Failure::usage(named(&fault)))
    }

    /// Fails if an option requires a linear plant, for a request that has none.
    pub(crate) fn ensure_no_linear_options(&self) -> Result<(), Failure> {
        let LinearArgs { output_latency, redesign, .. } = &self.linear;
        for (given, name) in
            [(!output_latency.is_empty(), "output-latency"), (*redesign, "redesign")]
        {
            if given {
                return Err(Failure::usage(format!(
                    "--{name} is given, but there is no loop around a linear plant; expected --plant FILE, or --system FILE with equations, and --lqr or --gain, or [system.linear] in the file of --config"
                )));
            }
        }
        Ok(())
    }

    /// The tolerance of a loop around a linear plant: none, or that of the cost.
    fn linear_tolerance(&self) -> Result<Option<(&'static str, f64)>, Failure> {
        let Tolerance { of, most } = self.tolerance.0;
        match of {
            Measure::Cost => Ok(Some((of.name(), most))),
            // The default.
            Measure::Trajectory if most == 1e-3 => Ok(None),
            of => Err(Failure::usage(format!(
                "--tolerance is {}, but a loop around a linear plant has a tolerance of the cost only, e.g. cost=0.1",
                of.name()
            ))),
        }
    }

    /// Puts the timing options in place of those of a file.
    pub(crate) fn set_timing(&self, file: &mut RequestFile) {
        let period = file.period();
        let looped = &mut file.looped;
        let channels = |latencies: &[LatencyOption]| match latencies {
            [one] => Channels::All(Number(seconds(*one, period))),
            all => Channels::Each(all.iter().map(|one| Number(seconds(*one, period))).collect()),
        };
        if !self.latency.is_empty() {
            looped.latency = channels(&self.latency);
        }
        if !self.linear.output_latency.is_empty() {
            looped.output_latency = channels(&self.linear.output_latency);
        }
        if let Some(jitter) = self.jitter {
            let law = if let Jitter::Uniform(_) = jitter { "uniform" } else { "gaussian" };
            (looped.jitter, looped.law) = (Number(jitter.rms()), law.into());
            looped.time_stamps.clear();
        }
        looped.skew = self.skew.map_or(looped.skew, Number);
        looped.loss = self.loss.map_or(looped.loss, Number);
    }
}

/// A fault with the option that causes it.
pub(super) fn named(fault: &Fault) -> String {
    let option = match &*fault.key {
        "loop.latency" => "--latency: ",
        "loop.output-latency" => "--output-latency: ",
        "loop.period" => "--period: ",
        "loop.jitter" => "--jitter: ",
        "loop.skew" => "--skew: ",
        "loop.loss" => "--loss: ",
        key if key.starts_with("controller.lqr") => "--lqr: ",
        key if key.starts_with("controller.state-feedback") => "--gain: ",
        "system.linear.at" => "--q, --start: ",
        key if key.starts_with("system") => "--plant: ",
        _ => "",
    };
    format!("{option}{fault}")
}

/// Where the search for the equilibrium of a file of equations begins; none at the start of the file.
fn start_of_search(options: &SystemArgs) -> Result<Option<Coordinates>, Failure> {
    let named = options.start.iter().map(|(name, x)| (name.clone(), Number(*x)));
    match (&options.q, options.start.is_empty()) {
        (None, true) => Ok(None),
        (None, false) => Ok(Some(Coordinates::Named(named.collect()))),
        (Some(q), true) => {
            Ok(Some(Coordinates::Each(q.values().iter().map(|&x| Number(x)).collect())))
        }
        (Some(_), false) => Err(Failure::usage(
            "--q and --start are given; expected one of them: a loop is closed at an equilibrium near it",
        )),
    }
}

fn numbers(text: &str) -> Option<Vec<Number>> {
    text.split(',').map(|number| finite(number.trim()).map(Number)).collect()
}

pub(super) fn lqr(text: &str) -> Result<WeightsTable, String> {
    let rule =
        "expected the weights of all states, a slash, and those of all inputs, e.g. 10,1/0.1";
    let (states, inputs) = text.split_once('/').ok_or(rule)?;
    let states = Weights::Diagonal(numbers(states).ok_or(rule)?);
    let states = Some(states);
    Ok(WeightsTable {
        states,
        outputs: None,
        inputs: Weights::Diagonal(numbers(inputs).ok_or(rule)?),
    })
}

pub(super) fn rows(text: &str) -> Result<Gain, String> {
    let rule =
        "expected numbers separated by commas, and rows separated by semicolons, e.g. \"10,2;0,1\"";
    let rows: Option<Rows> = text.split(';').map(numbers).collect();
    Ok(Gain(rows.ok_or(rule)?))
}
