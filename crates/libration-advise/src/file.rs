//! Request files.

use std::collections::BTreeMap;
use std::path::Path;

use libration::analysis::ObserverNoise;
use libration::control::controller::PidGains;
use libration::control::{Feedback, Jitter, LqrWeights};
use libration_logs::{StampOptions, read_time_stamps};
use libration_settings::equations::EquationSystem;
use libration_settings::{
    ConfigCommand, Coordinates, Count, Document, Fault, Number, SettingsError, suggestions,
};

use super::AdviseError;
use super::control::{Control, Correction, Law, Regulator};
use super::file_tables::{ControllerTable, LoopTable, ObserverTable, RequestFile};
use super::request::{Measure, Request, Tolerance};

/// How to advise on other systems, in messages.
const OTHER_SYSTEMS: &str = "`libration advise` takes systems by equations as `--system FILE` without a loop, and as `--plant FILE` with one";

/// The default request, as a file with comments.
pub const DEFAULT: &str = include_str!("default.toml");

/// Parses a request; `file_name` is the name in messages.
///
/// # Errors
/// [`SettingsError`] with the position of the error.
pub fn parse(text: &str, file_name: &str) -> Result<Request, SettingsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let document = Document::parse(text, file_name)?;
    document.check_keys(ConfigCommand::ADVISE.keys)?;
    let file: RequestFile = toml::from_str(text).map_err(|error| document.explain(&error))?;
    let request = Request::try_from(file).map_err(|fault| document.locate(fault))?;
    Ok(Request { invocation: format!("libration advise --config {file_name}"), ..request })
}

impl TryFrom<RequestFile> for Request {
    type Error = Fault;

    fn try_from(file: RequestFile) -> Result<Self, Fault> {
        let coordinates = |given: Option<Coordinates>| given.map_or(vec![0.0], Coordinates::list);
        let (system, actuation) = file.system.build(OTHER_SYSTEMS)?;
        let control = match file.controller {
            None if file.looped.is_some() => {
                let message = "`[loop]` requires a controller, as [controller.pd]";
                return Err(Fault::new("loop", message));
            }
            None => None,
            Some(table) => Some(control(law(table)?, file.looped.unwrap_or_default())?),
        };
        let (q, v) = (coordinates(file.start.q), coordinates(file.start.v));
        if !system.entry().dimensions.contains(&q.len()) {
            let message = system.entry().wrong_dimension(q.len()).to_string();
            return Err(Fault::new("start.q", message));
        }
        if q.len() != v.len() {
            let (q, v) = (q.len(), v.len());
            return Err(Fault::new("start.v", format!("`q` has {q} numbers and `v` {v}")));
        }
        let system = EquationSystem::of_catalogue((system, actuation), Some(&q), Some(&v))
            .map_err(|error| Fault::new("system", error.to_string()))?;
        let request = Request {
            control,
            rollout: file.request.rollout.map(|Count(n)| usize::try_from(n).unwrap_or(0)),
            invocation: "libration advise --config FILE".into(),
            ..Request::new(system, tolerance(file.tolerance)?, file.request.horizon.0)
        };
        request.check().map_err(|error| match error {
            AdviseError::Value { name, value, allowed } => {
                Fault::new(name, format!("`{name}` is {value:?}, but it must be {allowed}"))
            }
            error @ AdviseError::Parameter { .. } => Fault::new("system", error.to_string()),
            error => Fault::new("tolerance", error.to_string()),
        })?;
        Ok(request)
    }
}

fn tolerance(table: BTreeMap<String, Number>) -> Result<Tolerance, Fault> {
    let mut all = table.into_iter();
    let (Some((name, Number(most))), None) = (all.next(), all.next()) else {
        return Err(Fault::new(
            "tolerance",
            "`tolerance` must have exactly one key, as trajectory = 1e-3",
        ));
    };
    let of = Measure::ALL.into_iter().find(|measure| measure.name() == name);
    let of = of.ok_or_else(|| {
        let fault = Fault::new("tolerance", format!("unknown tolerance `{name}`"));
        fault.help(suggestions::suggest("tolerances", &name, Measure::ALL.map(Measure::name)))
    })?;
    Ok(Tolerance { of, most })
}

fn weights([position, velocity, command]: [Number; 3]) -> LqrWeights {
    LqrWeights { position: position.0, velocity: velocity.0, command: command.0 }
}

fn law(table: ControllerTable) -> Result<Law, Fault> {
    Ok(match table {
        ControllerTable::Pd(t) => {
            Law::Pd(Feedback { position: t.position.0, velocity: t.velocity.0 })
        }
        ControllerTable::Pid(t) => Law::Pid(PidGains {
            proportional: t.proportional.0,
            integral: t.integral.0,
            derivative: t.derivative.0,
            filter: t.filter.0,
            most: t.most.0,
            tracking: t.tracking.0,
            target: [0.0],
        }),
        ControllerTable::Lqr(t) => Law::Lqr(weights(t.weights)),
        ControllerTable::Observer(t) => observer(t)?,
    })
}

fn observer(t: ObserverTable) -> Result<Law, Fault> {
    let fault = |message: &str| Fault::new("controller.observer", message.to_owned());
    let feedback = match (t.gains, t.weights) {
        (Some([position, velocity]), None) => {
            Regulator::Gains(Feedback { position: position.0, velocity: velocity.0 })
        }
        (None, Some(table)) => Regulator::Lqr(weights(table)),
        _ => return Err(fault("it must have either `gains` or `weights`")),
    };
    let correction = match (t.correction, t.acceleration, t.position) {
        (Some(gains), None, None) => Correction::Gains(gains.map(|x| x.0)),
        (None, Some(acceleration), Some(position)) => {
            Correction::Kalman(ObserverNoise { acceleration: acceleration.0, position: position.0 })
        }
        _ => {
            return Err(fault(
                "it must have either `correction`, or both `acceleration` and `position`",
            ));
        }
    };
    Ok(Law::Observer { feedback, correction })
}

fn control(law: Law, table: LoopTable) -> Result<Control, Fault> {
    let shape = match &*table.law {
        "gaussian" => Jitter::Gaussian(0.0),
        "uniform" => Jitter::Uniform(0.0),
        other => {
            let fault = Fault::new("loop.law", format!("unknown law `{other}`"));
            return Err(fault.help(suggestions::suggest_law(other)));
        }
    };
    let weights = match &table.cost[..] {
        [] => None,
        &[q, v, u] => Some(weights([q, v, u])),
        other => {
            let count = other.len();
            let message = format!("`cost` has {count} weights, but it must be none or three");
            return Err(Fault::new("loop.cost", message));
        }
    };
    let mut control = Control {
        law,
        period: table.period.0,
        latency: table.latency.0,
        jitter: shape.with_rms(table.jitter.0),
        skew: table.skew.0,
        loss: table.loss.0,
        record: None,
        weights,
        deviation: table.deviation.0,
    };
    if !table.time_stamps.is_empty() {
        if control.skew != 0.0 {
            let message = "`skew` is given, but `time_stamps` determine the skew";
            return Err(Fault::new("loop.skew", message));
        }
        let path = &table.time_stamps;
        let wrong =
            |why: String| Fault::new("loop.time_stamps", format!("cannot use `{path}`: {why}"));
        let stamps = read_time_stamps(Path::new(path), &StampOptions::default()).map_err(wrong)?;
        control = control.with_time_stamps(&stamps).map_err(|error| wrong(error.to_string()))?;
    }
    Ok(control)
}

#[cfg(test)]
mod tests {
    use super::super::file_tables::PdTable;
    use super::*;

    #[test]
    fn the_default_file_is_the_default_request_with_a_loop() {
        let request = parse(DEFAULT, "default").unwrap();
        let file = RequestFile {
            controller: Some(ControllerTable::Pd(PdTable {
                position: Number(10.0),
                velocity: Number(2.0),
            })),
            ..RequestFile::default()
        };
        let wanted = Request::try_from(file).unwrap();
        assert_eq!(Request { invocation: wanted.invocation.clone(), ..request }, wanted);
    }

    #[test]
    fn each_key_of_the_command_is_read_and_no_other() {
        for key in ConfigCommand::all_keys() {
            let own = ConfigCommand::ADVISE.keys.contains(&key);
            match parse(&format!("{key} = true"), "mine.toml") {
                Ok(_) => assert!(!own, "{key}"),
                Err(error) => assert!(own && error.message().contains(key), "{error}"),
            }
        }
    }

    #[test]
    fn a_start_is_a_number_or_a_list() {
        let request = |text: &str| parse(text, "mine.toml").unwrap();
        let (number, list) = ("[start]\nq = 0.5\nv = 0", "[start]\nq = [0.5]\nv = [0.0]");
        assert_eq!(request(number), request(list));
        assert_eq!(request(number).system.q, [0.5]);
    }

    #[test]
    fn errors_name_the_file_and_the_value() {
        let error_of = |text: &str| parse(text, "mine.toml").unwrap_err().to_string();
        for (text, wanted) in [
            ("[tolerance]\nenrgy = 1e-3\n", "unknown tolerance `enrgy`"),
            (
                "[tolerance]\nenergy = -1\n",
                "`tolerance` is -1.0, but it must be a finite number above 0",
            ),
            ("[tolerance]\nenergy = 1e-3\nphase = 1\n", "must have exactly one key"),
            ("[request]\nhorizon = nan\n", "`request.horizon` is NaN"),
            ("[controller.pd]\nposition = 1\n", "missing field `velocity`"),
            ("[controller.observer]\ngains = [1, 1]\nposition = 1\n", "either `correction`"),
            ("[controller.observer]\ncorrection = [1, 1]\n", "either `gains` or `weights`"),
            (
                "[controller.pd]\nposition = 1\nvelocity = 1\n[loop]\nlatency = -0.1\n",
                "`loop.latency` is -0.1",
            ),
            (
                "[controller.pd]\nposition = 1\nvelocity = 1\n[loop]\nloss = 1.0\n",
                "`loop.loss` is 1.0",
            ),
            (
                "[controller.pd]\nposition = 1\nvelocity = 1\n[loop]\nlaw = \"cauchy\"\n",
                "unknown law `cauchy`",
            ),
            ("[controller.pd]\nposition = 1\nvelocity = 1\n[loop]\ncost = [1]\n", "has 1 weights"),
            (
                "[controller.pd]\nposition = 1\nvelocity = 1\n[loop]\ntime_stamps = \"no\"\n",
                "cannot use `no`",
            ),
            ("[system.kepler]\n", "the dimension is 1, but it must be 2"),
            ("[start]\nq = [1.0, 2.0]\n", "`q` has 2 numbers and `v` 1"),
            ("[loop]\nlatenzy = 1\n", "unknown key `latenzy`"),
            ("[lop]\n", "did you mean `loop`?"),
            ("[integrater]\n", "did you mean `integrator`, which `rollout` reads?"),
            ("[system.oscillator]\nomga2 = 1\n", "did you mean `omega2`?"),
            ("[system.equations]\nof = 'a.toml'\n", "`--system FILE` without a loop"),
            ("[system.oscillator]\n[system.pendulum]\n", "must be one table"),
        ] {
            let error = error_of(text);
            assert!(error.contains(wanted) && error.contains("mine.toml"), "{wanted}: {error}");
        }
    }
}
