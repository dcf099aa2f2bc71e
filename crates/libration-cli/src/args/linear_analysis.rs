//! Arguments of analyses of linear plants and loops around them.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use clap::Args;
use libration_advise::linear::{AnalysisFile, LinearRequest, RequestFile};
use libration_analyze::{LatencyOption, linear_analysis};
use libration_settings::linear_loop::WeightsTable;

use super::AnalyzeArgs;
use super::linear::{Gain, lqr, rows};
use super::linear_simulation::{TimingOptions, controller_table, loop_of_plant};
use super::number::period;
use super::timing::latency;
use crate::error::Failure;

/// Arguments of a linear plant and the loop around it.
#[derive(Args, Clone, Debug)]
pub(crate) struct LinearAnalysisArgs {
    /// File of a linear plant ẋ = Ax + Bu, y = Cx + Du: .toml, .json, .csv, .npz or .mat; without --lqr or --gain in open loop
    #[arg(long, value_name = "FILE", group = "loop", conflicts_with_all = NOT_LINEAR)]
    plant: Option<PathBuf>,
    /// File of a loop around a linear plant, as for `advise --config`; without a controller in open loop
    #[arg(long, value_name = "FILE", group = "loop", conflicts_with_all = NOT_LINEAR)]
    config: Option<PathBuf>,
    /// Design a linear-quadratic regulator with these weights of the squares of states and inputs, e.g. 10,1/0.1
    #[arg(long, value_name = "STATES/INPUTS", value_parser = lqr, requires = "plant", conflicts_with_all = ["gain", "system"])]
    lqr: Option<WeightsTable>,
    /// Gain K of the state feedback u = −Kx, rows (inputs) separated by semicolons, e.g. "10,2;0,1"
    #[arg(long, value_name = "ROWS", value_parser = rows, requires = "plant", conflicts_with = "system", allow_hyphen_values = true)]
    gain: Option<Gain>,
    /// Period of the loop in s, also as 2ms or 500Hz [default: 0.01]
    #[arg(long, value_name = "SECONDS", value_parser = period, requires = "plant", conflicts_with = "system", allow_hyphen_values = true)]
    period: Option<f64>,
    /// Latency of the measurements of a linear plant: of all, or of each [default: 0]
    #[arg(long, value_name = "TIME", value_parser = latency, value_delimiter = ',', requires = "loop", conflicts_with = "system", allow_hyphen_values = true)]
    output_latency: Vec<LatencyOption>,
}

/// Options that are about systems of the catalogue.
const NOT_LINEAR: [&str; 13] = [
    "system",
    "force",
    "set",
    "q",
    "start",
    "v",
    "feedback",
    "skew",
    "cost_weights",
    "steps",
    "max_drift",
    "max_amplitude",
    "max_error",
];

impl AnalyzeArgs {
    /// Returns the request for a linear plant, if there is one.
    pub(crate) fn linear_request(
        &self,
        read: impl FnOnce(&Path, &dyn Fn(&mut RequestFile)) -> Result<LinearRequest, Failure>,
    ) -> Option<Result<linear_analysis::LinearRequest, Failure>> {
        let contents = RefCell::new(AnalysisFile::default());
        let change = |file: &mut RequestFile| {
            contents.replace(AnalysisFile::complete(file));
            self.timing_options().set(file);
        };
        let request = match (&self.linear.plant, &self.linear.config) {
            (Some(path), _) => {
                let LinearAnalysisArgs { lqr, gain, period, .. } = &self.linear;
                let controller = controller_table(lqr.as_ref(), gain.as_ref());
                loop_of_plant((path, "--plant"), controller, *period, change)
            }
            (None, Some(path)) => read(path, &change),
            (None, None) => return None,
        };
        Some(request.and_then(|request| self.analysis(&request, &contents.borrow())))
    }

    /// The first option of a loop and its clock.
    pub(crate) fn loop_option(&self) -> Option<&'static str> {
        let given = [
            ("--feedback", self.timing.feedback.is_some()),
            ("--latency", self.timing.latency.is_some()),
            ("--jitter", self.timing.jitter.is_some()),
            ("--skew", self.timing.skew.is_some()),
            ("--loss", self.cost.loss.is_some()),
            ("--cost-weights", self.cost.cost_weights.is_some()),
        ];
        given.into_iter().find(|(_, given)| *given).map(|(flag, _)| flag)
    }

    fn timing_options(&self) -> TimingOptions<'_> {
        TimingOptions {
            latency: self.timing.latency,
            output_latency: &self.linear.output_latency,
            jitter: self.timing.jitter,
            loss: self.cost.loss,
        }
    }

    fn analysis(
        &self,
        request: &LinearRequest,
        contents: &AnalysisFile,
    ) -> Result<linear_analysis::LinearRequest, Failure> {
        let loop_options = [
            (self.linear.period.is_some(), "period"),
            (self.timing.latency.is_some(), "latency"),
            (!self.linear.output_latency.is_empty(), "output-latency"),
            (self.timing.jitter.is_some(), "jitter"),
            (self.cost.loss.is_some(), "loss"),
        ];
        let given = loop_options.iter().find(|(given, _)| *given && !contents.has_controller);
        if let Some((_, option)) = given {
            return Err(Failure::usage(format!(
                "--{option} is given, but there is no controller; expected --lqr or --gain, or a controller in the file"
            )));
        }
        contents.request(request, self.dt, self.integrator).map_err(Failure::usage)
    }
}
