//! Loops around random plants.

use libration_batch::ensemble::{Execution, InstructionSet};
use libration_core::control::{Jitter, Latency};
use libration_core::random::{Address, Purpose};
use libration_linear::{
    DiscreteController, LinearLoop, LinearPlant, LoopTiming, Matrix, MissingCommand, Signal,
    Simulation,
};
use libration_linear_loops::{LinearLoops, LinearLoopsError};

/// Uniform numbers, each with a number of its own.
fn draw(setting: u64, number: u64, [low, high]: [f64; 2]) -> f64 {
    let purpose = Purpose::Variation;
    let [u, _] = Address { seed: 31, trajectory: setting, step: number, purpose }.uniform();
    low + (high - low) * u
}

/// Two masses in a row, of which positions and a force are measured, and a controller with memory that leaves them stable.
fn random_loop(setting: u64) -> LinearLoop {
    let of = |number, range| draw(setting, number, range);
    let mass = Matrix::diagonal(&[of(0, [0.5, 2.0]), of(1, [0.5, 2.0])]);
    let spring = of(2, [1.0, 8.0]);
    let stiffness = Matrix::from_rows(&[[2.0 * spring, -spring], [-spring, spring]]).unwrap();
    let damping = Matrix::diagonal(&[of(3, [0.5, 2.0]), of(4, [0.5, 2.0])]);
    let force = Matrix::identity(2);
    let names = Signal::numbered("q", 2);
    let plant = LinearPlant::mechanical([&mass, &damping, &stiffness], &force, &names).unwrap();
    let c = Matrix::from_rows(&[[1.0, 0.0, 0.1, 0.0], [0.0, 1.0, 0.0, 0.0], [0.2, 0.0, 0.0, 0.3]]);
    let d = Matrix::from_rows(&[[0.0, 0.0], [0.0, 0.0], [0.1, 0.0]]).unwrap();
    let plant = LinearPlant::new(plant.a, plant.b, c.unwrap(), d).unwrap();
    let plant = plant.with_noise(Matrix::from_fn(4, 2, |i, j| {
        if i >= 2 { of(40 + (2 * i + j) as u64, [-0.5, 0.5]) } else { 0.0 }
    }));
    let entry = |first: u64, size: f64| {
        move |i: usize, j: usize| draw(setting, first + (4 * i + j) as u64, [-size, size])
    };
    let controller = DiscreteController {
        a: Matrix::from_fn(2, 2, entry(60, 0.4)),
        b: Matrix::from_fn(2, 3, entry(70, 0.3)),
        c: Matrix::from_fn(2, 2, entry(80, 0.3)),
        d: Matrix::from_fn(2, 3, entry(90, 0.3)),
    };
    let noise: Vec<f64> = (0..3).map(|j| of(20 + j, [0.0, 0.01])).collect();
    let cost = Matrix::diagonal(&[2.0, 1.0, 0.5, 0.5, 0.3, 0.1]);
    LinearLoop::new(plant.unwrap(), controller, of(30, [0.1, 0.3]), cost, noise).unwrap()
}

/// Latencies of whole periods, of parts and of none, skew and losses; jitter in three of five settings.
fn random_timing(setting: u64, linear: &LinearLoop) -> LoopTiming {
    let of = |number, range| draw(setting, 100 + number, range);
    let late = |number: u64| {
        let steps = of(number, [0.0, 2.5]);
        let steps = if of(number + 50, [0.0, 1.0]) < 0.4 { steps.floor() } else { steps };
        Latency::of_steps(steps).unwrap()
    };
    LoopTiming {
        input_latency: (0..2).map(late).collect(),
        output_latency: (2..5).map(late).collect(),
        jitter: match setting % 5 {
            0 | 1 => Jitter::Gaussian(0.0),
            2 | 3 => Jitter::Gaussian(of(10, [0.0, 0.15])),
            _ => Jitter::Uniform(of(10, [0.0, 0.15])),
        },
        skew: of(11, [-0.1, 0.1]),
        loss: if setting.is_multiple_of(3) { 0.0 } else { of(12, [0.0, 0.3]) },
        missing: match setting.is_multiple_of(4) {
            true => MissingCommand::Zero,
            false => linear.ideal().missing,
        },
    }
}

/// The start of state `i` of loop `n`.
fn start(n: usize, i: usize) -> f64 {
    (n + 1) as f64 * 0.1 - i as f64
}

#[test]
fn fifty_loops_follow_the_simulation_event_by_event_with_its_noise_and_losses() {
    const PERIODS: u64 = 150;
    let mut largest = [0.0_f64; 2];
    for setting in 0..50 {
        let linear = random_loop(setting).with_held_noise();
        let timing = random_timing(setting, &linear);
        assert!(linear.is_stable(&timing).unwrap(), "{setting}");
        // Some with recorded lengths.
        let record = [0.8, 1.3, 0.9, 0.0, 1.1];
        let record = setting.is_multiple_of(7).then_some(&record[..]);
        let mut all = LinearLoops::new(&linear, &timing, record, 2, Execution::serial()).unwrap();
        all.reset(setting, start);
        let simulation = Simulation { linear: &linear, timing: &timing, record, seed: setting };
        let wanted = [0, 1].map(|n| {
            let x: Vec<f64> = (0..4).map(|i| start(n, i)).collect();
            simulation.period_starts(n as u64, &x, PERIODS)
        });
        for k in 0..PERIODS as usize {
            for (n, wanted) in wanted.iter().enumerate() {
                for (i, x) in wanted[k].x.iter().enumerate() {
                    let uneven = usize::from(timing.jitter.rms() > 0.0 || record.is_some());
                    largest[uneven] = largest[uneven].max((all.state(n, i) - x).abs());
                }
            }
            all.advance(1);
            for (n, wanted) in wanted.iter().enumerate() {
                let cost = wanted[k].cost;
                assert!((all.cost(n) / cost - 1.0).abs() < 1e-12, "{setting} {k} {cost}");
            }
        }
    }
    // States are below 4, and a period leaves some ten roundings of them, of which stable loops keep those of some ten periods.
    let bound = 100.0 * 4.0 * f64::EPSILON;
    assert!(largest[0] < bound, "{largest:?}");
    // Interpolation drops coefficients up to sixteen roundings.
    assert!(largest[1] < 16.0 * bound, "{largest:?}");
}

/// Mean and standard error.
fn mean(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    [mean, (variance / count).sqrt()]
}

#[test]
fn cost_and_variances_under_white_noise_are_those_of_the_lyapunov_equation() {
    const COUNT: usize = 400;
    let mut squares = Vec::new();
    for setting in 0..20 {
        let linear = random_loop(setting);
        let timing = random_timing(setting, &linear);
        let wanted = linear.stationary(&timing).unwrap().unwrap();
        let mut all = LinearLoops::new(&linear, &timing, None, COUNT, Execution::serial()).unwrap();
        all.reset(setting, |_, _| 0.0);
        all.advance(300);
        let states =
            |all: &LinearLoops, i| (0..COUNT).map(|n| all.state(n, i).powi(2)).collect::<Vec<_>>();
        let mut found: Vec<(f64, [f64; 2])> =
            (0..4).map(|i| (wanted.deviations[i].powi(2), mean(&states(&all, i)))).collect();
        let before: Vec<f64> = (0..COUNT).map(|n| all.cost(n)).collect();
        let began: Vec<f64> = (0..COUNT).map(|n| all.time(n)).collect();
        all.advance(300);
        let rates: Vec<f64> =
            (0..COUNT).map(|n| (all.cost(n) - before[n]) / (300.0 * all.time(n) / 600.0)).collect();
        assert!(began[0] > 0.0);
        found.push((wanted.cost, mean(&rates)));
        for (wanted, [mean, error]) in found {
            let z = (mean - wanted) / error;
            // A hundred numbers; squares of Gaussian ones have long tails.
            assert!(z.abs() < 4.5, "{setting}: {mean} ± {error}, predicted {wanted}");
            squares.push(z * z);
        }
    }
    // The mean of a hundred squares, in groups of some that depend on each other, has a deviation of about 0.2.
    let [mean, _] = mean(&squares);
    assert!((0.5..1.7).contains(&mean), "{mean}");
}

#[test]
fn a_loop_has_the_same_bits_for_any_number_of_loops_and_threads_and_each_instruction_set() {
    let linear = random_loop(2);
    let timing = LoopTiming { loss: 0.2, ..random_timing(2, &linear) };
    let bits = |count, execution: Execution, pieces: &[u64]| {
        let mut all = LinearLoops::new(&linear, &timing, None, count, execution).unwrap();
        all.reset(5, start);
        pieces.iter().for_each(|&periods| all.advance(periods));
        let of = |n| {
            let numbers = (0..4).map(|i| all.state(n, i)).chain([all.cost(n), all.time(n)]);
            numbers.chain((0..2).map(|i| all.input(n, i))).map(f64::to_bits).collect::<Vec<_>>()
        };
        (0..count).map(of).collect::<Vec<_>>()
    };
    let whole = bits(100, Execution::serial(), &[40]);
    for count in [1, 15, 16, 17, 100] {
        for threads in [1, 2, 3] {
            let execution = Execution::serial().threads(threads).unwrap().worth(1);
            assert_eq!(
                bits(count, execution, &[1, 9, 30])[..],
                whole[..count],
                "{count} {threads}"
            );
        }
    }
    for set in InstructionSet::available() {
        let execution = Execution::serial().instructions(set).unwrap();
        assert!(bits(100, execution, &[40]) == whole, "{set:?}");
    }
}

#[test]
fn commands_of_the_caller_act_as_those_of_a_controller() {
    let linear = random_loop(7);
    let gain = Matrix::from_fn(2, 3, |i, j| 0.2 * i as f64 - 0.1 * j as f64);
    let controller = DiscreteController::gain(gain.clone());
    let memory = linear.controller().memory();
    assert!(memory > 0);
    let linear = linear.with_controller(controller).unwrap();
    let timing = random_timing(7, &linear);
    let mut closed = LinearLoops::new(&linear, &timing, None, 3, Execution::serial()).unwrap();
    let mut open = LinearLoops::new(&linear, &timing, None, 3, Execution::serial())
        .unwrap()
        .without_controller();
    closed.reset(1, start);
    open.reset(1, start);
    for _ in 0..50 {
        let command = |n: usize, i: usize| -> f64 {
            (0..3).map(|j| gain[(i, j)] * open.measurement(n, j)).sum()
        };
        let commands: Vec<f64> = (0..3).flat_map(|n| [command(n, 0), command(n, 1)]).collect();
        open.advance_by(&commands).unwrap();
        closed.advance(1);
        for n in 0..3 {
            for i in 0..4 {
                // The same sums of three products.
                assert_eq!(open.state(n, i).to_bits(), closed.state(n, i).to_bits());
            }
            assert_eq!(open.cost(n).to_bits(), closed.cost(n).to_bits());
        }
    }
}

#[test]
fn a_disturbance_and_a_reference_lead_to_the_equilibrium_that_they_define() {
    let linear = random_loop(3);
    let plant = linear.plant().clone().with_noise(Matrix::zeros(4, 0)).unwrap();
    let gain = Matrix::from_rows(&[[-0.5, 0.1, 0.0], [0.0, -0.4, 0.0]]).unwrap();
    let controller = DiscreteController::gain(gain.clone());
    let linear =
        LinearLoop::new(plant, controller, 0.1, linear.cost_form().clone(), vec![0.0; 3]).unwrap();
    let timing = random_timing(3, &linear);
    let mut all = LinearLoops::new(&linear, &timing, None, 1, Execution::serial()).unwrap();
    let (disturbance, reference) = ([0.7, -0.2], [0.3, -1.0, 0.5]);
    all.set_disturbance(&disturbance).unwrap();
    all.set_reference(&reference).unwrap();
    all.reset(0, start);
    all.advance(2000);
    // 0 = A x + B (K (C x + D u − r) + d), where K D = 0.
    let LinearPlant { a, b, c, .. } = linear.plant();
    let matrix = a.plus(&(b * &(&gain * c)));
    let held: Vec<f64> =
        gain.apply(&reference).iter().zip(disturbance).map(|(kr, d)| kr - d).collect();
    let column = Matrix::from_fn(4, 1, |i, _| b.apply(&held)[i]);
    let wanted = libration_linear::solve_matrix(&matrix, &column).unwrap();
    for (i, wanted) in wanted.entries().iter().enumerate() {
        assert!((all.state(0, i) - wanted).abs() < 1e-13, "{i} {wanted}");
    }
}

#[test]
fn wrong_counts_and_numbers_that_are_not_finite_are_refused_by_name() {
    let linear = random_loop(0);
    let timing = linear.ideal();
    let text = |error: LinearLoopsError| error.to_string();
    let none = LinearLoops::new(&linear, &timing, None, 0, Execution::serial()).map(|_| ());
    assert_eq!(text(none.unwrap_err()), "the number of loops is 0; expected at least 1");
    let mut all = LinearLoops::new(&linear, &timing, None, 2, Execution::serial()).unwrap();
    let short = all.set_reference(&[1.0]).unwrap_err();
    assert_eq!(text(short), "1 references; expected 3, one for each output");
    let infinite = all.set_disturbance(&[f64::INFINITY, 0.0]).unwrap_err();
    assert_eq!(text(infinite), "disturbances has the entry inf; expected finite numbers");
    let negative = LoopTiming { loss: 1.0, ..timing };
    let wrong = LinearLoops::new(&linear, &negative, None, 2, Execution::serial()).map(|_| ());
    assert!(text(wrong.unwrap_err()).contains("is 1; expected at least 0 and below 1"));
}
