//! Simulated loops against their period matrices.

use super::*;
use crate::{Cascade, DiscreteController, DiscreteFilter, LinearPlant, Signal};

/// Uniform numbers, each with a number of its own.
fn draw(setting: u64, number: u64, [low, high]: [f64; 2]) -> f64 {
    let purpose = Purpose::Variation;
    let [u, _] = Address { seed: 77, trajectory: setting, step: number, purpose }.uniform();
    low + (high - low) * u
}

/// Two masses in a row with damping, and feedback of all states that is too weak to make them unstable.
fn random_loop(setting: u64) -> LinearLoop {
    let of = |number, range| draw(setting, number, range);
    let mass = Matrix::diagonal(&[of(0, [0.5, 2.0]), of(1, [0.5, 2.0])]);
    let spring = of(2, [1.0, 8.0]);
    let stiffness = Matrix::from_rows(&[[2.0 * spring, -spring], [-spring, spring]]).unwrap();
    let damping = Matrix::diagonal(&[of(3, [0.5, 2.0]), of(4, [0.5, 2.0])]);
    let force = Matrix::identity(2);
    let names = Signal::numbered("q", 2);
    let plant = LinearPlant::mechanical([&mass, &damping, &stiffness], &force, &names).unwrap();
    let plant = plant.with_all_states_measured();
    let gain = Matrix::from_fn(2, 4, |i, j| {
        let own = if i == j % 2 { 1.0 } else { 0.2 };
        -own * of(5 + (4 * i + j) as u64, [0.2, 1.0])
    });
    let noise: Vec<f64> = (0..4).map(|j| of(20 + j, [0.0, 0.01])).collect();
    let cost = Matrix::diagonal(&[2.0, 1.0, 0.5, 0.5, 0.3, 0.1]);
    let controller = DiscreteController::gain(gain);
    LinearLoop::new(plant, controller, of(30, [0.1, 0.3]), cost, noise).unwrap()
}

fn random_timing(setting: u64, linear: &LinearLoop) -> LoopTiming {
    let of = |number, range| draw(setting, 100 + number, range);
    let late = |number: u64| {
        // Some of whole periods, some of none.
        let steps = of(number, [0.0, 2.5]);
        let steps = if of(number + 50, [0.0, 1.0]) < 0.4 { steps.floor() } else { steps };
        Latency::of_steps(steps).unwrap()
    };
    let rms = of(10, [0.0, 0.15]);
    let even = setting.is_multiple_of(5);
    LoopTiming {
        input_latency: (0..2).map(late).collect(),
        output_latency: (2..6).map(late).collect(),
        jitter: match (even, setting.is_multiple_of(2)) {
            (true, _) => Jitter::Gaussian(0.0),
            (false, true) => Jitter::Gaussian(rms),
            (false, false) => Jitter::Uniform(rms),
        },
        skew: of(11, [-0.1, 0.1]),
        loss: if setting.is_multiple_of(3) { 0.0 } else { of(12, [0.0, 0.3]) },
        missing: match setting.is_multiple_of(4) {
            true => MissingCommand::Zero,
            false => linear.ideal().missing,
        },
    }
}

/// The same loop with an average of a measurement, and every third one with a cascade: feedback of all states follows references
/// that feedback of the positions computes.
fn with_memory(linear: LinearLoop, setting: u64) -> LinearLoop {
    let average = (1, DiscreteFilter::MovingAverage(2 + (setting % 3) as usize));
    let bank = DiscreteFilter::bank(4, &[average], linear.period());
    let own = linear.controller().clone();
    let schedule = match setting.is_multiple_of(3) {
        false => own.into(),
        true => {
            let references = own.d.block((0, 0), (2, 2)).scaled(0.5);
            let mut inner = Matrix::zeros(2, 6);
            inner.set_block((0, 0), &own.d);
            inner.set_block((0, 4), &references);
            let outer = Matrix::from_fn(2, 4, |i, j| if i == j { -0.6 } else { 0.0 });
            let cascade = Cascade {
                inner: DiscreteController::gain(inner),
                outer: DiscreteController::gain(outer),
                inner_every: 1 + (setting % 2) as usize,
                outer_every: 4,
                outer_latency: (setting % 5) as usize,
            };
            cascade.schedule().unwrap()
        }
    };
    linear.with_controller(schedule.after(&bank)).unwrap()
}

#[test]
fn fifty_simulated_loops_cost_what_their_period_matrices_predict() {
    const LOOPS: u64 = 24;
    let mut squares = 0.0;
    for setting in 0..50 {
        let linear = random_loop(setting);
        let linear = if setting < 25 { linear } else { with_memory(linear, setting) };
        let timing = random_timing(setting, &linear);
        let predicted = linear.with_held_noise().stationary(&timing).unwrap().unwrap().cost;
        let one = Simulation { linear: &linear, timing: &timing, record: None, seed: setting };
        let costs: Vec<f64> = (0..LOOPS).map(|number| one.mean_cost(number, 200, 400)).collect();
        let count = LOOPS as f64;
        let mean = costs.iter().sum::<f64>() / count;
        let variance = costs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let z = (mean - predicted) / (variance / count).sqrt();
        // Student's t of 23 degrees of freedom passes 4.2 once in 3000 draws.
        assert!(z.abs() < 4.2, "{setting}: {mean} {predicted} {z}");
        squares += z * z;
    }
    // Of 50 such squares, whose mean is 23/21, the mean has a standard deviation of 0.25.
    assert!((0.5..1.9).contains(&(squares / 50.0)), "{}", squares / 50.0);
}
