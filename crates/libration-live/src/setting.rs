//! The setting of a live page, as text.

use core::fmt::{self, Display};
use core::str::FromStr;

use libration_core::{AnyMethod, Method};
use libration_equations::{Definitions, EquationError};
use thiserror::Error;

use crate::subject::Subject;

/// A system by its equations, and how it is stepped and controlled.
///
/// As text it has a line `key=value` for each entry, in the names of a file of a system and of the command line:
/// `acceleration.q=-k*q`, `parameter.k=10`, `start.q=1`, `integrator=rk4`, `dt=0.01`.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The name of the system.
    pub system: String,
    /// Its equations.
    pub definitions: Definitions,
    /// Initial values by name, `q'` for a velocity; others are zero.
    pub start: Vec<(String, f64)>,
    /// The integrator.
    pub integrator: AnyMethod,
    /// The time step, in s.
    pub dt: f64,
    /// The time of the motion, in s.
    pub horizon: f64,
    /// The loop around the system; none for free motion.
    pub control: Option<Control>,
}

/// A state feedback `u = u₀ − K(x − x₀)` around the equilibrium `x₀` that the inputs `u₀` hold, and its timing.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// Rows: inputs. Columns: coordinates, then velocities and states of first order, in the order of the definitions.
    pub gain: Vec<Vec<f64>>,
    /// A factor of all gains.
    pub gain_factor: f64,
    /// The period, in s.
    pub period: f64,
    /// The latency of commands, in s.
    pub latency: f64,
    /// The rms of the lengths of periods about their mean, as a part of it; Gaussian.
    pub jitter: f64,
    /// The part by which all periods are longer than the controller's clock says.
    pub skew: f64,
    /// The probability that a command is lost; the one before stays active.
    pub loss: f64,
    /// The seed of all random numbers.
    pub seed: u64,
}

/// Error of a setting.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SettingError {
    /// A line without `=`.
    #[error("`{0}` is no entry; expected KEY=VALUE")]
    Line(String),
    /// A key that does not exist.
    #[error("unknown key `{0}`")]
    Key(String),
    /// A value that is not allowed.
    #[error("{key} = {value}; expected {expected}")]
    Value {
        /// The key.
        key: String,
        /// The value.
        value: String,
        /// What is allowed.
        expected: &'static str,
    },
    /// Equations that are wrong.
    #[error("{}: {}", .0.key, .0.kind)]
    Equations(EquationError),
    /// A subject that cannot be shown.
    #[error("{0}")]
    Subject(String),
}

impl From<EquationError> for SettingError {
    fn from(error: EquationError) -> Self {
        SettingError::Equations(error)
    }
}

impl Default for Control {
    fn default() -> Self {
        Control {
            gain: Vec::new(),
            gain_factor: 1.0,
            period: 0.01,
            latency: 0.0,
            jitter: 0.0,
            skew: 0.0,
            loss: 0.0,
            seed: 0,
        }
    }
}

impl Setting {
    /// Free motion of a system by its equations: in steps of a fifth of a radian of the fastest mode, over sixty radians; by velocity
    /// Verlet where accelerations depend on positions alone, else by RK4.
    pub fn of_equations(system: &str, definitions: Definitions, start: Vec<(String, f64)>) -> Self {
        let mut setting =
            Setting { system: system.to_owned(), definitions, start, ..Setting::empty() };
        let Ok(subject) = Subject::new(&setting) else { return setting };
        let rate = subject.fastest_rate();
        if rate.is_finite() && rate > 0.0 {
            setting.dt = one_digit(0.2 / rate);
            setting.horizon = one_digit(60.0 / rate);
        }
        if !subject.equations.dynamics().is_positional() {
            setting.integrator = Method::Rk4.into();
        }
        setting
    }

    /// A setting without equations and control.
    fn empty() -> Self {
        Setting {
            system: "system".into(),
            definitions: Definitions::default(),
            start: Vec::new(),
            integrator: Method::VelocityVerlet.into(),
            dt: 0.01,
            horizon: 10.0,
            control: None,
        }
    }

    /// Changes one entry.
    ///
    /// # Errors
    /// [`SettingError`]: an unknown key or a value that is not allowed.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), SettingError> {
        let number = |allowed: fn(f64) -> bool, expected| match value.trim().parse::<f64>() {
            Ok(x) if x.is_finite() && allowed(x) => Ok(x),
            _ => Err(refused(key, value, expected)),
        };
        let positive = |x: f64| x > 0.0;
        let names =
            || value.split(',').map(|name| name.trim().to_owned()).filter(|n| !n.is_empty());
        if let Some((table, name)) = key.split_once('.') {
            let text = || (name.to_owned(), value.to_owned());
            let own = &mut self.definitions;
            match table {
                "acceleration" => put(&mut own.accelerations, text()),
                "rate" => put(&mut own.rates, text()),
                "let" => put(&mut own.parts, text()),
                "parameter" => {
                    let value = number(|_| true, "a number")?;
                    put(&mut own.parameters, (name.to_owned(), value));
                }
                "start" => {
                    let value = number(|_| true, "a number")?;
                    put(&mut self.start, (name.to_owned(), value));
                }
                _ => return Err(SettingError::Key(key.to_owned())),
            }
            return Ok(());
        }
        match key {
            "system" => self.system = value.to_owned(),
            "coordinates" => self.definitions.coordinates = names().collect(),
            "inputs" => self.definitions.inputs = names().collect(),
            "energy" => self.definitions.energy = Some(value.to_owned()),
            "integrator" => {
                self.integrator = AnyMethod::from_name(value)
                    .ok_or_else(|| refused(key, value, "a name of `libration list`"))?;
            }
            "dt" => self.dt = number(positive, "seconds above 0")?,
            "horizon" => self.horizon = number(positive, "seconds above 0")?,
            _ => {
                let own = self.control.get_or_insert_default();
                let part = |x: f64| (0.0..=1.0 / 3.0).contains(&x);
                let below_one = |x: f64| (0.0..1.0).contains(&x);
                match key {
                    "gain" => {
                        own.gain = rows(value).ok_or_else(|| {
                            refused(key, value, "rows of numbers, such as 10,2;0,1")
                        })?
                    }
                    "gain-factor" => own.gain_factor = number(|_| true, "a number")?,
                    "period" => own.period = number(positive, "seconds above 0")?,
                    "latency" => own.latency = number(|x| x >= 0.0, "seconds, at least 0")?,
                    "jitter" => own.jitter = number(part, "a part of the period from 0 to 1/3")?,
                    "skew" => {
                        own.skew = number(|x| (-0.5..=1.0).contains(&x), "a part from -0.5 to 1")?;
                    }
                    "loss" => own.loss = number(below_one, "a probability from 0 to below 1")?,
                    "seed" => {
                        let seed = value.trim().parse();
                        own.seed = seed.map_err(|_| refused(key, value, "a whole number"))?;
                    }
                    _ => return Err(SettingError::Key(key.to_owned())),
                }
            }
        }
        Ok(())
    }
}

impl FromStr for Setting {
    type Err = SettingError;

    fn from_str(text: &str) -> Result<Self, SettingError> {
        let mut setting = Setting::empty();
        for line in text.lines().filter(|line| !line.trim().is_empty()) {
            let (key, value) =
                line.split_once('=').ok_or_else(|| SettingError::Line(line.to_owned()))?;
            setting.set(key.trim(), value.trim())?;
        }
        // Keys of a loop without gains leave the motion free.
        setting.control = setting.control.filter(|control| !control.gain.is_empty());
        Ok(setting)
    }
}

impl Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Setting { system, definitions, start, integrator, dt, horizon, control } = self;
        let Definitions {
            coordinates,
            accelerations,
            rates,
            parts,
            parameters,
            inputs,
            energy,
            ..
        } = definitions;
        writeln!(f, "system={system}")?;
        for (key, names) in [("coordinates", coordinates), ("inputs", inputs)] {
            if !names.is_empty() {
                writeln!(f, "{key}={}", names.join(","))?;
            }
        }
        for (table, texts) in [("let", parts), ("acceleration", accelerations), ("rate", rates)] {
            for (name, text) in texts {
                writeln!(f, "{table}.{name}={}", text.replace(['\n', '\r'], " "))?;
            }
        }
        if let Some(energy) = energy {
            writeln!(f, "energy={}", energy.replace(['\n', '\r'], " "))?;
        }
        for (table, numbers) in [("parameter", parameters), ("start", start)] {
            for (name, value) in numbers {
                writeln!(f, "{table}.{name}={value:?}")?;
            }
        }
        writeln!(f, "integrator={}\ndt={dt:?}\nhorizon={horizon:?}", integrator.name())?;
        if let Some(own) = control {
            let row = |row: &Vec<f64>| -> String {
                row.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(",")
            };
            let rows: Vec<String> = own.gain.iter().map(row).collect();
            writeln!(f, "gain={}\ngain-factor={:?}", rows.join(";"), own.gain_factor)?;
            for (key, value) in [
                ("period", own.period),
                ("latency", own.latency),
                ("jitter", own.jitter),
                ("skew", own.skew),
                ("loss", own.loss),
            ] {
                writeln!(f, "{key}={value:?}")?;
            }
            writeln!(f, "seed={}", own.seed)?;
        }
        Ok(())
    }
}

fn refused(key: &str, value: &str, expected: &'static str) -> SettingError {
    SettingError::Value { key: key.to_owned(), value: value.to_owned(), expected }
}

/// Replaces the entry of a name, or adds it.
fn put<T>(entries: &mut Vec<(String, T)>, new: (String, T)) {
    match entries.iter_mut().find(|(name, _)| *name == new.0) {
        Some(entry) => entry.1 = new.1,
        None => entries.push(new),
    }
}

/// A positive number, rounded to one digit.
fn one_digit(x: f64) -> f64 {
    format!("{x:.0e}").parse().unwrap_or(x)
}

/// Rows of numbers: `10,2;0,1`.
fn rows(text: &str) -> Option<Vec<Vec<f64>>> {
    let number = |x: &str| x.trim().parse().ok().filter(|x: &f64| x.is_finite());
    text.split(';').map(|row| row.split(',').map(number).collect()).collect()
}

#[cfg(test)]
mod tests;
