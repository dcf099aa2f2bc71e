//! Requests for advice on loops around linear plants.

use std::collections::BTreeMap;
use std::path::Path;

use libration::control::Jitter;
use libration::control::clock::{Recorded, RecordedError};
use libration::linear::{
    CostWeights, LinearLoop, LinearLoopError, LinearPlant, Matrix, MissingCommand,
};
use libration_logs::{StampOptions, read_time_stamps};
use libration_settings::equations::EquationSystem;
use libration_settings::linear_loop::{Design, LinearLoopTable, OperatingPoint, Part};
use libration_settings::{Document, Fault, Number, SettingsError, suggestions};

use super::clock::clocked;
use super::redesign_toml::RedesignToml;
use super::request_file::RequestFile;
use super::stated_deadlines::StatedDeadlines;
use super::timing_fault::fault_of_timing;
use crate::control::{skew_of, uneven};
use crate::timed_loop::{StatedTiming, TimedLoop};

/// A loop around a linear plant, designed, with its timing.
#[derive(Clone, Debug)]
pub struct LinearRequest {
    /// The plant without lags and filters.
    pub(super) plant: LinearPlant,
    /// The equilibrium at which a system of the catalogue was linearised.
    pub(super) operating_point: Option<OperatingPoint>,
    /// The system of equations that was linearised.
    pub(super) system: Option<EquationSystem>,
    /// Whether the plant is the linearisation of a nonlinear system.
    pub(super) is_linearised: bool,
    /// Whether the request states where it is linearised, in place of the start of the system.
    pub(super) has_stated_point: bool,
    pub(super) parts: Vec<Part>,
    pub(super) design: Design,
    pub(super) timed: TimedLoop,
    pub(super) deadlines: StatedDeadlines,
    /// The largest rise of the cost, `ΔJ/J₀`.
    pub(super) cost_tolerance: Option<f64>,
    pub(super) redesign_toml: RedesignToml,
    /// Whether to compute a stability map.
    pub map: bool,
    /// Whether to design the controller of least cost for the stated timing.
    pub redesign: bool,
    /// The command line that repeats the request, without options of output.
    pub invocation: String,
}

/// Whether a request file describes a linear plant.
pub fn is_linear(text: &str) -> bool {
    let table: Option<toml::Table> = text.parse().ok();
    let system = table.as_ref().and_then(|table| table.get("system"));
    system.and_then(|system| system.get("linear")).is_some()
}

/// Parses a request; `file_name` is the name in messages.
///
/// # Errors
/// [`SettingsError`] with the position of the error.
pub fn parse(text: &str, file_name: &str) -> Result<LinearRequest, SettingsError> {
    parse_changed(text, file_name, |_| ())
}

/// Parses a request that `change` changes, as options of a command do.
///
/// # Errors
/// As for [`parse`].
pub fn parse_changed(
    text: &str,
    file_name: &str,
    change: impl FnOnce(&mut RequestFile),
) -> Result<LinearRequest, SettingsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let document = Document::parse(text, file_name)?;
    let file: Result<RequestFile, _> = toml::from_str(text);
    let mut file = file.map_err(|error| document.explain(&error))?;
    change(&mut file);
    let request = LinearRequest::new(file).map_err(|fault| document.locate(fault))?;
    Ok(LinearRequest { invocation: format!("libration advise --config {file_name}"), ..request })
}

/// Periods in s that a request may have.
const PERIODS: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

impl LinearRequest {
    /// The loop that a file describes.
    ///
    /// # Errors
    /// [`Fault`]: an invalid value, or a design that fails.
    pub fn new(file: RequestFile) -> Result<Self, Fault> {
        let plant = file.system.linear.plant()?;
        let operating_point = file.system.linear.operating_point()?;
        let table = &file.system.linear;
        let system = table.equations()?;
        let is_linearised = operating_point.is_some() && !table.is_linear_system();
        let has_stated_point = table.at.is_some() || table.command.is_some();
        let period = file.period();
        let Some(controller) = file.controller else {
            let message = "there is no controller; expected a table, as [controller.lqr]";
            return Err(Fault::new("controller", message));
        };
        if !PERIODS.contains(&period) {
            let message = format!("`period` is {period:?}; expected 1e-9 to 1e9 (s)");
            return Err(Fault::new("loop.period", message));
        }
        let design = controller.design(&plant, period)?;
        let parts = file.part.iter().map(|table| table.part(&design.plant));
        let parts = parts.collect::<Result<Vec<Part>, Fault>>()?;
        let controllers = Part::filtered(&parts, &design.controllers, &design.plant, period);
        let mut whole = design.plant.clone();
        for part in &parts {
            whole = part.applied(&whole)?;
        }
        let weights = weights(&file.looped, &design, &plant)?;
        weights.check(&plant).map_err(|error| Fault::new("loop.cost", error.to_string()))?;
        let noise = match &file.looped.measurement_noise {
            Some(variances) => {
                let outputs = design.plant.outputs.len();
                variances.variances("loop.measurement-noise", "outputs", outputs)?
            }
            None => design.measurement.clone(),
        };
        let form = padded(&weights, plant.states.len(), whole.states.len());
        let timing = timing(&file.looped, &design.plant, period)?;
        let redesign_toml = RedesignToml::new(&file.looped, &plant, &design, &weights, &noise);
        let deadlines = StatedDeadlines::new(&file.looped, design.cascade.is_some())?;
        let linear = LinearLoop::new(whole, controllers, period, form, noise);
        let wrong = |error: LinearLoopError| Fault::new("loop", error.to_string());
        let mut linear = linear.map_err(wrong)?;
        if let Some(clocked) = clocked(&file.looped.clock, &design, &parts, period)? {
            linear = linear.with_measured_clock(clocked).map_err(wrong)?;
        }
        let mut timed = TimedLoop {
            linear,
            timing,
            names_states: true,
            critical_latency: None,
            is_near_neutral: false,
        };
        let stated = timed.stated().and_then(|stated| timed.linear.size(&stated));
        stated.map_err(|error| fault_of_timing(&error, &timed.timing, period))?;
        let ideal = timed.linear.stability(&timed.ideal());
        timed.is_near_neutral = ideal.is_ok_and(|found| found.is_near_neutral());
        let cost_tolerance = tolerance(file.tolerance)?;
        let invocation = "libration advise --config FILE".into();
        Ok(LinearRequest {
            plant,
            operating_point,
            system,
            is_linearised,
            has_stated_point,
            parts,
            design,
            timed,
            deadlines,
            cost_tolerance,
            redesign_toml,
            map: false,
            redesign: false,
            invocation,
        })
    }

    /// The period of the loop, in s.
    pub fn period(&self) -> f64 {
        self.timed.linear.period()
    }

    /// The same loop with recorded time stamps in s; their mean interval determines the skew.
    ///
    /// # Errors
    /// [`RecordedError`]: invalid time stamps.
    pub fn with_time_stamps(mut self, stamps: &[f64]) -> Result<Self, RecordedError> {
        let timing = &mut self.timed.timing;
        let period = self.timed.linear.period();
        replay(timing, stamps, period)?;
        Ok(self)
    }
}

fn replay(timing: &mut StatedTiming, stamps: &[f64], period: f64) -> Result<(), RecordedError> {
    let (steps, mean) = Recorded::steps_between(stamps)?;
    let (rms, record) = uneven(steps);
    timing.skew = skew_of(mean, period);
    timing.jitter = timing.jitter.with_rms(rms);
    timing.record = record;
    Ok(())
}

/// The weights of the cost: those of the file, of the design, or the squares of the outputs.
fn weights(
    table: &LinearLoopTable,
    design: &Design,
    plant: &LinearPlant,
) -> Result<CostWeights, Fault> {
    if let Some(own) = &table.cost {
        return own.cost(["loop.cost.states", "loop.cost.outputs", "loop.cost.inputs"], plant);
    }
    if let Some(weights) = &design.weights {
        return Ok(weights.clone());
    }
    let m = plant.inputs.len();
    // Of inputs a part that rounding does not lose, so that the form is that of a regulator.
    let states = &plant.c.transposed() * &plant.c;
    let size = states.largest().max(f64::MIN_POSITIVE);
    Ok(CostWeights { states, inputs: Matrix::identity(m).scaled(1e-12 * size) })
}

/// The form of states and inputs, with states that cost nothing between them.
fn padded(weights: &CostWeights, states: usize, all: usize) -> Matrix {
    let size = all + weights.inputs.rows();
    let mut form = Matrix::zeros(size, size);
    form.set_block((0, 0), &weights.states.block((0, 0), (states, states)));
    form.set_block((all, all), &weights.inputs);
    form
}

fn timing(
    table: &LinearLoopTable,
    plant: &LinearPlant,
    period: f64,
) -> Result<StatedTiming, Fault> {
    let jitter = match &*table.law {
        "gaussian" => Jitter::Gaussian(table.jitter.0),
        "uniform" => Jitter::Uniform(table.jitter.0),
        other => {
            let fault = Fault::new("loop.law", format!("unknown law `{other}`"));
            return Err(fault.help(suggestions::suggest_law(other)));
        }
    };
    let missing = match &*table.missing {
        "hold" => MissingCommand::Hold,
        "zero" => MissingCommand::Zero,
        other => {
            let fault = Fault::new("loop.missing", format!("unknown value `{other}` of `missing`"));
            return Err(fault.help(suggestions::suggest("values", other, ["hold", "zero"])));
        }
    };
    let ensure = |key: &'static str, name: &str, value: f64, allowed: &str, holds: bool| match holds
    {
        true => Ok(()),
        false => Err(Fault::new(key, format!("`{name}` is {value:?}; expected {allowed}"))),
    };
    let rms = table.jitter.0;
    ensure("loop.jitter", "jitter", rms, "a relative rms from 0 to 1", (0.0..=1.0).contains(&rms))?;
    let skew = table.skew.0;
    ensure("loop.skew", "skew", skew, "above -1 and below 8", skew > -1.0 && skew < 8.0)?;
    let loss = table.loss.0;
    let allowed = "a probability of at least 0 and below 1";
    ensure("loop.loss", "loss", loss, allowed, (0.0..1.0).contains(&loss))?;
    let (m, p) = (plant.inputs.len(), plant.outputs.len());
    let mut timing = StatedTiming {
        input_latency: table.latency.each("loop.latency", "inputs", m)?,
        output_latency: table.output_latency.each("loop.output-latency", "outputs", p)?,
        jitter,
        skew,
        loss,
        missing,
        record: None,
    };
    if !table.time_stamps.is_empty() {
        if skew != 0.0 {
            let message = "`skew` is given, but `time-stamps` determine the skew";
            return Err(Fault::new("loop.skew", message));
        }
        let path = &table.time_stamps;
        let wrong =
            |why: String| Fault::new("loop.time-stamps", format!("cannot use `{path}`: {why}"));
        let stamps = read_time_stamps(Path::new(path), &StampOptions::default()).map_err(wrong)?;
        replay(&mut timing, &stamps, period).map_err(|error| wrong(error.to_string()))?;
    }
    Ok(timing)
}

fn tolerance(table: BTreeMap<String, Number>) -> Result<Option<f64>, Fault> {
    match table.into_iter().collect::<Vec<_>>()[..] {
        [] => Ok(None),
        [(ref name, Number(most))] if name == "cost" && most.is_finite() && most > 0.0 => {
            Ok(Some(most))
        }
        [(ref name, Number(most))] if name == "cost" => {
            let message = format!("`cost` is {most:?}; expected a finite number above 0");
            Err(Fault::new("tolerance.cost", message))
        }
        _ => {
            let message =
                "a loop around a linear plant has no tolerance but `cost`, the largest rise ΔJ/J₀";
            Err(Fault::new("tolerance", message))
        }
    }
}
