//! Free motion: a trajectory with its reference, its energy, and the eigenvalues of a step.

use libration_core::number::Dual;
use libration_core::{AnyMethod, Method};
use libration_equations::StepProgram;
use libration_linear::{Matrix, eigenvalues};
use num_complex::Complex64;

use crate::growth::{Growth, least_entries};
use crate::subject::{Point, Stepper, Subject, fastest, is_finite};
use crate::{Answer, Setting, SettingError};

/// The operations of programs that a frame has time for.
pub(crate) const WORK: f64 = 6e6;

/// The most points of a curve.
const POINTS: usize = 1500;

/// Steps of the reference in the time in which the fastest mode turns by one radian.
const REFERENCE_STEPS: f64 = 4.0;

/// A spectral radius beyond 1 by less than this is rounding.
const ROUNDING: f64 = 1e-9;

/// The motion of a setting.
pub(crate) fn view(setting: &Setting) -> Result<Answer, SettingError> {
    let subject = Subject::new(setting)?;
    let step = StepProgram::of(setting.integrator, subject.equations.dynamics());
    let work = step.program().operations().max(1) as f64;
    // The trajectory, and twice and four times as many steps for the prediction of the energy.
    let most = (WORK / (7.0 * work)).max(100.0);
    let steps = (setting.horizon / setting.dt).round().clamp(1.0, most) as usize;
    let mut answer = Answer::default();
    answer.text("kind", "motion");
    answer.text("states", subject.names.join(" "));
    answer.number("steps", steps as f64);
    answer.number("horizon", steps as f64 * setting.dt);
    answer.number("evaluations", step.evaluations() as f64 / setting.dt);
    trajectory(&mut answer, &subject, &step, setting.dt, steps);
    let point = subject.calm_point(&[]);
    linear(&mut answer, setting, &subject, &step, &point);
    Ok(answer)
}

/// The trajectory, its reference and the error of its energy.
fn trajectory(answer: &mut Answer, subject: &Subject, step: &StepProgram, dt: f64, steps: usize) {
    let stride = steps.div_ceil(POINTS);
    let inputs = vec![0.0; subject.equations.inputs().len()];
    let states = 2 * subject.degrees();
    let mut recorded = vec![Vec::new(); subject.places.len()];
    let mut time = Vec::new();
    let mut energy_curve = Vec::new();
    let mut energy = subject.energy();
    let first = energy.as_mut().map(|energy| energy(&subject.start));
    let mut largest = 0.0_f64;
    let mut size = 0.0_f64;
    let mut stepper = Stepper::<f64>::new(step, states);
    let mut state = subject.start.clone();
    for k in 0..=steps {
        if !is_finite(&state) {
            break;
        }
        let change = energy.as_mut().zip(first).map(|(energy, first)| {
            let scale = if first == 0.0 { 1.0 } else { first.abs() };
            (energy(&state) - first) / scale
        });
        largest = change.map_or(largest, |change| match change.is_finite() {
            true => largest.max(change.abs()),
            false => f64::NAN,
        });
        size = subject.places.iter().map(|&i| state[i].abs()).fold(size, f64::max);
        if k % stride == 0 {
            time.push(k as f64 * dt);
            recorded.iter_mut().zip(&subject.places).for_each(|(own, &i)| own.push(state[i]));
            energy_curve.extend(change);
        }
        stepper.step(&mut state, &inputs, dt);
    }
    let points = time.len();
    answer.number("size", size);
    answer.column("time", time);
    for (name, column) in subject.names.iter().zip(recorded) {
        answer.column(format!("x.{name}"), column);
    }
    answer.number("energy.largest", first.map(|_| largest));
    let predicted = energy_by_shorter_steps(subject, step, dt, steps).filter(|_| first.is_some());
    answer.number("energy.predicted", predicted);
    answer.column("energy", energy_curve);
    let reference = reference(subject, dt * stride as f64, points);
    for (name, column) in subject.names.iter().zip(reference) {
        answer.column(format!("reference.{name}"), column);
    }
}

/// The largest relative change of the energy, extrapolated from steps half and a quarter as long; none if it is not resolved.
fn energy_by_shorter_steps(
    subject: &Subject,
    step: &StepProgram,
    dt: f64,
    steps: usize,
) -> Option<f64> {
    let [half, quarter] =
        [2, 4].map(|parts| largest_energy_change(subject, step, dt, steps, parts));
    let (half, quarter) = (half?, quarter?);
    let ratio = half / quarter;
    (half.is_finite() && ratio.is_finite() && quarter > 1e-13 && ratio > 1.0)
        .then_some(half * ratio)
}

fn largest_energy_change(
    subject: &Subject,
    step: &StepProgram,
    dt: f64,
    steps: usize,
    parts: usize,
) -> Option<f64> {
    let mut energy = subject.energy()?;
    let inputs = vec![0.0; subject.equations.inputs().len()];
    let mut stepper = Stepper::<f64>::new(step, 2 * subject.degrees());
    let mut state = subject.start.clone();
    let first = energy(&state);
    let scale = if first == 0.0 { 1.0 } else { first.abs() };
    let mut largest = 0.0_f64;
    for _ in 0..steps {
        (0..parts).for_each(|_| stepper.step(&mut state, &inputs, dt / parts as f64));
        let change = ((energy(&state) - first) / scale).abs();
        if !change.is_finite() {
            return None;
        }
        largest = largest.max(change);
    }
    Some(largest)
}

/// The motion in short steps of order 8, at `points` times `interval` seconds apart; empty where it takes too many of them.
fn reference(subject: &Subject, interval: f64, points: usize) -> Vec<Vec<f64>> {
    let Some(method) = Method::from_name("dormand-prince-8") else { return Vec::new() };
    let step = StepProgram::of(AnyMethod::Explicit(method), subject.equations.dynamics());
    let inputs = vec![0.0; subject.equations.inputs().len()];
    let rate = subject.fastest_rate();
    let parts = (interval * rate * REFERENCE_STEPS).ceil().max(1.0);
    let work = parts * points as f64 * step.program().operations() as f64;
    if !rate.is_finite() || work > WORK {
        return Vec::new();
    }
    let mut stepper = Stepper::<f64>::new(&step, 2 * subject.degrees());
    let mut state = subject.start.clone();
    let mut recorded = vec![Vec::new(); subject.places.len()];
    for _ in 0..points {
        recorded.iter_mut().zip(&subject.places).for_each(|(own, &i)| own.push(state[i]));
        (0..parts as usize).for_each(|_| stepper.step(&mut state, &inputs, interval / parts));
    }
    recorded
}

/// The derivative of a step at a point by the states.
pub(crate) fn step_matrix(subject: &Subject, step: &StepProgram, point: &Point, dt: f64) -> Matrix {
    let n = subject.places.len();
    let mut stepper = Stepper::<Dual<f64>>::new(step, 2 * subject.degrees());
    let inputs: Vec<Dual<f64>> = point.inputs.iter().map(|&u| Dual::constant(u)).collect();
    let mut matrix = Matrix::zeros(n, n);
    for (j, &place) in subject.places.iter().enumerate() {
        let mut state: Vec<Dual<f64>> = point.state.iter().map(|&x| Dual::constant(x)).collect();
        state[place] = Dual::variable(point.state[place]);
        stepper.step(&mut state, &inputs, dt);
        for (i, &place) in subject.places.iter().enumerate() {
            matrix[(i, j)] = state[place].du;
        }
    }
    matrix
}

/// The spectral radius; none of a matrix whose eigenvalues are not found.
pub(crate) fn radius(matrix: &Matrix) -> Option<f64> {
    let values = eigenvalues(matrix)?;
    values.iter().map(|value| value.norm()).reduce(f64::max)
}

/// Eigenvalues, and the growth of small deviations.
fn linear(
    answer: &mut Answer,
    setting: &Setting,
    subject: &Subject,
    step: &StepProgram,
    point: &Point,
) {
    let matrix = step_matrix(subject, step, point, setting.dt);
    let own = eigenvalues(&matrix).unwrap_or_default();
    let exact = eigenvalues(&subject.slopes(point)).unwrap_or_default();
    complex(answer, "eigenvalues", &own);
    let after = |value: &Complex64| (value * setting.dt).exp();
    complex(answer, "exact", &exact.iter().map(after).collect::<Vec<_>>());
    answer.text("point", subject.describe(point));
    answer.number("growth.predicted", radius(&matrix).map(|radius| radius.ln() / setting.dt));
    let measured = if point.rests {
        let most = (WORK / 4.0 / step.program().operations().max(1) as f64) as usize;
        measured_growth(subject, step, point, setting.dt, [most.min(4000), least_entries(&own)])
    } else {
        None
    };
    answer.number("growth.measured", measured);
    answer.number("growth.exact", exact.iter().map(|value| value.re).reduce(f64::max));
}

/// Real and imaginary parts.
pub(crate) fn complex(answer: &mut Answer, name: &str, values: &[Complex64]) {
    answer.column(format!("{name}.re"), values.iter().map(|value| value.re).collect());
    answer.column(format!("{name}.im"), values.iter().map(|value| value.im).collect());
}

/// The rate in 1/s at which a small deviation from a point grows, from steps of the system itself.
fn measured_growth(
    subject: &Subject,
    step: &StepProgram,
    point: &Point,
    dt: f64,
    [steps, least]: [usize; 2],
) -> Option<f64> {
    let mut stepper = Stepper::<f64>::new(step, 2 * subject.degrees());
    let mut growth = Growth::new(subject.scale(point));
    let mut state = point.state.clone();
    subject.places.iter().for_each(|&place| state[place] += growth.small);
    for _ in 0..steps {
        stepper.step(&mut state, &point.inputs, dt);
        let square = |&i: &usize| (state[i] - point.state[i]).powi(2);
        let Some(factor) = growth.push(subject.places.iter().map(square).sum()) else { break };
        if factor != 1.0 {
            let places = subject.places.iter();
            places.for_each(|&i| state[i] = point.state[i] + factor * (state[i] - point.state[i]));
        }
    }
    growth.rate(least).map(|rate| rate / dt)
}

/// The largest stable time step: where deviations first grow though those of the exact motion do not, on a grid of steps that are
/// longer by 3 % each; none if no step is unstable up to 100 radians of the fastest mode.
pub(crate) fn largest_stable_step(
    subject: &Subject,
    step: &StepProgram,
    point: &Point,
) -> Option<f64> {
    let rate = fastest(&subject.slopes(point));
    let is_stable = |dt: f64| {
        radius(&step_matrix(subject, step, point, dt))
            .is_some_and(|radius| radius <= 1.0 + ROUNDING)
    };
    let mut below = 0.0;
    let mut dt = 1e-3 / rate;
    while dt.is_finite() && dt < 100.0 / rate {
        if !is_stable(dt) {
            let (mut low, mut high) = (below, dt);
            for _ in 0..if below > 0.0 { 50 } else { 0 } {
                let middle = 0.5 * (low + high);
                if is_stable(middle) { low = middle } else { high = middle }
            }
            return Some(low);
        }
        below = dt;
        dt *= 1.03;
    }
    None
}
