//! A loop as a page shows it: its curves, its growth, and its limits.

use libration_equations::StepProgram;
use libration_linear::{Channels, CostWeights, LatencyWindow, LoopTiming, Matrix, eigenvalues};

use crate::control_loop::{ControlLoop, MOST_LATENCY};
use crate::growth::least_entries;
use crate::motion::{WORK, complex, radius};
use crate::setting::Control;
use crate::subject::Subject;
use crate::{Answer, Setting, SettingError};

/// The loop of a setting.
pub(crate) fn view(setting: &Setting, control: &Control) -> Result<Answer, SettingError> {
    let subject = Subject::new(setting)?;
    let step = StepProgram::of(setting.integrator, subject.equations.dynamics());
    let own = ControlLoop::new(&subject, subject.point(&[]), control, setting.dt)?;
    let most = (WORK / 2.0 / own.work(&step)).max(20.0);
    let periods = (setting.horizon / control.period).round().clamp(1.0, most) as usize;
    let mut answer = Answer::default();
    answer.text("kind", "loop");
    answer.text("states", subject.names.join(" "));
    answer.text("inputs", subject.equations.inputs().join(" "));
    answer.number("periods", periods as f64);
    answer.number("horizon", periods as f64 * own.mean_period());
    let steps: f64 = own.steps().iter().sum();
    answer.number("evaluations", steps * step.evaluations() as f64 / own.mean_period());
    let ideal = own.ideal();
    for (of, own) in [("", &own), ("ideal.", &ideal)] {
        let [rows, commands] = own.record(&step, periods);
        answer.column(format!("{of}time"), rows.iter().map(|row| row[0]).collect());
        for (i, name) in subject.names.iter().enumerate() {
            let column = rows.iter().map(|row| row[i + 1]).collect();
            answer.column(format!("{of}x.{name}"), column);
        }
        for (i, name) in subject.equations.inputs().iter().enumerate() {
            let column = commands.iter().map(|command| command[i]).collect();
            answer.column(format!("{of}command.{name}"), column);
        }
    }
    let matrix = own.period_matrix(&step);
    complex(&mut answer, "eigenvalues", &eigenvalues(&matrix).unwrap_or_default());
    let exact = own.linear.period_matrix(&own.timing()).ok();
    let of_exact = exact.as_ref().and_then(eigenvalues).unwrap_or_default();
    complex(&mut answer, "exact", &of_exact);
    answer.text("point", subject.describe(&own.point));
    answer.number("steps", own.steps().iter().sum::<f64>());
    // What the steps of the integrator change, in a period of mean length, is added to the growth of the exact loop.
    let shift = radius(&matrix).zip(exact.as_ref().and_then(radius));
    let shift = shift.map(|(stepped, exact)| (stepped / exact).ln() / own.mean_period());
    let exact_growth = own.exact_growth();
    let predicted = exact_growth.zip(shift).map(|(growth, shift)| growth + shift);
    answer.number("growth.predicted", predicted);
    let least = least_entries(&eigenvalues(&matrix).unwrap_or_default());
    let measured = own.measured_growth(&step, least);
    answer.number("growth.measured", measured.map(|[rate, _]| rate));
    answer.number("growth.error", measured.map(|[_, error]| error));
    answer.number("growth.exact", exact_growth);
    answer.number("growth.ideal", ideal.exact_growth());
    Ok(answer)
}

/// The limits of a loop, which take longer than a frame.
pub(crate) fn limits(setting: &Setting, control: &Control) -> Result<Answer, SettingError> {
    let subject = Subject::new(setting)?;
    let own = ControlLoop::new(&subject, subject.point(&[]), control, setting.dt)?;
    let mut answer = Answer::default();
    let none = LoopTiming { input_latency: own.linear.ideal().input_latency, ..own.timing() };
    let channels = Channels::Inputs((0..own.gain.rows()).collect());
    let windows = own.linear.latency_windows(&none, &channels, [MOST_LATENCY as f64; 2]);
    let seconds = |periods: f64| periods * own.mean_period();
    let windows = windows.map(|windows| {
        let pair = |window: &LatencyWindow| {
            [seconds(window.from), window.to.map_or(f64::INFINITY, seconds)]
        };
        windows.iter().map(pair).collect()
    });
    // No window says that no latency is stable; NaN, that nothing is known.
    let windows: Vec<[f64; 2]> = windows.unwrap_or_else(|_| vec![[f64::NAN; 2]]);
    for (i, name) in ["latency.from", "latency.to"].into_iter().enumerate() {
        answer.column(name, windows.iter().map(|window| window[i]).collect());
    }
    answer.number("latency.tried", MOST_LATENCY as f64 * own.mean_period());
    let cost = |timing: &LoopTiming| own.linear.stationary(timing).ok().flatten();
    let rise = cost(&own.timing()).zip(cost(&own.linear.ideal()));
    let rise = rise.map(|(own, ideal)| own.cost / ideal.cost - 1.0);
    answer.number("cost.rise", rise);
    Ok(answer)
}

/// The gain of the linear-quadratic regulator with weights of 1, row by row.
pub(crate) fn design(setting: &Setting, control: &Control) -> Result<Answer, SettingError> {
    let subject = Subject::new(setting)?;
    let point = subject.point(&[]);
    let plant = subject.plant(&point)?;
    let weights = CostWeights {
        states: Matrix::identity(plant.states.len()),
        inputs: Matrix::identity(plant.inputs.len()),
    };
    let regulator = plant.design_regulator(&weights, control.period);
    let regulator = regulator.map_err(|error| SettingError::Subject(error.to_string()))?;
    let mut answer = Answer::default();
    answer.column("gain", regulator.gain.entries().to_vec());
    Ok(answer)
}
