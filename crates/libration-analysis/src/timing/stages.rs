//! The periods of a loop as matrices.

use libration_core::control::{Latency, LqrWeights};
use libration_linear::{
    Arrival, DiscreteController, Discretisation, Dynamics, Layout, Matrix, MissingCommand, Period,
    Stage, Transit,
};

use super::{Imperfections, LinearController, Plant};

/// The periods of a loop, whose plant has the outputs `q` and `v` without latency, and one input.
pub(super) struct Stages<'p> {
    plant: &'p Plant<'p>,
    a: Matrix,
    b: Matrix,
    controller: DiscreteController,
    layout: Layout,
    latency: Latency,
    /// The weights of position, velocity and command.
    cost: Option<Matrix>,
}

impl<'p> Stages<'p> {
    pub(super) fn new(
        plant: &'p Plant<'p>,
        controller: &LinearController,
        imperfections: &Imperfections,
        weights: Option<LqrWeights>,
    ) -> Self {
        let Imperfections { latency, loss, .. } = *imperfections;
        let transit = Transit::of_commands(latency, loss > 0.0);
        let cost = weights.map(|LqrWeights { position, velocity, command }| {
            Matrix::diagonal(&[position, velocity, command])
        });
        Self::in_transit(plant, controller.discrete(), transit, latency, cost)
    }

    /// With this room for commands.
    pub(super) fn in_transit(
        plant: &'p Plant<'p>,
        controller: DiscreteController,
        transit: Transit,
        latency: Latency,
        cost: Option<Matrix>,
    ) -> Self {
        let [a, b] = plant.matrices();
        let none = Transit { count: 0, acts_on: false };
        let noises = usize::from(!plant.exact);
        let layout = Layout::new([2, controller.memory(), noises], &[transit], &[none; 2]);
        Stages { plant, a, b, controller, layout, latency, cost }
    }

    /// The number of coordinates.
    pub(super) fn size(&self) -> usize {
        self.layout.size()
    }

    /// A period of `seconds`, in which the command arrives or is lost.
    pub(super) fn stage(&self, weight: f64, seconds: f64, lost: bool) -> Stage {
        self.arriving(
            weight,
            seconds,
            Arrival { latency: self.latency, lost: lost.then_some(MissingCommand::Hold) },
        )
    }

    pub(super) fn arriving(&self, weight: f64, seconds: f64, arrival: Arrival) -> Stage {
        // White noise of unit intensity accelerates the plant.
        let noise = Matrix::diagonal(&[0.0, 1.0]);
        let step = |seconds, phases| {
            let Discretisation { phi, gamma } = self.plant.float_step(seconds, phases);
            Discretisation { phi, gamma: Matrix::from_fn(2, 2, |i, _| gamma[(i, 0)]) }
        };
        let dynamics = match self.plant.exact {
            true => Dynamics::Exact { a: &self.a, b: &self.b, noise: &noise },
            false => Dynamics::Stepped { step: &step, noises: 1, white: true },
        };
        let [c, d] = [Matrix::identity(2), Matrix::zeros(2, 1)];
        let period = Period {
            dynamics,
            outputs: [&c, &d],
            controller: &self.controller,
            layout: &self.layout,
            output_latency: &[Latency::NONE; 2],
            output_noise: &[0.0; 2],
            cost: self.cost.as_ref(),
        };
        period.stage(weight, seconds, &[arrival])
    }
}

#[cfg(test)]
mod tests {
    use libration_core::control::{Feedback, Jitter, Latency, LqrWeights};
    use libration_core::system::Oscillator;

    use libration_linear::{Matrix, RandomStages, Stage, log_spectral_radius, mean_square};

    use super::super::sample::{ORIGIN, textbook};
    use super::super::{Imperfections, LinearController, Plant};

    const MODEL: Oscillator<f64> = Oscillator { omega2: 10.0 };
    const GAINS: Feedback = Feedback { position: 4.0, velocity: 1.0 };

    fn stages(plant: &Plant<'_>, imperfections: &Imperfections) -> Vec<Stage> {
        let weights = LqrWeights { position: 5.0, velocity: 0.5, command: 0.1 };
        plant.stages(&LinearController::from(GAINS), imperfections, Some(weights)).unwrap()
    }

    #[test]
    fn growth_and_moments_are_those_of_the_whole_operator() {
        for (name, plant) in textbook(MODEL, 0.1) {
            for steps in [0.0, 0.3, 1.0, 2.6, 4.0] {
                for (jitter, loss) in [
                    (Jitter::Gaussian(0.0), 0.2),
                    (Jitter::Uniform(0.3), 0.0),
                    (Jitter::Gaussian(0.2), 0.1),
                    (Jitter::Gaussian(0.8), 0.6),
                ] {
                    let latency = Latency::of_steps(steps).unwrap();
                    let stages =
                        stages(&plant, &Imperfections { latency, jitter, skew: 0.1, loss });
                    let drawn = RandomStages::new(&stages);
                    let wanted = log_spectral_radius(&mean_square(&stages));
                    let found = drawn.growth();
                    // Both are right to some 13 digits, where no eigenvalues meet.
                    let what = format!("{name} {steps} {jitter:?} {loss}: {found} {wanted}");
                    assert!((found - wanted).abs() < 1e-11, "{what}");
                    assert_eq!(drawn.is_stable(), wanted < 0.0, "{what}");
                    if wanted >= 0.0 {
                        continue;
                    }
                    // P = E[M P Mᵀ] + W, put in.
                    let n = stages[0].step.rows();
                    let mut noise = Matrix::zeros(n, n);
                    for (place, x) in [((0, 0), 0.3), ((1, 1), 1.0), ((0, 1), 0.1), ((1, 0), 0.1)] {
                        noise[place] = x;
                    }
                    let moments = drawn.moments(noise.clone());
                    let mut right = noise;
                    for stage in &stages {
                        right.add_scaled(stage.weight, &stage.step.congruence(&moments));
                    }
                    let size = moments.largest();
                    for (found, right) in moments.entries().iter().zip(right.entries()) {
                        assert!((found - right).abs() < 1e-12 * size, "{what}: {found} {right}");
                    }
                }
            }
        }
    }

    #[test]
    fn without_latency_growth_is_that_of_exact_moments() {
        for (name, plant) in textbook(MODEL, 0.1) {
            for law in [Jitter::Gaussian(0.1), Jitter::Uniform(0.3), Jitter::Gaussian(0.5)] {
                let exact = plant.mean_square(GAINS, law).radius.to_f64().ln();
                let drawn = Imperfections { jitter: law, ..Imperfections::NONE };
                let found = plant.mean_square_growth(&GAINS.into(), &drawn).unwrap();
                assert!((found - exact).abs() < 1e-13, "{name} {law:?}: {found} {exact}");
            }
        }
    }

    #[test]
    fn without_anything_drawn_it_is_twice_the_growth_of_the_loop() {
        for (name, plant) in textbook(MODEL, 0.1) {
            for steps in [1.0, 2.5, 3.0] {
                let latency = Latency::of_steps(steps).unwrap();
                let exact = 2.0 * plant.spectral_radius(GAINS, latency).to_f64().ln();
                for law in [Jitter::Uniform(0.0), Jitter::Uniform(1e-12)] {
                    let late = Imperfections { latency, jitter: law, ..Imperfections::NONE };
                    let found = plant.mean_square_growth(&GAINS.into(), &late).unwrap();
                    assert!((found - exact).abs() < 1e-12, "{name} {steps}: {found} {exact}");
                }
            }
        }
    }

    #[test]
    fn a_queue_of_sixty_commands_turns_damping_into_its_opposite() {
        let plant = Plant::exact(MODEL, ORIGIN, 0.01);
        let latency = Latency::of_steps(60.5).unwrap();
        let late = Imperfections { latency, jitter: Jitter::Gaussian(0.1), skew: 0.0, loss: 0.05 };
        // The spring turns by √10·0.61 = 1.9 rad meanwhile, more than a quarter of a turn.
        for (velocity, stable) in [(0.1, false), (-0.1, true)] {
            let gains = Feedback { position: 0.0, velocity };
            assert_eq!(plant.mean_square_stable(&gains.into(), &late), Ok(stable));
        }
    }
}
