//! Temperatures of Langevin dynamics and their bias by the time step: the output of `libration analyze --temperature`.

mod error;
mod measurement;
mod normal_modes;
mod prediction;
mod recommendation;
mod significant_digits;

use libration::analysis::covariance_formulas;
use libration::thermostat::LangevinMethod;
use libration_report::verdict::Verdict;
use libration_settings::equations::EquationSystem;
use libration_work::Work;
use serde::Serialize;

pub use error::TemperatureError;
use measurement::{Ensemble, Lengths, Means};
use normal_modes::NormalModes;
use prediction::{ModeBiases, Prediction};
use recommendation::recommended;
pub use significant_digits::significant;

/// Version of the JSON format.
pub const SCHEMA: &str = "libration.temperature/1";

/// The relative bias that the largest accurate steps allow.
pub const BIAS_LIMIT: f64 = 0.01;

/// Trajectories of a measurement: each is a batch of its standard error.
pub const TRAJECTORIES: u64 = 32;

/// Most steps of a measurement.
const MOST_STEPS: u64 = 10_000_000_000;

/// The part of the start that a trajectory may keep when its measurement begins, in second moments.
const KEPT: f64 = 1e-8;

/// The least product of `z²`, with `z = ωΔt` of the slowest mode, and the smaller of 1 and `γΔt`. Stein's equation is close to singular by
/// this factor: 106 bits then leave eight digits of a temperature.
const RESOLUTION: f64 = 1e-22;

/// A system at a temperature.
#[derive(Clone, Debug)]
pub struct TemperatureRequest {
    /// The system; its inputs are zero. It starts in the valley of a stable equilibrium.
    pub system: EquationSystem,
    /// `kT` in units of the energy of the system.
    pub temperature: f64,
    /// The friction `γ` in 1/s.
    pub friction: f64,
    /// The time step in s; one over the frequency of the fastest mode if none.
    pub dt: Option<f64>,
    /// The methods.
    pub thermostats: Vec<LangevinMethod>,
    /// Measured steps of each method, over all trajectories.
    pub steps: u64,
    /// The seed of the noise.
    pub seed: u64,
}

/// Methods at a temperature; the fields are the keys of `analyze --temperature --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TemperatureReport {
    /// The version of this format.
    pub schema: &'static str,
    /// The name of the system.
    pub system: String,
    /// `kT` in units of the energy of the system.
    pub temperature: f64,
    /// The friction in 1/s.
    pub friction: f64,
    /// The time step in s.
    pub dt: f64,
    /// Measured steps of each method, over all trajectories.
    pub steps: u64,
    /// The number of trajectories.
    pub trajectories: u64,
    /// The seed of the noise.
    pub seed: u64,
    /// The positions of the equilibrium.
    pub equilibrium: Vec<f64>,
    /// The mass matrix by rows.
    pub mass: Vec<Vec<f64>>,
    /// Angular frequencies of the modes about the equilibrium in rad/s, the slowest first.
    pub frequencies: Vec<f64>,
    /// The relative bias that `accurate_dt` allows.
    pub bias_limit: f64,
    /// The method with the least bias of positions: of several, that with the fewest force evaluations, then with the least bias of
    /// velocities. None if none is stable and stays finite.
    pub recommended: Option<String>,
    /// Whether the recommended method is stable at the time step; unstable if none is.
    pub verdict: Verdict,
    /// The methods in the order of the request.
    pub thermostats: Vec<ThermostatReport>,
}

/// A method at a temperature.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ThermostatReport {
    /// The name or the word.
    pub thermostat: String,
    /// Force evaluations of a step.
    pub evaluations: usize,
    /// Whether all modes are stable at the time step.
    pub stable: bool,
    /// The end of the stable time steps of the fastest mode in s.
    pub stable_dt: f64,
    /// The temperature of positions: the virial `⟨−q·F⟩` from the equilibrium, for each degree of freedom.
    pub configuration: TemperatureBias,
    /// The temperature of velocities: `⟨m v²⟩` for each degree of freedom.
    pub kinetic: TemperatureBias,
    /// Number of measured trajectories that became infinite.
    pub infinite: usize,
    /// Why a number is missing or uncertain; none if none is.
    pub note: Option<String>,
}

/// A temperature and its bias, relative to the temperature.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TemperatureBias {
    /// The temperature of a mode over `kT`, as a function of `z = ωΔt`; none if it depends on the friction.
    pub formula: Option<String>,
    /// The power of the time step as which the predicted bias vanishes; none of a bias that is zero.
    pub order: Option<u32>,
    /// The predicted bias of the fastest mode; none if the step is not stable.
    pub fastest_mode_bias: Option<f64>,
    /// The predicted bias of the mean over the modes.
    pub predicted_bias: Option<f64>,
    /// The measured bias.
    pub measured_bias: Option<f64>,
    /// The standard error of the measured bias, from the means of trajectories.
    pub standard_error: Option<f64>,
    /// The end of the time steps in s at which the predicted bias of the fastest mode is within `bias_limit`.
    pub accurate_dt: f64,
}

/// Predicts and measures temperatures.
///
/// # Errors
/// [`TemperatureError`]: an invalid request, or an interrupt.
pub fn analyze_temperature(
    work: &Work<'_>,
    request: &TemperatureRequest,
) -> Result<TemperatureReport, TemperatureError> {
    let TemperatureRequest { system, temperature, friction, steps, seed, .. } = request;
    let modes = NormalModes::new(system)?;
    let dt = request.dt.unwrap_or(1.0 / modes.fastest());
    check(request, &modes, dt)?;
    let predictions: Vec<Prediction<'_>> = request
        .thermostats
        .iter()
        .map(|method| Prediction { method, frequencies: &modes.frequencies, friction: *friction })
        .collect();
    let mut thermostats = work.sweep("predictions", &predictions, |prediction| {
        Ok::<_, TemperatureError>(predicted(prediction, dt))
    })?;
    let measured = steps.div_ceil(TRAJECTORIES);
    let mut jobs = Vec::new();
    for (i, (prediction, report)) in predictions.iter().zip(&mut thermostats).enumerate() {
        if !report.stable {
            let limit = significant(report.stable_dt);
            report.note = Some(format!("not stable: dt must be below {limit} s"));
            continue;
        }
        // Rounding may give a memory of 1.
        let memory = prediction.memory(dt).min(1.0 - 0.5 * f64::EPSILON);
        let discarded = (0.5 * KEPT.ln() / memory.ln()).ceil();
        if discarded > measured as f64 {
            let steps = discarded * TRAJECTORIES as f64;
            let discarded = significant(discarded);
            report.note = Some(format!(
                "not measured: the slowest mode remembers its start for {discarded} steps, which {TRAJECTORIES} trajectories do not have; help: raise steps above {steps:.1e}, or the friction"
            ));
            continue;
        }
        let lengths = Lengths { discarded: discarded as u64, measured };
        jobs.extend((0..TRAJECTORIES).map(|trajectory| (i, lengths, trajectory)));
    }
    let ensemble = Ensemble { request, modes: &modes, dt };
    let means = work.sweep("trajectories", &jobs, |&(i, lengths, trajectory)| {
        let means = ensemble.means(work, predictions[i].method, lengths, trajectory)?;
        Ok::<_, TemperatureError>((i, means))
    })?;
    for (i, report) in thermostats.iter_mut().enumerate() {
        let own = means.iter().filter(|(method, _)| *method == i).map(|(_, means)| *means);
        write_measurement(report, &own.collect::<Vec<_>>());
    }
    let NormalModes { equilibrium, mass, frequencies, .. } = &modes;
    Ok(TemperatureReport {
        schema: SCHEMA,
        system: system.name.clone(),
        temperature: *temperature,
        friction: *friction,
        dt,
        steps: measured * TRAJECTORIES,
        trajectories: TRAJECTORIES,
        seed: *seed,
        equilibrium: equilibrium.clone(),
        mass: (0..mass.rows()).map(|i| mass.row(i).to_vec()).collect(),
        frequencies: frequencies.clone(),
        bias_limit: BIAS_LIMIT,
        verdict: recommendation::judge(&thermostats, dt),
        recommended: recommended(&thermostats),
        thermostats,
    })
}

/// Checks a request before any work.
fn check(
    request: &TemperatureRequest,
    modes: &NormalModes,
    dt: f64,
) -> Result<(), TemperatureError> {
    let no_stationary = ": without friction no temperature is stationary";
    for (name, value, reason) in [
        ("temperature", request.temperature, ""),
        ("friction", request.friction, no_stationary),
        ("dt", dt, ""),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(TemperatureError::Number { name, value, reason });
        }
    }
    let slowest = modes.frequencies.first().copied().unwrap_or(f64::NAN);
    let least = (RESOLUTION.sqrt() / slowest)
        .max((RESOLUTION / request.friction).cbrt() / slowest.cbrt().powi(2));
    if dt < least {
        return Err(TemperatureError::Resolution { dt, least });
    }
    if !(TRAJECTORIES..=MOST_STEPS).contains(&request.steps) {
        return Err(TemperatureError::Steps { steps: request.steps });
    }
    if request.thermostats.is_empty() {
        return Err(TemperatureError::NoThermostat);
    }
    Ok(())
}

/// The predictions of a method.
fn predicted(prediction: &Prediction<'_>, dt: f64) -> ThermostatReport {
    let biases = prediction.biases(dt);
    let (orders, accurate) = (prediction.orders(), prediction.accurate_dt());
    let mut formulas = covariance_formulas(prediction.method);
    let mut temperature = |i: usize| {
        let bias = |of: fn(&ModeBiases) -> f64| biases.as_ref().map(|both| of(&both[i]));
        TemperatureBias {
            formula: formulas[i].take(),
            order: orders[i],
            fastest_mode_bias: bias(|one| one.fastest),
            predicted_bias: bias(|one| one.mean),
            measured_bias: None,
            standard_error: None,
            accurate_dt: accurate[i],
        }
    };
    ThermostatReport {
        thermostat: prediction.method.to_string(),
        evaluations: prediction.method.evaluations(),
        stable: biases.is_some(),
        stable_dt: prediction.stable_dt(),
        configuration: temperature(0),
        kinetic: temperature(1),
        infinite: 0,
        note: None,
    }
}

/// Writes the mean over trajectories and its standard error.
fn write_measurement(report: &mut ThermostatReport, trajectories: &[Option<Means>]) {
    let finite: Vec<Means> = trajectories.iter().copied().flatten().collect();
    let (count, all) = (finite.len(), trajectories.len());
    report.infinite = all - count;
    if count < all {
        report.note = Some(format!(
            "not measured: {} of {all} trajectories became infinite: dt is too long for their forces, or the potential has no bound",
            all - count
        ));
    }
    if count < all || all < 2 {
        return;
    }
    let left = finite.iter().filter(|means| !means.is_at_home).count();
    if left > 0 {
        report.note = Some(format!(
            "{left} of {all} trajectories ended in another valley: the virial converges slowly there, and is no temperature where a coordinate is an angle; help: lower the temperature"
        ));
    }
    for (i, temperature) in [&mut report.configuration, &mut report.kinetic].into_iter().enumerate()
    {
        let mean = finite.iter().map(|means| means.temperatures[i]).sum::<f64>() / count as f64;
        let square = finite.iter().map(|means| (means.temperatures[i] - mean).powi(2)).sum::<f64>();
        temperature.measured_bias = Some(mean - 1.0);
        temperature.standard_error = Some((square / (count as f64 * (count as f64 - 1.0))).sqrt());
    }
}
