//! Nanoseconds per period of a loop around a linear plant: many loops together, and event by event.
//!
//! `cargo run --release --example linear_loops`, of 4096 loops or as many as the argument says

use std::hint::black_box;
use std::time::Instant;

use libration::control::{Jitter, Latency};
use libration::ensemble::{Execution, InstructionSet};
use libration::linear::{
    DiscreteController, LinearLoop, LinearPlant, LoopTiming, Matrix, Signal, Simulation,
};
use libration::linear_loops::LinearLoops;

/// Two masses in a row with two forces; the command of each has a latency of a part of a period.
fn two_masses(noisy: bool) -> LinearLoop {
    let mass = Matrix::diagonal(&[1.0, 0.5]);
    let stiffness = Matrix::from_fn(2, 2, |i, j| [[30.0, -10.0], [-10.0, 10.0]][i][j]);
    let damping = Matrix::diagonal(&[0.2, 0.1]);
    let names = Signal::numbered("q", 2);
    let plant =
        LinearPlant::mechanical([&mass, &damping, &stiffness], &Matrix::identity(2), &names);
    let plant = plant.expect("a plant").with_all_states_measured();
    let noise = if noisy { plant.b.clone() } else { Matrix::zeros(4, 0) };
    let plant = plant.with_noise(noise).expect("a plant");
    let gain = Matrix::from_fn(2, 4, |i, j| [[-1.0, 0.0, -2.0, 0.0], [0.0, -1.0, 0.0, -1.0]][i][j]);
    let variance = if noisy { 1e-6 } else { 0.0 };
    let controller = DiscreteController::gain(gain);
    LinearLoop::new(plant, controller, 0.05, Matrix::identity(6), vec![variance; 4])
        .expect("a loop")
}

/// The least seconds of five runs.
fn seconds(mut run: impl FnMut()) -> f64 {
    let once = |_| {
        let began = Instant::now();
        run();
        began.elapsed().as_secs_f64()
    };
    (0..5).map(once).fold(f64::INFINITY, f64::min)
}

fn main() {
    const PERIODS: u64 = 200;
    let number = std::env::args().nth(1).map(|argument| argument.parse().expect("a number"));
    let count = number.unwrap_or(4096);
    let nanoseconds = |seconds: f64, loops: usize| seconds * 1e9 / (loops as u64 * PERIODS) as f64;
    println!(
        "nanoseconds per loop and period; 4 states, 2 inputs, 4 outputs, three parts per period"
    );
    for (name, noisy, rms) in
        [("no noise", false, 0.0), ("noise", true, 0.0), ("noise, jitter", true, 0.05)]
    {
        let linear = two_masses(noisy);
        let late = |steps| Latency::of_steps(steps).expect("a latency");
        let timing = LoopTiming {
            input_latency: vec![late(0.4), late(1.3)],
            jitter: Jitter::Gaussian(rms),
            ..linear.ideal()
        };
        let one = Simulation { linear: &linear, timing: &timing, record: None, seed: 1 };
        let lone = nanoseconds(
            seconds(|| {
                black_box(one.mean_cost(0, 0, 5 * PERIODS));
            }),
            5,
        );
        println!("{name}: event by event {lone:.0}");
        for set in InstructionSet::available() {
            let execution = Execution::serial().instructions(set).expect("an instruction set");
            let mut all =
                LinearLoops::new(&linear, &timing, None, count, execution).expect("loops");
            let found = nanoseconds(seconds(|| all.advance(PERIODS)), count);
            println!("  {}: {found:.1}, {:.0} times as fast", set.name(), lone / found);
        }
    }
}
