//! A loop around the system itself, stepped by an integrator, beside the theory of the loop around its linear plant.

use std::collections::VecDeque;

use libration_core::Elementary;
use libration_core::control::{Jitter, Latency};
use libration_core::number::Dual;
use libration_core::random::{Address, Purpose};
use libration_equations::StepProgram;
use libration_linear::{
    Channels, CostWeights, DiscreteController, LinearLoop, LoopTiming, Matrix, eigenvalues,
};

use crate::growth::Growth;
use crate::motion::{WORK, complex, radius};
use crate::setting::Control;
use crate::subject::{Point, Stepper, Subject, is_finite};
use crate::{Answer, Setting, SettingError};

/// The longest latency, in periods.
const MOST_LATENCY: u64 = 64;

/// Groups of loops, each with a mean square of its own, where periods or losses are random.
const GROUPS: u64 = 8;

/// Loops in a group.
const LOOPS: u64 = 16;

/// The most points of a curve.
const POINTS: usize = 3000;

/// The loop of a setting.
pub(crate) struct ControlLoop<'a> {
    subject: &'a Subject,
    point: Point,
    control: Control,
    /// Rows: inputs. Columns: states.
    gain: Matrix,
    latency: Latency,
    dt: f64,
    linear: LinearLoop,
}

/// A loop at the beginning of a period.
struct LoopState<S> {
    /// Positions and velocities.
    state: Vec<S>,
    /// The latest command first.
    commands: VecDeque<Vec<S>>,
    acting: Vec<S>,
}

impl<'a> ControlLoop<'a> {
    pub(crate) fn new(
        subject: &'a Subject,
        point: Point,
        control: &Control,
        dt: f64,
    ) -> Result<Self, SettingError> {
        let (n, m) = (subject.places.len(), subject.equations.inputs().len());
        let refused = |why: String| SettingError::Subject(why);
        if m == 0 {
            let why = "the system has no input; expected `inputs` for the commands of a loop";
            return Err(refused(why.into()));
        }
        if !point.rests {
            let why = "no equilibrium found; expected one near the start, at which the loop holds the system";
            return Err(refused(why.into()));
        }
        let shape = [control.gain.len(), control.gain.first().map_or(0, Vec::len)];
        let gain = Matrix::from_rows(&control.gain).filter(|_| shape == [m, n]);
        let gain = gain.ok_or_else(|| {
            let [rows, columns] = shape;
            refused(format!("gain = {rows} × {columns}; expected {m} × {n}, inputs × states"))
        })?;
        let gain = gain.scaled(control.gain_factor);
        let latency = Latency::of_seconds(control.latency, control.period)
            .filter(|latency| latency.steps() <= MOST_LATENCY as f64)
            .ok_or_else(|| {
                let most = MOST_LATENCY as f64 * control.period;
                let given = control.latency;
                refused(format!(
                    "latency = {given} s; expected at most {MOST_LATENCY} periods, {most} s"
                ))
            })?;
        let controller = DiscreteController::gain(gain.scaled(-1.0));
        let cost = Matrix::from_fn(n + m, n + m, |i, j| f64::from(u8::from(i == j && i < n)));
        let linear =
            LinearLoop::new(subject.plant(&point)?, controller, control.period, cost, vec![0.0; n])
                .map_err(|error| refused(error.to_string()))?;
        Ok(ControlLoop { subject, point, control: control.clone(), gain, latency, dt, linear })
    }

    /// The timing of the setting.
    fn timing(&self) -> LoopTiming {
        LoopTiming {
            input_latency: vec![self.latency; self.gain.rows()],
            jitter: Jitter::Gaussian(self.control.jitter),
            skew: self.control.skew,
            loss: self.control.loss,
            ..self.linear.ideal()
        }
    }

    /// The mean length of a period, in s.
    fn mean_period(&self) -> f64 {
        self.control.period * (1.0 + self.control.skew)
    }

    /// The rate in 1/s at which the root of the mean square of deviations grows: exact for the linear plant.
    pub(crate) fn exact_growth(&self) -> Option<f64> {
        let growth = self.linear.growth(&self.timing()).ok()?;
        Some(0.5 * growth / self.mean_period())
    }

    /// The same loop with perfect timing.
    fn ideal(&self) -> Self {
        let control =
            Control { latency: 0.0, jitter: 0.0, skew: 0.0, loss: 0.0, ..self.control.clone() };
        let point = Point {
            state: self.point.state.clone(),
            inputs: self.point.inputs.clone(),
            rests: true,
        };
        ControlLoop {
            control,
            point,
            gain: self.gain.clone(),
            latency: Latency::NONE,
            linear: self.linear.clone(),
            ..*self
        }
    }

    /// A loop whose commands hold the equilibrium until others arrive.
    fn begin<S: Elementary>(&self, state: &[f64]) -> LoopState<S> {
        let number = |x: &f64| S::from_f64(*x);
        let acting: Vec<S> = self.point.inputs.iter().map(number).collect();
        LoopState {
            state: state.iter().map(number).collect(),
            commands: vec![acting.clone(); self.latency.whole() as usize].into(),
            acting,
        }
    }

    /// Period `k` of loop `number`: its length in s, and whether its command is lost.
    fn period(&self, number: u64, k: u64) -> (f64, bool) {
        let Control { jitter, loss, seed, .. } = self.control;
        let address = |purpose| Address { seed, trajectory: number, step: k, purpose };
        let longer = match jitter {
            0.0 => 1.0,
            rms => (1.0 + rms * address(Purpose::StepTime).gaussian()[0]).max(0.0),
        };
        let lost = loss > 0.0 && address(Purpose::Latency).uniform()[0] < loss;
        (self.mean_period() * longer, lost)
    }

    /// Moves a loop by a period of so many seconds, and shows it with the time since the beginning of the period after each step.
    fn advance<S: Elementary>(
        &self,
        stepper: &mut Stepper<'_, S>,
        own: &mut LoopState<S>,
        (seconds, lost): (f64, bool),
        mut each: impl FnMut(f64, &LoopState<S>),
    ) {
        let command: Vec<S> = (0..self.gain.rows())
            .map(|i| {
                let mut sum = S::from_f64(self.point.inputs[i]);
                for (j, &place) in self.subject.places.iter().enumerate() {
                    let off = own.state[place] - S::from_f64(self.point.state[place]);
                    sum = sum - S::from_f64(self.gain[(i, j)]) * off;
                }
                sum
            })
            .collect();
        own.commands.push_front(command);
        let arriving = own.commands.pop_back().unwrap_or_default();
        let before = self.latency.part() * seconds;
        let mut time = 0.0;
        let mut move_by = |own: &mut LoopState<S>, span: f64, time: &mut f64| {
            let steps = (span / self.dt - 1e-9).ceil().max(1.0);
            let dt = span / steps;
            for _ in 0..if span > 0.0 { steps as usize } else { 0 } {
                stepper.step(&mut own.state, &own.acting, dt);
                *time += dt;
                each(*time, own);
            }
        };
        move_by(own, before, &mut time);
        if !lost {
            own.acting = arriving;
        }
        move_by(own, seconds - before, &mut time);
    }

    /// The matrix of a period of mean length as the integrator steps it: on the states, the acting commands and those in transit.
    fn period_matrix(&self, step: &StepProgram) -> Matrix {
        let (n, m, whole) =
            (self.subject.places.len(), self.gain.rows(), self.latency.whole() as usize);
        let size = n + m * (1 + whole);
        let mut matrix = Matrix::zeros(size, size);
        let mut stepper = Stepper::<Dual<f64>>::new(step, 2 * self.subject.degrees());
        fn entry<'l>(
            own: &'l mut LoopState<Dual<f64>>,
            places: &[usize],
            m: usize,
            i: usize,
        ) -> &'l mut Dual<f64> {
            match i.checked_sub(places.len()) {
                None => &mut own.state[places[i]],
                Some(i) if i < m => &mut own.acting[i],
                Some(i) => &mut own.commands[i / m - 1][i % m],
            }
        }
        for j in 0..size {
            let mut own = self.begin::<Dual<f64>>(&self.point.state);
            let varied = entry(&mut own, &self.subject.places, m, j);
            *varied = Dual::variable(varied.re);
            self.advance(&mut stepper, &mut own, (self.mean_period(), false), |_, _| {});
            for i in 0..size {
                matrix[(i, j)] = entry(&mut own, &self.subject.places, m, i).du;
            }
        }
        matrix
    }

    /// Operations of the programs in a period.
    fn work(&self, step: &StepProgram) -> f64 {
        let steps = (self.control.period / self.dt).ceil() + 1.0;
        steps * step.program().operations().max(1) as f64
    }

    /// The rate in 1/s at which the root of the mean square of small deviations grows, measured, and the standard error of this number.
    fn measured_growth(&self, step: &StepProgram) -> Option<[f64; 2]> {
        if self.control.jitter == 0.0 && self.control.loss == 0.0 {
            return Some([self.growth_of_loops(step, 0..1, false)?, 0.0]);
        }
        let group = |k| self.growth_of_loops(step, k * LOOPS..(k + 1) * LOOPS, true);
        let rates: Vec<f64> = (0..GROUPS).map(group).collect::<Option<_>>()?;
        let count = GROUPS as f64;
        let mean = rates.iter().sum::<f64>() / count;
        let squares: f64 = rates.iter().map(|rate| (rate - mean).powi(2)).sum();
        Some([mean, (squares / (count * (count - 1.0))).sqrt()])
    }

    /// That of the loops with these numbers.
    fn growth_of_loops(
        &self,
        step: &StepProgram,
        numbers: core::ops::Range<u64>,
        random: bool,
    ) -> Option<f64> {
        let loops = if random { LOOPS * GROUPS } else { 1 };
        let periods = (WORK / loops as f64 / self.work(step)).clamp(40.0, 2000.0) as u64;
        let scale = self.subject.scale(&self.point);
        let mut growth = if random { Growth::of_one_range(scale) } else { Growth::new(scale) };
        let mut start = self.point.state.clone();
        self.subject.places.iter().for_each(|&place| start[place] += growth.small);
        let mut stepper = Stepper::<f64>::new(step, 2 * self.subject.degrees());
        let mut all: Vec<(u64, LoopState<f64>)> =
            numbers.map(|number| (number, self.begin(&start))).collect();
        for k in 0..periods {
            let mut sum = 0.0;
            for (number, own) in &mut all {
                self.advance(&mut stepper, own, self.period(*number, k), |_, _| {});
                let off = |&i: &usize| (own.state[i] - self.point.state[i]).powi(2);
                sum += self.subject.places.iter().map(off).sum::<f64>();
            }
            let Some(factor) = growth.push(sum / all.len() as f64) else { break };
            if factor != 1.0 {
                // Over long times the mean square of few loops is that of one of them.
                if random {
                    break;
                }
                all.iter_mut().for_each(|(_, own)| self.scale(own, factor));
            }
        }
        growth.rate().map(|rate| rate / self.mean_period())
    }

    /// Multiplies all deviations from the equilibrium and the commands that hold it.
    fn scale(&self, own: &mut LoopState<f64>, factor: f64) {
        let scale = |x: &mut f64, rest: f64| *x = rest + factor * (*x - rest);
        for &place in &self.subject.places {
            scale(&mut own.state[place], self.point.state[place]);
        }
        for command in own.commands.iter_mut().chain([&mut own.acting]) {
            command.iter_mut().zip(&self.point.inputs).for_each(|(u, rest)| scale(u, *rest));
        }
    }

    /// The states and commands of loop 0 after each step, at most so many periods.
    fn record(&self, step: &StepProgram, periods: usize) -> [Vec<Vec<f64>>; 2] {
        let mut stepper = Stepper::<f64>::new(step, 2 * self.subject.degrees());
        let mut own = self.begin::<f64>(&self.subject.start);
        let steps = periods as f64 * (self.control.period / self.dt).max(1.0);
        let stride = (steps / POINTS as f64).ceil().max(1.0) as usize;
        let row = |time: f64, own: &LoopState<f64>| {
            let states = self.subject.places.iter().map(|&i| own.state[i]);
            core::iter::once(time).chain(states).collect::<Vec<f64>>()
        };
        let mut rows = vec![row(0.0, &own)];
        let mut commands = vec![own.acting.clone()];
        let (mut begun, mut count) = (0.0, 0);
        for k in 0..periods {
            let period = self.period(0, k as u64);
            self.advance(&mut stepper, &mut own, period, |time, own| {
                count += 1;
                if count % stride == 0 {
                    rows.push(row(begun + time, own));
                    commands.push(own.acting.clone());
                }
            });
            begun += period.0;
            if !is_finite(&own.state) {
                break;
            }
        }
        [rows, commands]
    }
}

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
    let parts = (control.period / setting.dt - 1e-9).ceil().max(1.0);
    answer.number("evaluations", parts * step.evaluations() as f64 / control.period);
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
    answer.text("point", "equilibrium");
    // What the steps of the integrator change, in a period of mean length, is added to the growth of the exact loop.
    let shift = radius(&matrix).zip(exact.as_ref().and_then(radius));
    let shift = shift.map(|(stepped, exact)| (stepped / exact).ln() / own.mean_period());
    let exact_growth = own.exact_growth();
    let predicted = exact_growth.zip(shift).map(|(growth, shift)| growth + shift);
    answer.number("growth.predicted", predicted);
    let measured = own.measured_growth(&step);
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
    let first = windows.ok().and_then(|windows| windows.into_iter().next());
    let largest = match first {
        Some(window) if window.from == 0.0 => window.to.unwrap_or(f64::INFINITY),
        _ => 0.0,
    };
    answer.number("latency.stable", largest * own.mean_period());
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
