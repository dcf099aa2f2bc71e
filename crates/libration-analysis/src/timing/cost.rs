//! The stationary cost of a loop under noise.

use libration_core::control::LqrWeights;
use libration_linear::{Averages, MOST_TURN, RandomStages, Stage};

use super::imperfections::{MOST_RANDOM, MOST_REPEATED};
use super::stages::Stages;
use super::{CostError, Imperfections, LinearController, Plant};

impl Plant<'_> {
    /// The weights of the energy of what moves, `½(ω²q² + v²)`, where a spring with `ω²` pulls back; those of `½v²` where none does.
    pub fn energy(&self) -> LqrWeights {
        let stiffness = -self.generator.entry(1, 0).to_f64();
        LqrWeights { position: stiffness.max(0.0) / 2.0, velocity: 0.5, command: 0.0 }
    }

    /// The stationary cost of the loop that `controller` closes, per second, under white noise of the acceleration of unit
    /// intensity: the mean of `position·q² + velocity·v² + command·u²` with the weights. Infinite where second moments grow.
    ///
    /// Second moments of state, controller and waiting commands solve `P = E[M P Mᵀ] + W`, with the step `M`, which is drawn for
    /// itself each time, and what noise adds in it. Of exact steps, noise and cost are integrals over continuous time (B. Lincoln,
    /// A. Cervin, *Jitterbug: a tool for analysis of real-time control performance*, IEEE Conference on Decision and Control 2002).
    /// Of an integrator the noise is an acceleration of variance `1/h` that is held through a step of `h` seconds, as
    /// [`WhiteNoise`](libration_core::control::WhiteNoise) is, and the state at the beginning of a step counts for it: what a
    /// simulation measures. It is in `f64`; ten digits are right unless the loop is near the edge of stability.
    ///
    /// # Errors
    /// [`CostError`]: numbers that cannot be, or a loop that is too large.
    pub fn cost(
        &self,
        controller: &LinearController,
        imperfections: &Imperfections,
        weights: LqrWeights,
    ) -> Result<f64, CostError> {
        let stages = self.stages(controller, imperfections, Some(weights))?;
        let drawn = RandomStages::new(&stages);
        if !drawn.is_stable() {
            return Ok(f64::INFINITY);
        }
        let moments = drawn.moments(Stage::mean_noise(&stages));
        let (mut cost, mut length) = (0.0, 0.0);
        for stage in &stages {
            cost += stage.weight * stage.expected(&moments);
            length += stage.weight * stage.length;
        }
        let cost = cost / length;
        // Beyond the edge of stability, by less than the growth can tell, a form turns negative.
        Ok(if cost >= 0.0 { cost } else { f64::INFINITY })
    }

    /// The rate at which second moments grow in a step of the loop that `controller` closes: the logarithm of the spectral radius of
    /// `E[M ⊗ M]`. Some 13 digits are right, but only 3 where the largest eigenvalues meet, as at critical damping.
    ///
    /// # Errors
    /// [`CostError`], as for [`Plant::cost`].
    pub fn mean_square_growth(
        &self,
        controller: &LinearController,
        imperfections: &Imperfections,
    ) -> Result<f64, CostError> {
        Ok(RandomStages::new(&self.stages(controller, imperfections, None)?).growth())
    }

    /// Whether that is below zero, which is known sooner: the loop is stable in the mean square, and its cost is finite.
    ///
    /// # Errors
    /// [`CostError`], as for [`Plant::cost`].
    pub fn mean_square_stable(
        &self,
        controller: &LinearController,
        imperfections: &Imperfections,
    ) -> Result<bool, CostError> {
        Ok(RandomStages::new(&self.stages(controller, imperfections, None)?).is_stable())
    }

    /// The steps that the loop may take.
    pub(super) fn stages(
        &self,
        controller: &LinearController,
        imperfections: &Imperfections,
        weights: Option<LqrWeights>,
    ) -> Result<Vec<Stage>, CostError> {
        let Imperfections { jitter, skew, loss, .. } = *imperfections;
        let periods = self.periods(controller, imperfections, weights)?;
        let turn = 2.0 * self.turn(jitter) * (1.0 + skew);
        let dt = self.dt.to_f64() * (1.0 + skew);
        // One step, where all are alike: second moments of a large loop would take minutes.
        let nodes = if jitter.rms() > 0.0 { jitter.nodes(turn) } else { vec![(1.0, 0.0)] };
        let mut stages = Vec::new();
        for (weight, epsilon) in nodes {
            let arrives = [(1.0 - loss, false), (loss, true)];
            for (share, lost) in arrives.into_iter().filter(|(share, _)| *share > 0.0) {
                stages.push(periods.stage(weight * share, dt * (1.0 + epsilon), lost));
            }
        }
        Ok(stages)
    }

    /// The periods of the loop, after all numbers are checked.
    pub(super) fn periods<'p>(
        &'p self,
        controller: &LinearController,
        imperfections: &Imperfections,
        weights: Option<LqrWeights>,
    ) -> Result<Stages<'p>, CostError> {
        let Imperfections { jitter, skew, loss, .. } = *imperfections;
        if let Some(LqrWeights { position, velocity, command }) = weights {
            let all = [("position", position), ("velocity", velocity), ("command", command)];
            if let Some((of, weight)) = all.into_iter().find(|(_, x)| !(x.is_finite() && *x >= 0.0))
            {
                return Err(CostError::Weight { of, weight });
            }
        }
        if !(0.0..1.0).contains(&loss) {
            return Err(CostError::Loss(loss));
        }
        if !(skew.is_finite() && skew > -1.0) {
            return Err(CostError::Skew(skew));
        }
        let periods = Stages::new(self, controller, imperfections, weights);
        let size = periods.size();
        let most = if imperfections.repeat() { MOST_REPEATED } else { MOST_RANDOM };
        if size > most {
            return Err(CostError::Size { size });
        }
        let turn = 2.0 * self.turn(jitter) * (1.0 + skew);
        if turn.is_nan() || turn > MOST_TURN {
            return Err(CostError::Turn);
        }
        Ok(periods)
    }
}

#[cfg(test)]
mod tests {
    use libration_core::control::{Feedback, Jitter, Latency, RandomLatency};
    use libration_core::system::Oscillator;

    use super::super::sample::{ORIGIN, textbook};
    use super::*;

    const MODEL: Oscillator<f64> = Oscillator { omega2: 10.0 };
    const GAINS: Feedback = Feedback { position: 10.0, velocity: 2.0 };
    /// `½(ω²x² + v²)`.
    const ENERGY: LqrWeights = LqrWeights { position: 5.0, velocity: 0.5, command: 0.0 };

    fn exact(dt: f64, latency: f64) -> f64 {
        let plant = Plant::exact(MODEL, ORIGIN, dt);
        let latency = Latency::of_steps(latency).unwrap();
        let imperfections = Imperfections { latency, ..Imperfections::NONE };
        plant.cost(&GAINS.into(), &imperfections, ENERGY).unwrap()
    }

    #[test]
    fn the_exact_sampled_loop_costs_what_the_reference_says() {
        // Twelve digits from a program that solved the Lyapunov equation on its own.
        assert!((exact(0.01, 0.0) - 0.193623221394).abs() < 1e-12);
        assert!((exact(0.1, 0.0) - 0.271766741205).abs() < 1e-12);
        assert!((exact(0.01, 1.0) / exact(0.01, 0.0) - 1.0 - 0.069875502).abs() < 1e-9);
        // In continuous time E[v²] = 1/(2·2) and E[x²] = E[v²]/20: the rest falls in proportion to Δt.
        let [long, short] = [1e-3, 5e-4].map(|dt| exact(dt, 0.0) - 0.1875);
        assert!((2.0 * short - long).abs() < 1e-6 && short < 5e-4, "{long} {short}");
    }

    #[test]
    fn a_latency_of_a_part_of_a_step_lies_between_whole_ones() {
        let costs = [0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0].map(|latency| exact(0.01, latency));
        assert!(costs.is_sorted(), "{costs:?}");
        // As the part goes to nothing or to all the loop becomes that of whole steps.
        for (near, whole) in [(1e-9, 0.0), (1.0 - 1e-9, 1.0), (1.0 + 1e-9, 1.0)] {
            let (near, whole) = (exact(0.01, near), exact(0.01, whole));
            assert!((near / whole - 1.0).abs() < 1e-8, "{near} {whole}");
        }
    }

    #[test]
    fn every_integrator_costs_what_exact_steps_do_as_they_become_short() {
        let cost =
            |plant: &Plant<'_>| plant.cost(&GAINS.into(), &Imperfections::NONE, ENERGY).unwrap();
        for (name, plant) in textbook(MODEL, 1e-4) {
            // The feedback holds for a step, and a step counts as its beginning: errors of some steps' length.
            assert!((cost(&plant) / 0.1875 - 1.0).abs() < 3e-3, "{name}: {}", cost(&plant));
        }
    }

    #[test]
    fn steps_that_are_drawn_and_steps_that_repeat_agree_where_there_is_nothing_to_draw() {
        for (name, plant) in textbook(MODEL, 0.05) {
            for steps in [0.0, 0.4, 2.0, 2.3] {
                let latency = Latency::of_steps(steps).unwrap();
                let at = |jitter, loss| {
                    let imperfections = Imperfections { latency, jitter, loss, skew: 0.0 };
                    plant.cost(&GAINS.into(), &imperfections, ENERGY).unwrap()
                };
                let none = at(Jitter::Gaussian(0.0), 0.0);
                for (jitter, loss) in [
                    (Jitter::Gaussian(1e-9), 0.0),
                    (Jitter::Uniform(1e-9), 0.0),
                    (Jitter::Gaussian(0.0), 1e-12),
                ] {
                    let found = at(jitter, loss);
                    let alike = found == none || (found / none - 1.0).abs() < 1e-9;
                    assert!(alike, "{name} {steps}: {found} {none}");
                }
            }
        }
    }

    #[test]
    fn what_is_unstable_costs_infinitely_much_and_only_that() {
        for (name, plant) in textbook(MODEL, 0.1) {
            let critical = plant.split_critical_latency(GAINS).unwrap_or(0.0);
            for (share, stable) in [(0.98, true), (1.02, false)] {
                let Some(latency) = Latency::of_steps(share * critical) else { continue };
                let imperfections = Imperfections { latency, ..Imperfections::NONE };
                let cost = plant.cost(&GAINS.into(), &imperfections, ENERGY).unwrap();
                assert_eq!(cost.is_finite(), stable && critical > 0.0, "{name} {share}: {cost}");
            }
        }
        // A spring that nothing damps takes up noise for ever.
        let free = Plant::exact(MODEL, ORIGIN, 0.1);
        let none = Feedback::default().into();
        assert_eq!(free.cost(&none, &Imperfections::NONE, ENERGY), Ok(f64::INFINITY));
    }

    #[test]
    fn growth_is_that_of_the_table_of_latencies() {
        for (name, plant) in textbook(MODEL, 0.1) {
            for steps in [0.0, 1.0, 1.5] {
                let table = RandomLatency::new(vec![(steps, 1.0)], 0.0).unwrap();
                let latency = Latency::of_steps(steps).unwrap();
                let imperfections = Imperfections { latency, ..Imperfections::NONE };
                let found = plant.mean_square_growth(&GAINS.into(), &imperfections).unwrap();
                let wanted = plant.mean_square_late(GAINS, &table).ln();
                assert!((found - wanted).abs() < 1e-12, "{name}: {found} {wanted}");
            }
        }
    }

    #[test]
    fn numbers_that_cannot_be_are_refused_in_words() {
        let plant = Plant::exact(MODEL, ORIGIN, 0.1);
        let refused = |imperfections: Imperfections, weights| {
            plant.cost(&GAINS.into(), &imperfections, weights).unwrap_err().to_string()
        };
        let none = Imperfections::NONE;
        let negative = LqrWeights { velocity: -1.0, ..ENERGY };
        assert!(refused(none, negative).contains("weight of the velocity is -1"));
        assert!(refused(Imperfections { loss: 1.0, ..none }, ENERGY).contains("lost is 1"));
        assert!(refused(Imperfections { skew: -1.0, ..none }, ENERGY).contains("skew is -1"));
        let latency = Latency::of_steps(1000.0).unwrap();
        assert!(refused(Imperfections { latency, ..none }, ENERGY).contains("1002 numbers"));
        let jitter = Jitter::Gaussian(1e6);
        assert!(refused(Imperfections { jitter, ..none }, ENERGY).contains("2048 rad"));
    }
}
