//! A loop around the system itself, stepped by an integrator, beside the theory of the loop around its linear plant.

use std::collections::VecDeque;

use libration_core::Elementary;
use libration_core::control::{Jitter, Latency};
use libration_core::number::Dual;
use libration_core::random::{Address, Purpose};
use libration_equations::StepProgram;
use libration_linear::{DiscreteController, LinearLoop, LoopTiming, Matrix};

use crate::SettingError;
use crate::setting::Control;
use crate::subject::{Point, Stepper, Subject, is_finite};

/// The longest latency, in periods.
pub(crate) const MOST_LATENCY: u64 = 64;

/// The most steps in a period.
const MOST_STEPS: f64 = 2000.0;

/// The most points of a curve.
const POINTS: usize = 3000;

/// The loop of a setting.
pub(crate) struct ControlLoop<'a> {
    pub(crate) subject: &'a Subject,
    pub(crate) point: Point,
    pub(crate) control: Control,
    /// Rows: inputs. Columns: states.
    pub(crate) gain: Matrix,
    latency: Latency,
    dt: f64,
    pub(crate) linear: LinearLoop,
}

/// A loop at the beginning of a period.
pub(crate) struct LoopState<S> {
    /// Positions and velocities.
    pub(crate) state: Vec<S>,
    /// The latest command first.
    pub(crate) commands: VecDeque<Vec<S>>,
    pub(crate) acting: Vec<S>,
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
        // A slow clock has fewer periods per second.
        let mean_period = control.period * (1.0 + control.skew);
        let latency = Latency::of_seconds(control.latency, mean_period)
            .filter(|latency| latency.steps() <= MOST_LATENCY as f64)
            .ok_or_else(|| {
                let most = MOST_LATENCY as f64 * mean_period;
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
        let own =
            ControlLoop { subject, point, control: control.clone(), gain, latency, dt, linear };
        let steps: f64 = own.steps().iter().sum();
        if steps > MOST_STEPS {
            let why = format!(
                "dt = {dt} s: {steps:.0} steps in a period; expected at most {MOST_STEPS} in a page"
            );
            return Err(refused(why));
        }
        Ok(own)
    }

    /// The timing of the setting.
    pub(crate) fn timing(&self) -> LoopTiming {
        LoopTiming {
            input_latency: vec![self.latency; self.gain.rows()],
            jitter: Jitter::Gaussian(self.control.jitter),
            skew: self.control.skew,
            loss: self.control.loss,
            ..self.linear.ideal()
        }
    }

    /// The mean length of a period, in s.
    pub(crate) fn mean_period(&self) -> f64 {
        self.control.period * (1.0 + self.control.skew)
    }

    /// The rate in 1/s at which the root of the mean square of deviations grows: exact for the linear plant.
    pub(crate) fn exact_growth(&self) -> Option<f64> {
        let growth = self.linear.growth(&self.timing()).ok()?;
        Some(0.5 * growth / self.mean_period())
    }

    /// The same loop with perfect timing.
    pub(crate) fn ideal(&self) -> Self {
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
    pub(crate) fn begin<S: Elementary>(&self, state: &[f64]) -> LoopState<S> {
        let number = |x: &f64| S::from_f64(*x);
        let acting: Vec<S> = self.point.inputs.iter().map(number).collect();
        LoopState {
            state: state.iter().map(number).collect(),
            commands: vec![acting.clone(); self.latency.whole() as usize].into(),
            acting,
        }
    }

    /// Period `k` of loop `number`: its length in s, and whether its command is lost.
    pub(crate) fn period(&self, number: u64, k: u64) -> (f64, bool) {
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
    pub(crate) fn advance<S: Elementary>(
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
        let [before, behind] = self.steps();
        let part = self.latency.part();
        let mut time = 0.0;
        let mut move_by = |own: &mut LoopState<S>, span: f64, steps: f64| {
            let dt = span / steps;
            for _ in 0..steps as u64 {
                stepper.step(&mut own.state, &own.acting, dt);
                time += dt;
                each(time, own);
            }
        };
        move_by(own, part * seconds, before);
        if !lost {
            own.acting = arriving;
        }
        move_by(own, (1.0 - part) * seconds, behind);
    }

    /// The steps in a period before and behind the arrival of a command: even numbers, as in `simulate`, of at most the time step in the
    /// longest period.
    pub(crate) fn steps(&self) -> [f64; 2] {
        // The largest normal number is below 8.58.
        let longest = 1.0 + 8.58 * self.control.jitter;
        let steps = self.mean_period() * longest / self.dt;
        let part = self.latency.part();
        let even = |share: f64| 2.0 * (0.5 * steps * share).ceil().max(1.0);
        [if part == 0.0 { 0.0 } else { even(part) }, even(1.0 - part)]
    }

    /// The matrix of a period of mean length as the integrator steps it: on the states, the acting commands and those in transit.
    pub(crate) fn period_matrix(&self, step: &StepProgram) -> Matrix {
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
    pub(crate) fn work(&self, step: &StepProgram) -> f64 {
        self.steps().iter().sum::<f64>() * step.program().operations().max(1) as f64
    }

    /// The states and commands of loop 0 after each step, at most so many periods.
    pub(crate) fn record(&self, step: &StepProgram, periods: usize) -> [Vec<Vec<f64>>; 2] {
        let mut stepper = Stepper::<f64>::new(step, 2 * self.subject.degrees());
        let mut own = self.begin::<f64>(&self.subject.start);
        let steps = periods as f64 * self.steps().iter().sum::<f64>();
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
