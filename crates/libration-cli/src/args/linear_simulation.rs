//! Arguments of simulations of linear plants and loops around them.

use std::path::{Path, PathBuf};

use clap::Args;
use libration::control::Jitter;
use libration::linear::{DiscreteController, Signal};
use libration_advise::linear::{LinearRequest, RequestFile};
use libration_analyze::LatencyOption;
use libration_analyze::linear_trajectory;
use libration_analyze::trajectory::EnsembleOptions;
use libration_settings::linear_loop::{
    Channels, LinearControllerTable, LinearLoopTable, StateFeedbackTable, WeightsTable, read_plant,
};
use libration_settings::{Number, suggestions};

use super::advise::seconds;
use super::linear::{Gain, lqr, named, rows};
use super::number::{Coordinates, assignment, coordinates, period};
use super::timing::{finite, latency};
use super::{SimulateArgs, SystemArgs, simd};
use crate::error::Failure;

/// Arguments of a linear plant and the loop around it.
#[derive(Args, Clone, Debug)]
pub(crate) struct LinearSimulationArgs {
    /// File of a linear plant ẋ = Ax + Bu, y = Cx + Du: .toml, .json, .csv, .npz or .mat; without --lqr or --gain in open loop
    #[arg(long, value_name = "FILE", group = "loop", conflicts_with_all = NOT_LINEAR)]
    plant: Option<PathBuf>,
    /// File of a loop around a linear plant, as for `advise --config`; without a controller in open loop
    #[arg(long, value_name = "FILE", group = "loop", conflicts_with_all = NOT_LINEAR)]
    pub(crate) config: Option<PathBuf>,
    /// Design a linear-quadratic regulator with these weights of the squares of states and inputs, e.g. 10,1/0.1
    #[arg(long, value_name = "STATES/INPUTS", value_parser = lqr, conflicts_with = "gain")]
    lqr: Option<WeightsTable>,
    /// Gain K of the state feedback u = −Kx, rows (inputs) separated by semicolons, e.g. "10,2;0,1"
    #[arg(long, value_name = "ROWS", value_parser = rows, allow_hyphen_values = true)]
    gain: Option<Gain>,
    /// Period of the loop in s, also as 2ms or 500Hz [default: 0.01]
    #[arg(long, value_name = "SECONDS", value_parser = period, allow_hyphen_values = true)]
    period: Option<f64>,
    /// Latency of the measurements of a linear plant: of all, or of each [default: 0]
    #[arg(long, value_name = "TIME", value_parser = latency, value_delimiter = ',', allow_hyphen_values = true)]
    output_latency: Vec<LatencyOption>,
    /// Probability that the commands that arrive in a period are lost (0 to below 1), in a loop around a linear plant
    #[arg(long, value_name = "P", value_parser = number, allow_hyphen_values = true)]
    loss: Option<f64>,
    /// Initial states of a linear plant, separated by commas [default: zeros]
    #[arg(long, value_name = "X,…", value_parser = coordinates, requires = LINEAR, conflicts_with = "system", allow_hyphen_values = true)]
    x0: Option<Coordinates>,
    /// Value that the controller subtracts from a measurement, by the name of the output; repeatable
    #[arg(long, value_name = "OUTPUT=VALUE", value_parser = assignment, allow_hyphen_values = true)]
    reference: Vec<(String, f64)>,
    /// Constant that is added to the command of an input, by its name; in open loop the step of that input; repeatable
    #[arg(long, value_name = "INPUT=VALUE", value_parser = assignment, allow_hyphen_values = true)]
    disturbance: Vec<(String, f64)>,
    /// Add the noise of the plant (its `g`, by default white noise of unit intensity at the inputs) and of the measurements
    #[arg(long, requires = LINEAR, conflicts_with = "system")]
    noise: bool,
}

/// The group of the options that give a loop.
const LINEAR: &str = "loop";

/// Options that are about systems of the catalogue.
const NOT_LINEAR: [&str; 11] = [
    "system",
    "force",
    "set",
    "q",
    "v",
    "start",
    "integrator",
    "dt",
    "dtype",
    "skew",
    "time_stamps",
];

impl SimulateArgs {
    /// Returns the request for a linear plant, if there is one.
    pub(crate) fn linear_request(
        &self,
        read: impl FnOnce(&Path, &dyn Fn(&mut RequestFile)) -> Result<LinearRequest, Failure>,
    ) -> Option<Result<linear_trajectory::LinearRequest, Failure>> {
        let change = |file: &mut RequestFile| self.change(file);
        let request = match (&self.linear.plant, &self.linear.config) {
            (Some(path), _) => self.of_plant(path),
            (None, Some(path)) => read(path, &change),
            (None, None) if self.looped_file().is_some() => return None,
            (None, None) => return self.ensure_no_loop().err().map(Err),
        };
        Some(request.and_then(|request| self.trajectory(&request)))
    }

    /// The loop around the plant of a file.
    fn of_plant(&self, path: &Path) -> Result<LinearRequest, Failure> {
        let LinearSimulationArgs { lqr, gain, period, .. } = &self.linear;
        let controller = controller_table(lqr.as_ref(), gain.as_ref());
        loop_of_plant((path, "--plant"), controller, *period, |file| self.change(file))
    }

    /// The file of equations of `--system` around which `--lqr` or `--gain` closes a loop.
    pub(crate) fn looped_file(&self) -> Option<&Path> {
        let is_closed = self.linear.lqr.is_some() || self.linear.gain.is_some();
        self.system.as_ref().and_then(SystemArgs::file).filter(|_| is_closed)
    }

    /// The loop around the linearisation of a file of equations with the parameters of these options, and the request for the plant.
    pub(crate) fn loop_around(
        &self,
        path: &Path,
        options: &SystemArgs,
    ) -> Result<(LinearRequest, linear_trajectory::LinearRequest), Failure> {
        let LinearSimulationArgs { lqr, gain, period, .. } = &self.linear;
        let controller = controller_table(lqr.as_ref(), gain.as_ref());
        let parameters = options.equation_parameters()?;
        let request = loop_of_plant((path, "--system"), controller, *period, |file| {
            file.system.linear.parameters = parameters;
            self.change(file);
        })?;
        let trajectory = self.trajectory(&request)?;
        Ok((request, trajectory))
    }

    /// Fails if an option is about a loop, and there is none.
    fn ensure_no_loop(&self) -> Result<(), Failure> {
        let own = &self.linear;
        let given = [
            ("lqr", own.lqr.is_some()),
            ("gain", own.gain.is_some()),
            ("period", own.period.is_some()),
            ("output-latency", !own.output_latency.is_empty()),
            ("loss", own.loss.is_some()),
            ("reference", !own.reference.is_empty()),
            ("disturbance", !own.disturbance.is_empty()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((name, _)) => Err(Failure::usage(format!(
                "--{name} is given, but there is no loop around a plant; expected --plant FILE, --config FILE, or --system FILE with equations and --lqr or --gain"
            ))),
            None => Ok(()),
        }
    }

    /// Puts the options in place of what a file states.
    fn change(&self, file: &mut RequestFile) {
        let timing = TimingOptions {
            latency: self.timing.latency,
            output_latency: &self.linear.output_latency,
            jitter: self.timing.jitter,
            loss: self.linear.loss,
        };
        timing.set(file);
    }

    /// Fails if an option acts through a controller, and none reads the measurements.
    fn ensure_controller(&self, controller: &DiscreteController) -> Result<(), Failure> {
        let given = [
            ("reference", !self.linear.reference.is_empty()),
            ("latency", self.timing.latency.is_some()),
            ("loss", self.linear.loss.is_some()),
        ];
        let reads = [&controller.b, &controller.d].iter().any(|part| part.largest() > 0.0);
        match given.iter().find(|(_, given)| *given) {
            Some((name, _)) if !reads => Err(Failure::usage(format!(
                "--{name} is given, but no controller reads the measurements; expected a controller, or --disturbance for a step of an input"
            ))),
            _ => Ok(()),
        }
    }

    fn trajectory(
        &self,
        request: &LinearRequest,
    ) -> Result<linear_trajectory::LinearRequest, Failure> {
        let linear = request.linear_loop();
        let timing = request.loop_timing().map_err(Failure::usage)?;
        let plant = linear.plant();
        self.ensure_controller(linear.controller())?;
        let LinearSimulationArgs { x0, reference, disturbance, noise, .. } = &self.linear;
        let start = match x0 {
            Some(given) => given.values().to_vec(),
            None => vec![0.0; plant.states.len()],
        };
        Ok(linear_trajectory::LinearRequest {
            start,
            reference: values("reference", "output", reference, &plant.outputs)?,
            disturbance: values("disturbance", "input", disturbance, &plant.inputs)?,
            record: request.recorded_periods().map(<[f64]>::to_vec),
            steps: self.steps_of(linear.period())?,
            every: self.every,
            ensemble: self.ensemble()?,
            seed: self.seed,
            linear: if *noise { linear.clone() } else { linear.without_noise() },
            timing,
            motion: None,
        })
    }
}

impl SimulateArgs {
    /// The ensemble of `--num-trajectories`; none without it.
    pub(crate) fn ensemble(&self) -> Result<Option<EnsembleOptions>, Failure> {
        let Some(count) = self.count else { return Ok(None) };
        let instructions = simd::instruction_set(self.simd)?;
        let (spread, threads) = (self.spread, self.threads);
        Ok(Some(EnsembleOptions { count, spread, threads, instructions }))
    }
}

/// The controller of `--lqr` or `--gain`; none without them.
pub(super) fn controller_table(
    lqr: Option<&WeightsTable>,
    gain: Option<&Gain>,
) -> Option<LinearControllerTable> {
    let lqr = lqr.map(|weights| LinearControllerTable::Lqr(weights.clone()));
    let feedback = |Gain(gain): &Gain| StateFeedbackTable { gain: gain.clone() };
    lqr.or(gain.map(|gain| LinearControllerTable::StateFeedback(feedback(gain))))
}

/// The loop around the plant of a file, which `change` changes.
pub(super) fn loop_of_plant(
    (path, flag): (&Path, &str),
    controller: Option<LinearControllerTable>,
    period: Option<f64>,
    change: impl FnOnce(&mut RequestFile),
) -> Result<LinearRequest, Failure> {
    let plant = read_plant(path).map_err(|why| {
        Failure::usage(format!("cannot use `{}` ({flag}): {why}", path.display()))
    })?;
    let looped = LinearLoopTable { period: period.map(Number), ..Default::default() };
    let mut file = RequestFile { controller, looped, ..Default::default() };
    file.system.linear = plant;
    change(&mut file);
    LinearRequest::new(file).map_err(|fault| Failure::usage(named(&fault)))
}

/// Timing options of a loop around a linear plant.
pub(super) struct TimingOptions<'a> {
    pub(super) latency: Option<LatencyOption>,
    pub(super) output_latency: &'a [LatencyOption],
    pub(super) jitter: Option<Jitter>,
    pub(super) loss: Option<f64>,
}

impl TimingOptions<'_> {
    /// Puts the options in place of what a file states. A plant without a controller gets commands of zero.
    pub(super) fn set(&self, file: &mut RequestFile) {
        if file.controller.is_none()
            && let Ok(plant) = file.system.linear.plant()
        {
            file.controller = Some(LinearControllerTable::open_loop(&plant));
        }
        let period = file.period();
        let looped = &mut file.looped;
        if let Some(late) = self.latency {
            looped.latency = Channels::All(Number(seconds(late, period)));
        }
        match self.output_latency {
            [] => {}
            [one] => looped.output_latency = Channels::All(Number(seconds(*one, period))),
            all => {
                let all = all.iter().map(|one| Number(seconds(*one, period)));
                looped.output_latency = Channels::Each(all.collect());
            }
        }
        if let Some(jitter) = self.jitter {
            let law = if let Jitter::Uniform(_) = jitter { "uniform" } else { "gaussian" };
            (looped.jitter, looped.law) = (Number(jitter.rms()), law.into());
            looped.time_stamps.clear();
        }
        looped.loss = self.loss.map_or(looped.loss, Number);
    }
}

/// A value for each signal: those given by name, and zeros.
fn values(
    option: &str,
    kind: &str,
    given: &[(String, f64)],
    signals: &[Signal],
) -> Result<Vec<f64>, Failure> {
    let mut all = vec![0.0; signals.len()];
    for (name, value) in given {
        let Some(place) = signals.iter().position(|signal| signal.name == *name) else {
            let known = signals.iter().map(|signal| &*signal.name);
            let hint = suggestions::suggest(&format!("{kind}s"), name, known);
            return Err(Failure::usage(format!("unknown {kind} `{name}` (--{option}): {hint}")));
        };
        all[place] = *value;
    }
    Ok(all)
}

pub(super) fn number(text: &str) -> Result<f64, String> {
    finite(text).ok_or_else(|| "expected a finite number".to_owned())
}
