//! Loops and independent simulations of them.

use std::collections::VecDeque;

use libration::analysis::{Imperfections, Plant};
use libration::catalog::Actuation;
use libration::control::controller::StateFeedback;
use libration::control::{Controller, Feedback, Jitter, Latency, LqrWeights};
use libration::random::{Address, Purpose};
use libration::system::Oscillator;
use libration::{AnySystem, State};
use libration_advise::{Control, Imperfection, Law, Measure, Request, Tolerance};
use libration_settings::equations::EquationSystem;

/// A system of the catalogue under accelerations, from its start.
pub(crate) fn at_start(system: AnySystem, q: &[f64], v: &[f64]) -> EquationSystem {
    EquationSystem::of_catalogue((system, Actuation::Acceleration), Some(q), Some(v)).unwrap()
}

/// A number from `low` to `high`.
pub(crate) fn drawn(step: u64, low: f64, high: f64) -> f64 {
    let [u, _] = Address { seed: 3, trajectory: 0, step, purpose: Purpose::Variation }.uniform();
    low + (high - low) * u
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) omega2: f64,
    pub(crate) gains: Feedback,
    pub(crate) period: f64,
}

impl Case {
    pub(crate) fn request(self) -> Request {
        let oscillator = AnySystem::Oscillator(Oscillator { omega2: self.omega2 });
        let tolerance = Tolerance { of: Measure::Trajectory, most: 1e-3 };
        Request {
            control: Some(Control {
                law: Law::Pd(self.gains),
                period: self.period,
                latency: 0.0,
                jitter: Jitter::Uniform(0.0),
                skew: 0.0,
                loss: 0.0,
                record: None,
                weights: None,
                deviation: 0.1,
            }),
            rollout: [64, 64],
            ..Request::new(at_start(oscillator, &[0.0], &[0.0]), tolerance, 5.0)
        }
    }

    /// The state after `dt` seconds under a command, in closed form.
    fn moved(
        self,
        State { q: [q], v: [v] }: State<f64, 1>,
        command: f64,
        dt: f64,
    ) -> State<f64, 1> {
        let rate = self.omega2.sqrt();
        let (sine, cosine) = (rate * dt).sin_cos();
        let rest = command / self.omega2;
        let q0 = q - rest;
        State { q: [rest + q0 * cosine + v / rate * sine], v: [v * cosine - q0 * rate * sine] }
    }

    /// By how much `ln |y|` of a simulated loop changes in a period, between two long windows.
    pub(crate) fn growth(
        self,
        controller: impl Controller<f64, 1>,
        latency: f64,
        skew: f64,
    ) -> f64 {
        self.growth_by(controller, &[1.0 + skew], latency)
    }

    /// The same with periods of these lengths in turn.
    ///
    /// By a plain loop, which has nothing of the kernels of the engine.
    pub(crate) fn growth_by(
        self,
        controller: impl Controller<f64, 1>,
        lengths: &[f64],
        latency: f64,
    ) -> f64 {
        const PERIODS: usize = 6_000;
        let (whole, part) =
            ((latency / self.period).trunc() as usize, (latency / self.period).fract());
        let mut waiting: VecDeque<f64> = std::iter::repeat_n(0.0, whole).collect();
        let mut state = State { q: [1.0], v: [0.3] };
        let (mut memory, mut held) = (controller.start(&state), 0.0);
        let mut lengths = lengths.iter().cycle();
        let mut step = || {
            let dt = self.period * lengths.next().unwrap();
            let [command] = controller.command(&mut memory, &state, self.period);
            waiting.push_back(command);
            state = self.moved(state, held, part * dt);
            held = waiting.pop_front().unwrap();
            state = self.moved(state, held, (1.0 - part) * dt);
            let State { q: [q], v: [v] } = state;
            (self.omega2.max(1.0) * q * q + v * v).ln() / 2.0
        };
        let mut means = [0.0; 2];
        for _ in 0..PERIODS / 4 {
            step();
        }
        for mean in &mut means {
            for _ in 0..PERIODS {
                let size = step();
                // Beyond the floats it is plain what it does.
                if !size.is_finite() || size.abs() > 300.0 {
                    return if size > 0.0 || size.is_nan() { 1.0 } else { -1.0 };
                }
                *mean += size / PERIODS as f64;
            }
        }
        (means[1] - means[0]) / PERIODS as f64
    }

    /// What the loop costs with this alone.
    pub(crate) fn cost(self, kind: Imperfection, size: f64) -> f64 {
        let none = Imperfections::NONE;
        let imperfections = match kind {
            Imperfection::Latency => {
                Imperfections { latency: Latency::of_seconds(size, self.period).unwrap(), ..none }
            }
            Imperfection::Jitter => Imperfections { jitter: Jitter::Uniform(size), ..none },
            Imperfection::Skew => Imperfections { skew: size, ..none },
            Imperfection::Loss => Imperfections { loss: size, ..none },
            Imperfection::OutputLatency => unreachable!("the loops of the catalogue have none"),
        };
        let model = Oscillator { omega2: self.omega2 };
        let plant = Plant::exact(model, State { q: [0.0], v: [0.0] }, self.period);
        let weights = LqrWeights { position: 5.0, velocity: 0.5, command: 0.0 };
        plant.cost(&self.gains.into(), &imperfections, weights).unwrap()
    }

    pub(crate) fn feedback(self) -> StateFeedback<1> {
        StateFeedback::to_origin(self.gains)
    }

    /// The moments `E[q²]`, `E[qv]` and `E[v²]` after a period of a jittered clock: the mean over the uniform law of its length.
    fn mean_operator(self, rms: f64) -> [[f64; 3]; 3] {
        // The error of the midpoint rule is 1e-6 of what jitter adds.
        const POINTS: usize = 1000;
        let Feedback { position, velocity } = self.gains;
        let mut mean = [[0.0; 3]; 3];
        for i in 0..POINTS {
            let part = (2 * i + 1) as f64 / POINTS as f64 - 1.0;
            // No step is negative.
            let dt = self.period * (1.0 + 3.0_f64.sqrt() * rms * part).max(0.0);
            let [(a, c), (b, d)] = [(1.0, 0.0), (0.0, 1.0)].map(|(q, v)| {
                let command = -position * q - velocity * v;
                let State { q: [q], v: [v] } = self.moved(State { q: [q], v: [v] }, command, dt);
                (q, v)
            });
            let squares = [
                [a * a, 2.0 * a * b, b * b],
                [a * c, a * d + b * c, b * d],
                [c * c, 2.0 * c * d, d * d],
            ];
            for (own, square) in mean.as_flattened_mut().iter_mut().zip(squares.as_flattened()) {
                *own += square / POINTS as f64;
            }
        }
        mean
    }

    /// The factor by which those grow in a period.
    pub(crate) fn mean_square(self, rms: f64) -> f64 {
        let operator = self.mean_operator(rms);
        let mut state = [1.0, 0.1, 1.0];
        let mut growth = 1.0;
        for _ in 0..20_000 {
            let moved = operator.map(|row| row.iter().zip(state).map(|(a, x)| a * x).sum::<f64>());
            growth = moved.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
            state = moved.map(|x| x / growth);
        }
        growth
    }
}
