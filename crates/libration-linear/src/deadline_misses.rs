//! Loops that miss deadlines in the worst allowed sequence.

use crate::{
    LinearLoop, LinearLoopError, LoopTiming, Matrix, MissConstraint, OverrunStrategy,
    PeriodOutcome, SearchEnd, SwitchedSystem, Verdict,
};

/// Bounds of the growth of a loop that misses deadlines.
#[derive(Clone, Debug, PartialEq)]
pub struct MissBounds {
    /// At least this factor per period: what `sequence` over and over grows by.
    pub lower: f64,
    /// At most this factor per period.
    pub upper: f64,
    /// The worst sequence that was found.
    pub sequence: Vec<PeriodOutcome>,
    /// Whether all motions decay in every allowed sequence.
    pub verdict: Verdict,
}

/// Most states of a loop that misses deadlines.
const MOST_STATES: usize = 60;

impl LinearLoop {
    /// Bounds on the growth per period in the worst of all sequences that `constraint` allows, with the latencies and the skew of
    /// `timing`, and without its jitter and losses.
    ///
    /// The commands of a job that overruns take over with the latency of each input, counted from the period in which it is finished.
    /// The search ends once the bounds are as close as `width`, or with `once_decided` on the same side of 1.
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing, or a loop that is too large.
    pub fn miss_bounds(
        &self,
        timing: &LoopTiming,
        strategy: OverrunStrategy,
        constraint: MissConstraint,
        width: f64,
        once_decided: bool,
    ) -> Result<MissBounds, LinearLoopError> {
        let mut matrices = Vec::new();
        let mut kinds = Vec::new();
        for running in [false, true] {
            for missed in [false, true] {
                for &outcome in strategy.outcomes(running, missed) {
                    matrices.push(self.overrun_matrix(timing, strategy, running, outcome)?);
                    kinds.push((running, missed, outcome));
                }
            }
        }
        let size = matrices[0].rows();
        if size > MOST_STATES {
            return Err(LinearLoopError::Size { size, most: MOST_STATES });
        }
        let of = |running, missed| {
            let fits = |i: &usize| (kinds[*i].0, kinds[*i].1) == (running, missed);
            (0..kinds.len()).filter(fits).collect()
        };
        let (nodes, transitions) = constraint.graph(of);
        let system = SwitchedSystem::new(matrices, nodes, transitions);
        let system = system.map_err(|_| LinearLoopError::Range)?;
        // Three windows show how they follow each other.
        let longest_cycle = (3 * constraint.window() as usize).clamp(12, 40);
        let found = system.growth_bounds(&SearchEnd { width, once_decided, longest_cycle });
        let outcome = |&transition: &usize| kinds[system.transitions()[transition].matrix].2;
        Ok(MissBounds {
            lower: found.lower,
            upper: found.upper,
            sequence: longest_run_first(found.cycle.iter().map(outcome).collect()),
            verdict: found.verdict(),
        })
    }

    /// The matrix of a period with this outcome.
    fn overrun_matrix(
        &self,
        timing: &LoopTiming,
        strategy: OverrunStrategy,
        running: bool,
        outcome: PeriodOutcome,
    ) -> Result<Matrix, LinearLoopError> {
        let activity = strategy.activity(running, outcome);
        let own = self.only_controller("missed deadlines")?;
        let controller = own.overrunning(strategy, timing.missing, activity);
        self.with_controller(controller)?.period_matrix(timing)
    }
}

/// The same cycle, from its longest run of missed deadlines on.
fn longest_run_first(cycle: Vec<PeriodOutcome>) -> Vec<PeriodOutcome> {
    let rotated = (0..cycle.len()).map(|first| {
        let mut cycle = cycle.clone();
        cycle.rotate_left(first);
        cycle
    });
    let missed = |cycle: &Vec<PeriodOutcome>| -> Vec<bool> {
        cycle.iter().map(|outcome| *outcome != PeriodOutcome::Met).collect()
    };
    rotated.max_by_key(missed).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use libration_core::control::Latency;

    use super::*;
    use crate::{DiscreteController, LinearPlant, MissingCommand};

    /// `x' = e x + ∫e u` once per period of 1 s under `u = −gain·x`.
    fn scalar(growth: f64, gain: f64) -> LinearLoop {
        let one = |x: f64| Matrix::diagonal(&[x]);
        let plant = LinearPlant::new(one(growth), one(1.0), one(1.0), one(0.0)).unwrap();
        let controller = DiscreteController::gain(one(-gain));
        LinearLoop::new(plant, controller, 1.0, Matrix::identity(2), vec![0.0]).unwrap()
    }

    fn bounds(
        linear: &LinearLoop,
        timing: &LoopTiming,
        strategy: OverrunStrategy,
        (misses, window): (u32, u32),
    ) -> MissBounds {
        let constraint = MissConstraint::new(misses, window).unwrap();
        linear.miss_bounds(timing, strategy, constraint, 1e-3, false).unwrap()
    }

    #[test]
    fn a_killed_job_of_a_plant_with_one_state_costs_its_open_loop_growth() {
        let (growth, gain) = (0.3_f64, 0.8);
        let linear = scalar(growth, gain);
        let timing = LoopTiming { missing: MissingCommand::Zero, ..linear.ideal() };
        let open = growth.exp();
        let closed = open - gain * growth.exp_m1() / growth;
        for (misses, window) in [(0, 1), (1, 2), (2, 5), (3, 4)] {
            let found = bounds(&linear, &timing, OverrunStrategy::Kill, (misses, window));
            // All sequences commute: as many misses as are allowed are the worst.
            let share = f64::from(misses) / f64::from(window);
            let wanted = open.powf(share) * closed.abs().powf(1.0 - share);
            assert!((found.lower / wanted - 1.0).abs() < 1e-12, "{found:?} {wanted}");
            assert!(wanted <= found.upper && found.upper < 1.0011 * wanted, "{found:?} {wanted}");
            let missed = found.sequence.iter().filter(|x| **x == PeriodOutcome::Missed).count();
            assert_eq!(missed * window as usize, found.sequence.len() * misses as usize);
        }
    }

    #[test]
    fn the_strategies_are_those_of_closed_forms_for_a_plant_with_one_state() {
        let (growth, gain) = (0.2_f64, 0.7);
        let linear = scalar(growth, gain);
        let (phi, gamma) = (growth.exp(), growth.exp_m1() / growth);
        let radius = |rows: &[&[f64]]| {
            let matrix = Matrix::from_rows(rows).unwrap();
            crate::log_spectral_radius(&matrix).exp()
        };
        // Over the sequence met, missed on the state and the command that acts.
        let closed = phi - gamma * gain;
        let held = phi * closed - gamma * gain;
        let wanted = [
            // The command is held for two periods.
            (OverrunStrategy::Kill, MissingCommand::Hold, held.abs()),
            (OverrunStrategy::Kill, MissingCommand::Zero, (phi * closed).abs()),
            // The job of the missed period x = (x, u) ends in the next one, with u' = −gain·x, under the command before: x₁ = φx + γu,
            // x₂ = φx₁ + γu'.
            (
                OverrunStrategy::Skip,
                MissingCommand::Hold,
                radius(&[&[phi * phi - gamma * gain, phi * gamma], &[-gain, 0.0]]),
            ),
            (OverrunStrategy::Skip, MissingCommand::Zero, (phi * phi - gamma * gain).abs()),
            // Of a queue it is the job of the next period that counts, with x₁.
            (
                OverrunStrategy::Queue,
                MissingCommand::Hold,
                radius(&[&[phi * closed, gamma * closed], &[-gain * phi, -gain * gamma]]),
            ),
            (OverrunStrategy::Queue, MissingCommand::Zero, (phi * closed).abs()),
        ];
        for (strategy, missing, wanted) in wanted {
            let timing = LoopTiming { missing, ..linear.ideal() };
            let product = [PeriodOutcome::Missed, PeriodOutcome::Met].into_iter().fold(
                None,
                |before: Option<Matrix>, outcome| {
                    let running = outcome == PeriodOutcome::Met;
                    let matrix = linear.overrun_matrix(&timing, strategy, running, outcome);
                    let matrix = matrix.unwrap();
                    Some(before.map_or(matrix.clone(), |before| &matrix * &before))
                },
            );
            let found = crate::log_spectral_radius(&product.unwrap()).exp();
            assert!(
                (found / wanted - 1.0).abs() < 1e-12,
                "{strategy:?} {missing:?}: {found} {wanted}"
            );
            // The worst sequence is no better.
            let worst = bounds(&linear, &timing, strategy, (1, 2));
            assert!(worst.lower >= wanted.sqrt() * (1.0 - 1e-12), "{worst:?} {wanted}");
        }
    }

    #[test]
    fn commands_that_act_a_period_later_are_those_of_the_lifted_matrices_of_seidel() {
        // M. Seidel, M. Maggio, F. Allgöwer, A controller synthesis framework for weakly-hard control systems, 2026, figure 2: a period
        // that is met together with α that are missed, on the state and the command that acts.
        let rows = |rows: &[[f64; 2]]| Matrix::from_rows(rows).unwrap();
        let (a, b) =
            (rows(&[[0.0, 1.0], [9.0, -0.4]]), Matrix::from_rows(&[[0.0], [1.0]]).unwrap());
        let gain = rows(&[[14.0, 4.5]]).scaled(-1.0);
        let h = 0.05;
        let plant =
            LinearPlant::new(a.clone(), b.clone(), Matrix::identity(2), Matrix::zeros(2, 1));
        let controller = DiscreteController::gain(gain.clone());
        let cost = Matrix::identity(3);
        let linear = LinearLoop::new(plant.unwrap(), controller, h, cost, vec![0.0; 2]).unwrap();
        let step = crate::Discretisation::exact(&a, &b, h);
        let power = |n: usize| (0..n).fold(Matrix::identity(2), |power, _| &step.phi * &power);
        let sum = |n: usize| {
            (0..n).fold(Matrix::zeros(2, 1), |sum, i| sum.plus(&(&power(i) * &step.gamma)))
        };
        for missing in [MissingCommand::Hold, MissingCommand::Zero] {
            for strategy in [OverrunStrategy::Kill, OverrunStrategy::Skip] {
                for misses in 0..4 {
                    let holds = missing == MissingCommand::Hold;
                    let skips = strategy == OverrunStrategy::Skip;
                    let mut lifted = Matrix::zeros(3, 3);
                    lifted.set_block((0, 0), &power(misses + 1));
                    let before = match skips && holds {
                        true => sum(misses + 1),
                        false => &power(misses) * &step.gamma,
                    };
                    lifted.set_block((0, 2), &before);
                    if !skips && misses > 0 {
                        let after =
                            if holds { sum(misses) } else { &power(misses - 1) * &step.gamma };
                        let all = power(misses + 1).plus(&(&after * &gain));
                        lifted.set_block((0, 0), &all);
                    }
                    if skips || holds || misses == 0 {
                        lifted.set_block((2, 0), &gain);
                    }
                    let latency = vec![Latency::of_steps(1.0).unwrap()];
                    let timing = LoopTiming { input_latency: latency, missing, ..linear.ideal() };
                    let mut outcomes = vec![PeriodOutcome::Missed; misses];
                    outcomes.insert(if skips { misses } else { 0 }, PeriodOutcome::Met);
                    let (mut product, mut running) = (None, false);
                    for outcome in outcomes {
                        let matrix = linear.overrun_matrix(&timing, strategy, running, outcome);
                        let matrix = matrix.unwrap();
                        product = Some(product.map_or(matrix.clone(), |p: Matrix| &matrix * &p));
                        running = skips && outcome == PeriodOutcome::Missed;
                    }
                    let found = crate::log_spectral_radius(&product.unwrap());
                    let wanted = crate::log_spectral_radius(&lifted);
                    assert!((found - wanted).abs() < 1e-12, "{strategy:?} {missing:?} {misses}");
                }
            }
        }
    }

    #[test]
    fn more_misses_and_longer_runs_of_them_are_never_better() {
        let linear = scalar(0.4, 0.6);
        let latency = vec![Latency::of_steps(1.0).unwrap()];
        for strategy in [OverrunStrategy::Kill, OverrunStrategy::Skip, OverrunStrategy::Queue] {
            let timing = LoopTiming { input_latency: latency.clone(), ..linear.ideal() };
            let of = |constraint| bounds(&linear, &timing, strategy, constraint);
            let rows = [(0, 4), (1, 4), (1, 3), (1, 2), (2, 3), (3, 4)].map(of);
            for pair in rows.windows(2) {
                assert!(pair[0].lower <= pair[1].upper * (1.0 + 1e-12), "{strategy:?} {pair:?}");
            }
            assert_eq!(rows[0].verdict, Verdict::Stable);
            assert_eq!(rows[5].verdict, Verdict::Unstable);
        }
    }

    #[test]
    fn a_loop_that_is_too_large_is_refused() {
        let linear = scalar(0.1, 0.5);
        let latency = vec![Latency::of_steps(60.0).unwrap()];
        let timing = LoopTiming { input_latency: latency, ..linear.ideal() };
        let constraint = MissConstraint::new(1, 2).unwrap();
        let found = linear.miss_bounds(&timing, OverrunStrategy::Skip, constraint, 1e-3, true);
        assert_eq!(found, Err(LinearLoopError::Size { size: 63, most: 60 }));
    }
}
