//! The cost of simulated loops under noise agrees with the Lyapunov equation.

use libration::analysis::{Imperfections, LinearController, ObserverNoise, Plant};
use libration::control::clock::{Jittered, Rates};
use libration::control::controller::{Luenberger, Pid, PidGains, StateFeedback};
use libration::control::delay::{Order, Packets};
use libration::control::{Controller, Feedback, Jitter, Latency, LqrWeights, Schedule, WhiteNoise};
use libration::ensemble::{All, Execution, Loops, MeanSquareError, Setup};
use libration::integrator::Exact;
use libration::random::{Address, Purpose};
use libration::system::{BaselineOnly, Oscillator};
use libration::{Integrator, Method, State};

const MODEL: Oscillator<f64> = Oscillator { omega2: 10.0 };
const ORIGIN: State<f64, 1> = State { q: [0.0], v: [0.0] };
const GAINS: Feedback = Feedback { position: 10.0, velocity: 2.0 };
const WEIGHTS: LqrWeights = LqrWeights { position: 5.0, velocity: 0.5, command: 0.05 };

/// Trajectories whose costs are averaged over time, each for itself.
const COUNT: usize = 400;

/// A mean over trajectories, and its standard error.
fn mean(costs: &[f64]) -> [f64; 2] {
    let count = costs.len() as f64;
    let mean = costs.iter().sum::<f64>() / count;
    let squares: f64 = costs.iter().map(|cost| (cost - mean).powi(2)).sum();
    [mean, (squares / (count - 1.0) / count).sqrt()]
}

/// The cost of simulated loops in steps of `dt` seconds: the state and the commands of each step.
fn simulated(
    method: impl Integrator,
    controller: impl Controller<f64, 1>,
    dt: f64,
    imperfections: Imperfections,
) -> [f64; 2] {
    let Imperfections { latency, jitter, skew, loss } = imperfections;
    let (whole, part) = (latency.steps().trunc() as usize, latency.steps().fract());
    let mut travels = vec![0.0; whole + 1];
    travels[whole] = 1.0 - loss;
    let packets = Packets::new(&travels, Order::NewestActs).unwrap().longer_by(part).unwrap();
    let rates = vec![1.0 + skew; COUNT];
    let setup = Setup::new(All(BaselineOnly(MODEL)), method)
        .controller(controller)
        .clock((Rates(&rates), Jittered(jitter)))
        .delay(packets)
        .disturbance(WhiteNoise(1.0));
    let starts = vec![State { q: [0.0], v: [0.0] }; COUNT];
    let mut loops = Loops::new(setup, dt, 11, [0.0], &starts, Execution::serial()).unwrap();
    // Forty seconds are ten times as long as anything here is remembered; then two hundred count.
    let steps = |seconds: f64| (seconds / dt) as u64;
    loops.advance(steps(40.0)).unwrap();
    let held = |loops: &Loops<_, _, _, _, _, _, _, 1, _>| -> Vec<f64> {
        (0..COUNT).map(|n| loops.command(n).unwrap()[0]).collect()
    };
    let mut costs = vec![0.0; COUNT];
    let mut before = held(&loops);
    for _ in 0..steps(200.0) {
        let all = loops.trajectories();
        for (cost, (q, v)) in costs.iter_mut().zip(all.q(0).iter().zip(all.v(0))) {
            *cost += WEIGHTS.position * q * q + WEIGHTS.velocity * v * v;
        }
        loops.advance(1).unwrap();
        let after = held(&loops);
        for (cost, (old, new)) in costs.iter_mut().zip(before.iter().zip(&after)) {
            *cost += WEIGHTS.command * (part * old * old + (1.0 - part) * new * new);
        }
        before = after;
    }
    let steps = steps(200.0) as f64;
    mean(&costs.into_iter().map(|cost| cost / steps).collect::<Vec<_>>())
}

fn agrees(what: &str, predicted: f64, [mean, error]: [f64; 2]) {
    let off = (mean - predicted) / error;
    assert!(off.abs() < 3.0, "{what}: {mean} ± {error}, predicted {predicted}: {off} errors");
    // An error that says nothing would agree with anything.
    assert!(error < 0.02 * predicted, "{what}: {mean} ± {error}");
}

fn of(steps: f64, jitter: Jitter, skew: f64, loss: f64) -> Imperfections {
    Imperfections { latency: Latency::of_steps(steps).unwrap(), jitter, skew, loss }
}

const STEADY: Jitter = Jitter::Gaussian(0.0);

#[test]
fn state_feedback_costs_what_is_predicted_in_eleven_settings() {
    use Method::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet, Yoshida4};
    let settings = [
        (VelocityVerlet, 0.05, of(0.0, STEADY, 0.0, 0.0)),
        (VelocityVerlet, 0.05, of(1.0, STEADY, 0.0, 0.0)),
        (SymplecticEuler, 0.1, of(0.6, STEADY, 0.0, 0.0)),
        (SymplecticEuler, 0.1, of(0.0, Jitter::Gaussian(0.3), 0.0, 0.0)),
        (Rk4, 0.1, of(0.0, Jitter::Uniform(0.5), 0.0, 0.3)),
        (Rk4, 0.1, of(0.4, STEADY, 0.0, 0.2)),
        (Yoshida4, 0.08, of(1.0, Jitter::Gaussian(0.2), -0.1, 0.0)),
        (ExplicitEuler, 0.02, of(0.0, STEADY, 0.2, 0.0)),
        (ExplicitEuler, 0.02, of(1.0, Jitter::Uniform(0.2), 0.0, 0.4)),
        (VelocityVerlet, 0.15, of(0.0, Jitter::Gaussian(0.3), 0.0, 0.1)),
        (Rk4, 0.05, of(2.3, Jitter::Gaussian(0.1), 0.05, 0.1)),
    ];
    // Methods are dispatched at each step: a loop is compiled once and not once for each of them.
    for (method, dt, imperfections) in settings {
        let plant = Plant::new(method, MODEL, ORIGIN, dt);
        let predicted = plant.cost(&GAINS.into(), &imperfections, WEIGHTS).unwrap();
        let controller = StateFeedback::to_origin(GAINS);
        let measured = simulated(method, controller, dt, imperfections);
        agrees(&format!("{method:?} {imperfections:?}"), predicted, measured);
    }
}

#[test]
fn controllers_that_remember_cost_what_is_predicted_in_five_settings() {
    let gains = PidGains {
        proportional: 12.0,
        integral: 6.0,
        derivative: 3.0,
        filter: 0.02,
        most: f64::INFINITY,
        tracking: 1.0,
        target: [0.0],
    };
    let (pid, dt) = (Pid::new(gains).unwrap(), 0.04);
    let method = libration::integrator::VelocityVerlet;
    let plant = Plant::new(method, MODEL, ORIGIN, dt);
    let linear = LinearController::of(&pid, dt).unwrap();
    for imperfections in [
        of(0.0, STEADY, 0.0, 0.0),
        of(1.5, STEADY, 0.1, 0.0),
        of(0.0, Jitter::Gaussian(0.2), 0.0, 0.2),
    ] {
        let predicted = plant.cost(&linear, &imperfections, WEIGHTS).unwrap();
        let measured = simulated(method, pid, dt, imperfections);
        agrees(&format!("PID {imperfections:?}"), predicted, measured);
    }
    let noise = ObserverNoise { acceleration: 1.0, position: 1e-4 };
    let gains = Feedback { position: 4.0, velocity: 3.0 };
    let observed = Luenberger::to_origin(gains, plant.observer(noise).unwrap());
    let linear = LinearController::of(&observed, dt).unwrap();
    for imperfections in [of(0.0, STEADY, 0.0, 0.0), of(1.0, Jitter::Uniform(0.3), 0.0, 0.1)] {
        let predicted = plant.cost(&linear, &imperfections, WEIGHTS).unwrap();
        let measured = simulated(method, observed, dt, imperfections);
        agrees(&format!("observer {imperfections:?}"), predicted, measured);
    }
}

#[test]
fn an_exact_loop_with_a_late_command_costs_what_fine_steps_measure() {
    // Fine steps of noise that is held, against noise that is white: second moments differ by (ωh)²/12 and less, here 1.3·10⁻⁴.
    const FINE: u32 = 8;
    for (dt, late) in [(0.1, 0.0), (0.1, 0.5), (0.05, 2.0)] {
        let plant = Plant::exact(MODEL, ORIGIN, dt);
        let weights = LqrWeights { command: 0.0, ..WEIGHTS };
        let imperfections = of(late, STEADY, 0.0, 0.0);
        let predicted = plant.cost(&GAINS.into(), &imperfections, weights).unwrap();
        let fine = dt / f64::from(FINE);
        let schedule = Schedule::new(f64::from(FINE), 0.0, late * f64::from(FINE)).unwrap();
        let setup = Setup::new(All(BaselineOnly(MODEL)), Exact::new::<1>(MODEL, fine).unwrap())
            .controller(StateFeedback::to_origin(GAINS))
            .delay(schedule)
            .disturbance(WhiteNoise(1.0));
        let starts = vec![ORIGIN; COUNT];
        let mut loops = Loops::new(setup, fine, 3, [0.0], &starts, Execution::serial()).unwrap();
        let steps = |seconds: f64| (seconds / dt) as u64 * u64::from(FINE);
        loops.advance(steps(40.0)).unwrap();
        let squares = |range| MeanSquareError::new(range, |_, _| ORIGIN);
        let observed = loops.observe(steps(200.0), 1, squares).unwrap();
        let cost = |[q, v]: [f64; 2]| weights.position * q + weights.velocity * v;
        let costs: Vec<_> = observed.iter().flat_map(MeanSquareError::means).map(cost).collect();
        agrees(&format!("exact, {dt}, {late}"), predicted, mean(&costs));
    }
}

/// An oscillator in closed form: what a step of `h` seconds makes of the state under a command and under noise.
fn moved([q, v]: [f64; 2], u: f64, h: f64, [a, b]: [f64; 2]) -> [f64; 2] {
    let omega2 = MODEL.omega2;
    let omega = omega2.sqrt();
    let (s, c) = (omega * h).sin_cos();
    let (s2, c2) = (2.0 * omega * h).sin_cos();
    // The covariance of what noise adds, and its root.
    let qq = (h / 2.0 - s2 / (4.0 * omega)) / omega2;
    let qv = (1.0 - c2) / (4.0 * omega2);
    let vv = h / 2.0 + s2 / (4.0 * omega);
    let root = qq.max(0.0).sqrt();
    let across = if root > 0.0 { qv / root } else { 0.0 };
    let rest = (vv - across * across).max(0.0).sqrt();
    [
        c * q + s / omega * v + (1.0 - c) / omega2 * u + root * a,
        -omega * s * q + c * v + s / omega * u + across * a + rest * b,
    ]
}

#[test]
fn an_exact_loop_with_jitter_and_losses_costs_what_a_plain_program_measures() {
    // Within each step one moment, drawn for itself, stands for all.
    const STEPS: u64 = 4000;
    let dt = 0.1;
    for (late, rms, loss) in [(0.0, 0.3, 0.0), (0.0, 0.0, 0.4), (0.3, 0.25, 0.2)] {
        let imperfections = of(late, Jitter::Uniform(rms), 0.0, loss);
        let plant = Plant::exact(MODEL, ORIGIN, dt);
        let predicted = plant.cost(&GAINS.into(), &imperfections, WEIGHTS).unwrap();
        let costs: Vec<f64> = (0..COUNT as u64)
            .map(|trajectory| {
                let (mut state, mut held) = ([0.0; 2], 0.0);
                let (mut cost, mut time) = (0.0, 0.0);
                for step in 0..STEPS {
                    let draw = |purpose| Address { seed: 5, trajectory, step, purpose };
                    let [longer, moment] = draw(Purpose::StepTime).uniform();
                    let [lost, _] = draw(Purpose::Latency).uniform();
                    let h = dt * (1.0 + rms * 3.0_f64.sqrt() * (2.0 * longer - 1.0));
                    let next = if lost < loss {
                        held
                    } else {
                        -GAINS.position * state[0] - GAINS.velocity * state[1]
                    };
                    // To the moment that is looked at, with a stop where the command arrives.
                    let (arrives, looks) = (late * h, moment * h);
                    let mut stops = [(arrives, true), (looks, false), (h, false)];
                    stops.sort_by(|a, b| a.0.total_cmp(&b.0));
                    let (mut now, mut acting, mut seen) = (0.0, held, (state, held));
                    let noises = [Purpose::Start, Purpose::Variation, Purpose::Delay];
                    for ((stop, arrival), noise) in stops.into_iter().zip(noises) {
                        state = moved(state, acting, stop - now, draw(noise).gaussian());
                        now = stop;
                        if arrival {
                            acting = next;
                        } else if stop == looks {
                            seen = (state, acting);
                        }
                    }
                    held = next;
                    if step >= 400 {
                        let ([q, v], u) = seen;
                        let LqrWeights { position, velocity, command } = WEIGHTS;
                        cost += h * (position * q * q + velocity * v * v + command * u * u);
                        time += h;
                    }
                }
                cost / time
            })
            .collect();
        agrees(&format!("{late} {rms} {loss}"), predicted, mean(&costs));
    }
}
