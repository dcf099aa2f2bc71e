//! Redesigned controllers: optimal, and those of the textbook where nothing is late or random.

#![allow(clippy::unwrap_used)]

use libration_core::control::{Jitter, Latency};
use libration_linear::{
    ChannelPart, CostWeights, DiscreteController, LinearLoop, LinearPlant, LoopTiming, Matrix,
    MissingCommand, Redesign, RedesignKind,
};

/// Numbers in [−1, 1), by D. Lehmer's generator with the multiplier of S. Park and K. Miller (1988).
struct Random(u64);

impl Random {
    fn number(&mut self) -> f64 {
        self.0 = self.0 * 16_807 % 2_147_483_647;
        2.0 * self.0 as f64 / 2_147_483_647.0 - 1.0
    }

    fn matrix(&mut self, rows: usize, columns: usize) -> Matrix {
        let entries: Vec<f64> = (0..rows * columns).map(|_| self.number()).collect();
        Matrix::from_fn(rows, columns, |i, j| entries[i * columns + j])
    }

    fn latency(&mut self, most: f64) -> Latency {
        Latency::of_steps(most * 0.5 * (1.0 + self.number())).unwrap()
    }
}

/// A plant with noise in all states, with measurements of these numbers of states and outputs.
fn plant(random: &mut Random, [n, m, p]: [usize; 3]) -> LinearPlant {
    let a = random.matrix(n, n).scaled(1.5);
    let [b, c] = [random.matrix(n, m), random.matrix(p, n)];
    let plant = LinearPlant::new(a, b, c, Matrix::zeros(p, m)).unwrap();
    plant.with_noise(random.matrix(n, n)).unwrap()
}

fn weights(n: usize, m: usize) -> CostWeights {
    CostWeights { states: Matrix::identity(n), inputs: Matrix::identity(m).scaled(0.2) }
}

const PERIOD: f64 = 0.2;

fn closed(plant: &LinearPlant, controller: DiscreteController, noise: f64) -> LinearLoop {
    let (n, m, p) = (plant.states.len(), plant.inputs.len(), plant.outputs.len());
    let form = weights(n, m).form();
    LinearLoop::new(plant.clone(), controller, PERIOD, form, vec![noise; p]).unwrap()
}

/// A loop without a controller yet.
fn open(plant: &LinearPlant, noise: f64) -> LinearLoop {
    let (m, p) = (plant.inputs.len(), plant.outputs.len());
    closed(plant, DiscreteController::gain(Matrix::zeros(m, p)), noise)
}

fn cost(linear: &LinearLoop, controller: &DiscreteController, timing: &LoopTiming) -> f64 {
    let linear = linear.with_controller(controller.clone()).unwrap();
    linear.stationary(timing).unwrap().map_or(f64::INFINITY, |found| found.cost)
}

/// Timings in which nothing, lengths of periods, losses, or both are drawn.
fn timings(linear: &LinearLoop, random: &mut Random, outputs_late: bool) -> Vec<LoopTiming> {
    let drawn = [
        (0.0, 0.0, MissingCommand::Hold),
        (0.17, 0.0, MissingCommand::Hold),
        (0.0, 0.3, MissingCommand::Hold),
        (0.1, 0.2, MissingCommand::Zero),
    ];
    let timing = |&(jitter, loss, missing): &(f64, f64, MissingCommand)| {
        let mut timing = linear.ideal();
        timing.input_latency.fill_with(|| random.latency(2.2));
        if outputs_late {
            timing.output_latency.fill_with(|| random.latency(1.5));
        }
        let (jitter, skew) = (Jitter::Gaussian(jitter), 0.05);
        LoopTiming { jitter, skew, loss, missing, ..timing }
    };
    drawn.iter().map(timing).collect()
}

/// Random loops with their timings and redesigned controllers; a few that no controller stabilises are left out.
fn redesigned() -> Vec<(LinearLoop, LoopTiming, Redesign)> {
    let mut found = Vec::new();
    for seed in 1..10 {
        let mut random = Random(seed * 7919);
        let size = [1 + seed as usize % 3, 1 + seed as usize % 2, 1 + seed as usize % 2];
        let plant = plant(&mut random, size);
        // Half of them measure all states, without noise or latency.
        let all = seed % 4 < 2;
        let linear = match all {
            true => open(&plant.with_all_states_measured(), 0.0),
            false => open(&plant, 0.01),
        };
        for mut timing in timings(&linear, &mut random, !all) {
            if all && timing.loss > 0.0 {
                // Else the command that acts is a part of the state, and not known.
                timing.input_latency.fill(Latency::NONE);
            }
            if let Ok(redesign) = linear.redesign(&timing) {
                found.push((linear.clone(), timing, redesign));
            }
        }
    }
    found
}

#[test]
fn the_cost_of_the_loop_is_that_which_the_equations_predict() {
    let all = redesigned();
    for kind in [
        RedesignKind::StateFeedback,
        RedesignKind::RandomStateFeedback,
        RedesignKind::Lqg,
        RedesignKind::Compensator,
    ] {
        let of_kind: Vec<_> = all.iter().filter(|found| found.2.kind == kind).collect();
        assert!(of_kind.len() >= 3, "{kind:?} {}", of_kind.len());
        for (linear, timing, redesign) in of_kind {
            let found = cost(linear, &redesign.controller, timing);
            // The equations settle to 10⁻¹²; a loop that forgets in thousands of periods multiplies it.
            assert!((found / redesign.cost - 1.0).abs() < 1e-8, "{kind:?} {found} {redesign:?}");
        }
    }
}

#[test]
fn no_entry_of_a_controller_can_change_and_the_cost_fall() {
    for (linear, timing, redesign) in redesigned() {
        let best = &redesign.controller;
        let least = cost(&linear, best, &timing);
        let (mut tried, mut higher) = (0, 0);
        // Some twelve entries of each controller, from all four matrices.
        let stride = entries(&mut best.clone()).count().div_ceil(12);
        for place in (0..entries(&mut best.clone()).count()).step_by(stride) {
            // Small changes show a slope, larger ones that the entry matters.
            for size in [-1e-2, -1e-4, 1e-4, 1e-2] {
                let mut other = best.clone();
                if let Some(entry) = entries(&mut other).nth(place) {
                    *entry += size * entry.abs().max(1.0);
                }
                let found = cost(&linear, &other, &timing);
                // Rounding of a cost, in loops that forget in up to a thousand periods.
                assert!(found >= least * (1.0 - 1e-10), "{:?} {found} {least}", redesign.kind);
                tried += 1;
                higher += usize::from(found > least * (1.0 + 1e-9));
            }
        }
        // Most entries matter.
        assert!(3 * higher > tried, "{:?} {higher} of {tried}", redesign.kind);
    }
}

/// All entries of a controller.
fn entries(controller: &mut DiscreteController) -> impl Iterator<Item = &mut f64> {
    let DiscreteController { a, b, c, d } = controller;
    [d, c, b, a].into_iter().flat_map(Matrix::entries_mut)
}

#[test]
fn without_latency_they_are_the_plain_regulator_and_the_plain_filter() {
    let mut random = Random(30);
    let plant = plant(&mut random, [3, 2, 2]);
    let close = |found: &Matrix, wanted: &Matrix| {
        let mut off = found.clone();
        off.add_scaled(-1.0, wanted);
        assert!(off.largest() < 1e-11 * wanted.largest(), "{found:?} {wanted:?}");
    };
    let gain = plant.design_regulator(&weights(3, 2), PERIOD).unwrap().gain;
    let measured = open(&plant.clone().with_all_states_measured(), 0.0);
    let found = measured.redesign(&measured.ideal()).unwrap();
    assert_eq!((found.kind, found.controller.memory()), (RedesignKind::StateFeedback, 0));
    close(&found.controller.d, &gain.scaled(-1.0));
    let noisy = open(&plant, 0.01);
    let filter = plant.design_filter(&Matrix::identity(2).scaled(0.01), PERIOD).unwrap();
    let wanted = plant.estimated_feedback(&gain, &filter, PERIOD);
    let found = noisy.redesign(&noisy.ideal()).unwrap();
    assert_eq!((found.kind, found.controller.memory()), (RedesignKind::Lqg, 3));
    let DiscreteController { a, b, c, d } = &found.controller;
    for (found, wanted) in [(a, &wanted.a), (b, &wanted.b), (c, &wanted.c), (d, &wanted.d)] {
        close(found, wanted);
    }
}

#[test]
fn losses_that_almost_never_happen_change_nothing() {
    let mut random = Random(7);
    let linear = open(&plant(&mut random, [2, 1, 2]), 0.01);
    let mut timing = linear.ideal();
    timing.input_latency.fill(Latency::of_steps(1.3).unwrap());
    let plain = linear.redesign(&timing).unwrap();
    timing.loss = 1e-9;
    let drawn = linear.redesign(&timing).unwrap();
    assert_eq!((plain.kind, drawn.kind), (RedesignKind::Lqg, RedesignKind::Compensator));
    let off = drawn.cost / plain.cost - 1.0;
    assert!((0.0..1e-7).contains(&off), "{off}");
}

#[test]
fn no_combination_of_imperfections_makes_it_cost_more_than_a_design_that_ignores_them() {
    let a = Matrix::from_rows(&[[0.0, 1.0], [4.0, -0.3]]).unwrap();
    let b = Matrix::from_rows(&[[0.0], [1.0]]).unwrap();
    let c = Matrix::from_rows(&[[1.0, 0.0]]).unwrap();
    let position = LinearPlant::new(a, b, c, Matrix::zeros(1, 1)).unwrap();
    let gain = position.design_regulator(&weights(2, 1), PERIOD).unwrap().gain;
    let filter = position.design_filter(&Matrix::diagonal(&[0.01]), PERIOD).unwrap();
    for case in 0_u32..128 {
        let given = |bit: u32| case >> bit & 1 == 1;
        let late = |bit: u32, steps: f64| if given(bit) { steps } else { 0.0 };
        let (plant, controller, noise) = match given(0) {
            true => (position.clone(), position.estimated_feedback(&gain, &filter, PERIOD), 0.01),
            false => {
                let controller = DiscreteController::gain(gain.scaled(-1.0));
                (position.clone().with_all_states_measured(), controller, 0.0)
            }
        };
        let plant = match given(1) {
            true => plant.with_input_part(0, ChannelPart::Lag(0.02), "lag").unwrap(),
            false => plant,
        };
        let (n, p) = (plant.states.len(), plant.outputs.len());
        let mut form = Matrix::zeros(n + 1, n + 1);
        form.set_block((0, 0), &Matrix::identity(2));
        form[(n, n)] = 0.2;
        let linear = LinearLoop::new(plant, controller, PERIOD, form, vec![noise; p]).unwrap();
        let mut timing = linear.ideal();
        timing.input_latency.fill(Latency::of_steps(late(2, 0.3)).unwrap());
        timing.output_latency.fill(Latency::of_steps(late(3, 0.4)).unwrap());
        timing.jitter = Jitter::Gaussian(late(4, 0.05));
        timing.skew = late(5, 0.03);
        timing.loss = late(6, 0.02);
        let redesign = linear.redesign(&timing).unwrap();
        let random = given(4) || given(6);
        // A lag, a latency of measurements, noise, or a command that is lost on its late way.
        let filters = given(0) || given(1) || given(3) || given(6) && given(2);
        let kind = match (filters, random) {
            (false, false) => RedesignKind::StateFeedback,
            (false, true) => RedesignKind::RandomStateFeedback,
            (true, false) => RedesignKind::Lqg,
            (true, true) => RedesignKind::Compensator,
        };
        assert_eq!(redesign.kind, kind, "{case:b}");
        let before = cost(&linear, linear.controller(), &timing);
        let after = cost(&linear, &redesign.controller, &timing);
        // Where nothing is late they are the same design.
        assert!(after <= before * (1.0 + 1e-6), "{case:b}: {after} {before}");
    }
}

#[test]
fn loops_that_no_filter_or_regulator_can_serve_are_refused_by_name() {
    let a = Matrix::from_rows(&[[0.0, 0.0], [1.0, 0.0]]).unwrap();
    let b = Matrix::from_rows(&[[1.0], [0.0]]).unwrap();
    let c = Matrix::from_rows(&[[0.0, 1.0]]).unwrap();
    let plant = LinearPlant::new(a, b, c, Matrix::zeros(1, 1)).unwrap();
    let refused = |plant: &LinearPlant| {
        let linear = open(plant, 0.01);
        linear.redesign(&linear.ideal()).unwrap_err().to_string()
    };
    let silent = plant.clone().with_noise(Matrix::zeros(2, 1)).unwrap();
    assert!(refused(&silent).contains("no noise drives the plant"));
    // Noise moves the second state alone; the first is an integrator of nothing.
    let quiet = plant.clone().with_noise(Matrix::from_rows(&[[0.0], [1.0]]).unwrap()).unwrap();
    let message = refused(&quiet);
    assert!(message.contains("no noise drives the mode of x1"), "{message}");
    let blind = LinearPlant { c: Matrix::from_rows(&[[1.0, 0.0]]).unwrap(), ..plant.clone() };
    let message = refused(&blind);
    assert!(message.contains("no output shows the mode of x2"), "{message}");
    let linear = open(&plant, 0.01);
    let mut timing = linear.ideal();
    timing.input_latency.fill(Latency::of_steps(200.0).unwrap());
    let message = linear.redesign(&timing).unwrap_err().to_string();
    assert!(message.contains("expected at most 300"), "{message}");
}
