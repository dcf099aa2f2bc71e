//! Requests of a page.

use libration_core::AnyMethod;
use libration_equations::StepProgram;

use crate::stability_map::MapAxis;
use crate::subject::{Subject, fastest};
use crate::{Answer, Setting, SettingError, loop_view, map_row, motion};

/// The answer to a request, whose first line has its kind: `view`, `limits`, `design` for the gains of a linear-quadratic regulator with
/// weights of 1, `map KEY VALUE,… KEY VALUE` for a row of a map of stability, or `methods` for the names of all integrators. A
/// [`Setting`] follows. The text `error` of an answer says what is wrong with a request.
pub fn answer(request: &str) -> Answer {
    let (kind, setting) = request.split_once('\n').unwrap_or((request, ""));
    read(kind, setting).unwrap_or_else(|error| {
        let mut answer = Answer::default();
        answer.text("error", error.to_string());
        answer
    })
}

fn read(kind: &str, setting: &str) -> Result<Answer, SettingError> {
    if kind == "methods" {
        return Ok(methods());
    }
    let setting: Setting = setting.parse()?;
    let words: Vec<&str> = kind.split(' ').collect();
    match (words.as_slice(), &setting.control) {
        (["view"], None) => motion::view(&setting),
        (["view"], Some(control)) => loop_view::view(&setting, control),
        (["design"], Some(control)) => loop_view::design(&setting, control),
        (["limits"], None) => limits(&setting),
        (["limits"], Some(control)) => loop_view::limits(&setting, control),
        (["map", x, values, y, value], _) => {
            let number = |text: &str| {
                text.parse().map_err(|_| SettingError::Value {
                    key: "map".into(),
                    value: text.into(),
                    expected: "a number",
                })
            };
            let values = values.split(',').map(number).collect::<Result<_, _>>()?;
            map_row(&setting, &MapAxis { key: (*x).into(), values }, (y, number(value)?))
        }
        _ => Err(SettingError::Key(kind.to_owned())),
    }
}

/// The names of all integrators, those with code of their own first.
fn methods() -> Answer {
    let mut answer = Answer::default();
    let names: Vec<&str> =
        AnyMethod::all().chain(AnyMethod::tables()).map(AnyMethod::name).collect();
    answer.text("methods", names.join(" "));
    answer
}

/// The limits of free motion.
fn limits(setting: &Setting) -> Result<Answer, SettingError> {
    let subject = Subject::new(setting)?;
    let step = StepProgram::of(setting.integrator, subject.equations.dynamics());
    let point = subject.calm_point(&[]);
    let mut answer = Answer::default();
    // Without a linear force no step is long.
    let has_rate = point.rests && fastest(&subject.slopes(&point)) * setting.horizon > 1e-6;
    let largest = has_rate.then(|| motion::largest_stable_step(&subject, &step, &point));
    answer.number("dt.stable", largest.map(|largest| largest.unwrap_or(f64::INFINITY)));
    Ok(answer)
}
