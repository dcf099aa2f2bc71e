//! Tests of loops whose jobs overrun at random.

use libration_core::control::{Jitter, Latency};
use libration_core::random::{Address, Purpose};

use super::*;
use crate::{DiscreteController, LinearPlant, MissingCommand};

#[test]
fn a_killed_job_of_a_controller_without_memory_is_a_lost_command() {
    let rows = |rows: &[[f64; 2]]| Matrix::from_rows(rows).unwrap();
    let b = Matrix::from_rows(&[[0.0], [1.0]]).unwrap();
    let d = Matrix::zeros(2, 1);
    let plant = LinearPlant::new(rows(&[[0.0, 1.0], [2.0, -0.3]]), b, Matrix::identity(2), d);
    let controller = DiscreteController::gain(rows(&[[-5.0, -2.0]]));
    let noise = vec![0.01, 0.02];
    let linear =
        LinearLoop::new(plant.unwrap(), controller, 0.1, Matrix::identity(3), noise).unwrap();
    for missing in [MissingCommand::Hold, MissingCommand::Zero] {
        for late in [0.0, 0.4, 1.0, 1.3] {
            let timing = LoopTiming {
                input_latency: vec![Latency::of_steps(late).unwrap()],
                jitter: Jitter::Uniform(0.1),
                missing,
                ..linear.ideal()
            };
            let probability = 0.15;
            let lossy = LoopTiming { loss: probability, ..timing.clone() };
            let overruns = RandomOverruns { strategy: OverrunStrategy::Kill, probability };
            let found = linear.overrun_growth(&timing, overruns).unwrap();
            let wanted = linear.growth(&lossy).unwrap();
            // Growths are found to 10⁻¹³, of matrices that differ in size.
            assert!((found - wanted).abs() < 1e-9, "{missing:?} {late}: {found} {wanted}");
            let found = linear.overrun_stationary(&timing, overruns).unwrap().unwrap();
            let wanted = linear.stationary(&lossy).unwrap().unwrap();
            assert!((found.cost / wanted.cost - 1.0).abs() < 1e-9, "{missing:?} {late}");
            for (found, wanted) in found.deviations.iter().zip(wanted.deviations) {
                assert!((found / wanted - 1.0).abs() < 1e-9, "{missing:?} {late}");
            }
        }
    }
}

/// The mean cost `x² + r u²` of a simulated loop around `x' = a x + u + w`, in each of some batches of periods.
fn simulated(overruns: RandomOverruns, holds: bool, [a, gain, r, noise]: [f64; 4]) -> Vec<f64> {
    const BATCHES: u64 = 40;
    const PERIODS: u64 = 20_000;
    let draw = |step, purpose| Address { seed: 5, trajectory: 0, step, purpose };
    let (mut x, mut u, mut unfinished) = (0.0_f64, 0.0_f64, None);
    let batch = |batch: u64| {
        let mut cost = 0.0;
        for k in batch * PERIODS..(batch + 1) * PERIODS {
            let overrun = draw(k, Purpose::Latency).uniform().map(|u| u < overruns.probability);
            let [w, v] = draw(k, Purpose::Disturbance).gaussian();
            let own = -gain * (x + noise * v);
            let (sent, goes_on) = match (overruns.strategy, unfinished, overrun) {
                (OverrunStrategy::Kill, _, _) => unreachable!("no job goes on"),
                (_, None, [false, _]) => (Some(own), None),
                (_, None, [true, _]) => (None, Some(own)),
                (_, Some(old), [true, _]) => (None, Some(old)),
                (OverrunStrategy::Skip, Some(old), [false, _]) => (Some(old), None),
                (_, Some(_), [false, false]) => (Some(own), None),
                (_, Some(old), [false, true]) => (Some(old), Some(own)),
            };
            unfinished = goes_on;
            u = sent.unwrap_or(if holds { u } else { 0.0 });
            cost += x * x + r * u * u;
            x = a * x + u + w;
        }
        cost / PERIODS as f64
    };
    (0..BATCHES).map(batch).collect()
}

#[test]
fn a_simulated_loop_with_jobs_that_go_on_costs_what_is_predicted() {
    let [a, gain, r, noise] = [1.05, 0.5, 0.3, 0.7];
    let one = |x: f64| Matrix::diagonal(&[x]);
    let plant = LinearPlant::new(one(a), one(1.0), one(1.0), one(0.0)).unwrap();
    let plant = LinearPlant { sampling_period: Some(1.0), ..plant }.with_noise(one(1.0));
    let controller = DiscreteController::gain(one(-gain));
    let cost = Matrix::diagonal(&[1.0, r]);
    let linear =
        LinearLoop::new(plant.unwrap(), controller, 1.0, cost, vec![noise * noise]).unwrap();
    for strategy in [OverrunStrategy::Skip, OverrunStrategy::Queue] {
        for missing in [MissingCommand::Hold, MissingCommand::Zero] {
            let overruns = RandomOverruns { strategy, probability: 0.25 };
            let timing = LoopTiming { missing, ..linear.ideal() };
            let predicted = linear.overrun_stationary(&timing, overruns).unwrap().unwrap().cost;
            let holds = missing == MissingCommand::Hold;
            let batches = simulated(overruns, holds, [a, gain, r, noise]);
            let count = batches.len() as f64;
            let mean = batches.iter().sum::<f64>() / count;
            let square = batches.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            let error = (square / (count - 1.0) / count).sqrt();
            // Four standard errors of about 0.3 %.
            assert!(error < 0.006 * mean, "{strategy:?} {missing:?}: {mean} {error}");
            let off = (mean - predicted).abs();
            assert!(off < 4.0 * error, "{strategy:?} {missing:?}: {mean} {predicted} {error}");
        }
    }
}

#[test]
fn second_moments_decay_where_their_growth_is_below_zero() {
    let rows = |rows: &[[f64; 2]]| Matrix::from_rows(rows).unwrap();
    let b = Matrix::from_rows(&[[0.0], [1.0]]).unwrap();
    let d = Matrix::zeros(2, 1);
    let plant = LinearPlant::new(rows(&[[0.0, 1.0], [9.0, 0.0]]), b, Matrix::identity(2), d);
    let controller = DiscreteController::gain(rows(&[[-14.0, -4.5]]));
    let cost = Matrix::identity(3);
    let linear = LinearLoop::new(plant.unwrap(), controller, 0.1, cost, vec![0.0; 2]).unwrap();
    let latency = vec![Latency::of_steps(1.0).unwrap()];
    let timing = LoopTiming { input_latency: latency, ..linear.ideal() };
    let mut signs = Vec::new();
    for strategy in [OverrunStrategy::Skip, OverrunStrategy::Queue] {
        for part in 0..25 {
            let probability = 0.2 + 0.005 * f64::from(part);
            let overruns = RandomOverruns { strategy, probability };
            let growth = linear.overrun_growth(&timing, overruns).unwrap();
            let decays = linear.decays_with_overruns(&timing, overruns).unwrap();
            assert_eq!(decays, growth < 0.0, "{strategy:?} {probability}: {growth}");
            signs.push(decays);
        }
    }
    assert!(signs.contains(&true) && signs.contains(&false));
}

#[test]
fn probabilities_and_losses_that_exclude_each_other_are_refused() {
    let one = |x: f64| Matrix::diagonal(&[x]);
    let plant = LinearPlant::new(one(-1.0), one(1.0), one(1.0), one(0.0)).unwrap();
    let controller = DiscreteController::gain(one(-0.1));
    let linear = LinearLoop::new(plant, controller, 0.1, Matrix::identity(2), vec![0.0]).unwrap();
    let of = |probability| RandomOverruns { strategy: OverrunStrategy::Skip, probability };
    for probability in [-0.1, 1.0, f64::NAN] {
        let found = linear.overrun_growth(&linear.ideal(), of(probability));
        assert!(matches!(found, Err(LinearLoopError::Overruns(_))), "{found:?}");
    }
    let lossy = LoopTiming { loss: 0.1, ..linear.ideal() };
    let found = linear.overrun_growth(&lossy, of(0.1));
    assert_eq!(found, Err(LinearLoopError::LossAndOverruns));
}
