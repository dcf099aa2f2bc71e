//! Loops and independent simulations of them.

use libration::analysis::{Imperfections, Plant};
use libration::catalog::Actuation;
use libration::control::clock::{Jittered, Rates};
use libration::control::controller::StateFeedback;
use libration::control::{Clock, Controller, Feedback, Jitter, Latency, LqrWeights, Schedule};
use libration::ensemble::{All, Execution, Loops, Setup};
use libration::integrator::Exact;
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

    /// By how much `ln |y|` of a simulated loop changes in a period, between two long windows.
    pub(crate) fn growth(
        self,
        controller: impl Controller<f64, 1>,
        latency: f64,
        skew: f64,
    ) -> f64 {
        let rates = [1.0 + skew];
        self.growth_by(controller, Rates(&rates), latency, self.period * (1.0 + skew))
    }

    /// The same with another clock, whose steps are about `step` long.
    pub(crate) fn growth_by(
        self,
        controller: impl Controller<f64, 1>,
        clock: impl Clock<f64>,
        latency: f64,
        step: f64,
    ) -> f64 {
        const PERIODS: u64 = 6_000;
        let model = Oscillator { omega2: self.omega2 };
        let latency = Latency::of_steps(latency / self.period).unwrap();
        let exact = Exact::new::<1>(model, step).unwrap();
        let setup = Setup::new(All(model), exact)
            .controller(controller)
            .clock(clock)
            .delay(Schedule::late(latency));
        let start = [State { q: [1.0], v: [0.3] }];
        let mut one =
            Loops::new(setup, self.period, 0, [0.0], &start, Execution::serial()).unwrap();
        let mut means = [0.0; 2];
        one.advance(PERIODS / 4).unwrap();
        for mean in &mut means {
            for _ in 0..PERIODS {
                one.advance(1).unwrap();
                let State { q: [q], v: [v] } = one.state(0).unwrap();
                let size = (self.omega2.max(1.0) * q * q + v * v).ln() / 2.0;
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

    /// What a period makes of `E[q²]`, `E[qv]` and `E[v²]`, measured of loops that are simulated with a jittered clock.
    pub(crate) fn simulated_operator(self, rms: f64) -> [[f64; 3]; 3] {
        // At 0.98 and 1.02 of a limit the growth is off by a 25th of what jitter adds, which is as the square of its rms; what a
        // draw adds is as its rms.
        let count = ((90.0 / rms).powi(2) as usize).clamp(50_000, 400_000);
        let model = Oscillator { omega2: self.omega2 };
        let exact = Exact::new::<1>(model, self.period).unwrap();
        let setup = Setup::new(All(model), exact)
            .controller(self.feedback())
            .clock(Jittered(Jitter::Uniform(rms)));
        let starts: Vec<State<f64, 1>> = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
            .into_iter()
            .flat_map(|[q, v]| std::iter::repeat_n(State { q: [q], v: [v] }, count))
            .collect();
        let mut loops =
            Loops::new(setup, self.period, 5, [0.0], &starts, Execution::serial()).unwrap();
        loops.advance(1).unwrap();
        let after = |start: usize| {
            let mut sums = [0.0; 3];
            for i in start * count..(start + 1) * count {
                let State { q: [q], v: [v] } = loops.state(i).unwrap();
                for (sum, x) in sums.iter_mut().zip([q * q, q * v, v * v]) {
                    *sum += x / count as f64;
                }
            }
            sums
        };
        let [qq, vv, both] = [0, 1, 2].map(after);
        [0, 1, 2].map(|i| [qq[i], both[i] - qq[i] - vv[i], vv[i]])
    }

    /// The factor by which those grow in a period.
    pub(crate) fn mean_square(self, rms: f64) -> f64 {
        let operator = self.simulated_operator(rms);
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
