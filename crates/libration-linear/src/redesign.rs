//! Regulators of a plant with commands under way.

use libration_core::control::Latency;

use crate::{
    Arrival, DesignError, DiscreteController, Dynamics, Layout, LinearPlant, Matrix, Period,
    RegulatorProblem, Transit, is_schur_stable,
};

impl LinearPlant {
    /// The regulator of least cost for inputs with these latencies, in periods of `period` seconds: feedback of all states, which are
    /// measured without latency, and of the commands under way. The cost rate is the form `cost` of states and inputs.
    ///
    /// The commands under way are states of a larger plant, for which the regulator is designed: exactly, also for parts of a period
    /// (K. J. Åström, B. Wittenmark, *Computer-Controlled Systems*, 3rd ed., 1997).
    ///
    /// # Errors
    /// [`DesignError::Unsettled`]: no feedback stabilises the plant in steps of this period, or the loop of least cost is too close to
    /// the edge of stability.
    pub fn design_latency_regulator(
        &self,
        cost: &Matrix,
        latency: &[Latency],
        period: f64,
    ) -> Result<DiscreteController, DesignError> {
        let plant = self.clone().with_all_states_measured();
        let (n, m) = (plant.states.len(), plant.inputs.len());
        let problem = plant.delayed_problem(cost, latency, period);
        let stable = |gain: &Matrix| is_schur_stable(&problem.closed(gain));
        // Commands that act later cost nothing at once.
        let length = if plant.sampling_period.is_some() { 1.0 } else { period };
        let price = cost.block((n, n), (m, m)).scaled(length);
        let gain = problem.solve_from(&price).map(|solution| solution.gain).filter(stable);
        let gain = gain.ok_or(DesignError::Unsettled("regulator"))?;
        // The commands in transit of each input, and the one that acts at the beginning if the step splits.
        let under_way: Vec<usize> = latency
            .iter()
            .map(|late| late.whole() as usize + usize::from(late.part() > 0.0))
            .collect();
        let memory = under_way.iter().sum();
        let mut controller = DiscreteController {
            a: Matrix::zeros(memory, memory),
            b: Matrix::zeros(memory, n),
            c: Matrix::zeros(m, memory),
            d: gain.block((0, 0), (m, n)).scaled(-1.0),
        };
        // In the larger plant commands in transit come first, then those that act.
        let layout = plant.delayed_layout(latency);
        let mut first = 0;
        let mut starts = Vec::new();
        for (i, &count) in under_way.iter().enumerate() {
            starts.push(first);
            for k in 0..count {
                let place = match layout.commands(i).nth(k) {
                    Some(place) => place,
                    None => layout.acting(i),
                };
                // The memory that makes commands is no coordinate of the problem.
                for row in 0..m {
                    controller.c[(row, first + k)] = -gain[(row, place - m)];
                }
            }
            first += count;
        }
        for (i, &count) in under_way.iter().enumerate().filter(|(_, count)| **count > 0) {
            let start = starts[i];
            let (c, d) = (controller.c.row(i).to_vec(), controller.d.row(i).to_vec());
            controller.a.row_mut(start).copy_from_slice(&c);
            controller.b.row_mut(start).copy_from_slice(&d);
            (1..count).for_each(|k| controller.a[(start + k, start + k - 1)] = 1.0);
        }
        Ok(controller)
    }

    fn delayed_layout(&self, latency: &[Latency]) -> Layout {
        let (n, m) = (self.states.len(), self.inputs.len());
        let inputs: Vec<Transit> =
            latency.iter().map(|&late| Transit::of_commands(late, false)).collect();
        Layout::new([n, m, 0], &inputs, &vec![Transit { count: 0, acts_on: false }; n])
    }

    /// The regulator problem of states and commands under way. A memory of the size of the inputs stands for the commands.
    fn delayed_problem(&self, cost: &Matrix, latency: &[Latency], period: f64) -> RegulatorProblem {
        let (n, m) = (self.states.len(), self.inputs.len());
        let layout = self.delayed_layout(latency);
        let pass = DiscreteController {
            a: Matrix::zeros(m, m),
            b: Matrix::zeros(m, n),
            c: Matrix::identity(m),
            d: Matrix::zeros(m, n),
        };
        let noise = Matrix::zeros(n, n);
        let step = |_: f64, _: [f64; 2]| self.step(period);
        let dynamics = match self.sampling_period {
            None => Dynamics::Exact { a: &self.a, b: &self.b, noise: &noise },
            Some(_) => Dynamics::Stepped { step: &step, noises: 0, white: false },
        };
        let whole = Period {
            dynamics,
            outputs: [&self.c, &self.d],
            controller: &pass,
            layout: &layout,
            output_latency: &vec![Latency::NONE; n],
            output_noise: &vec![0.0; n],
            cost: Some(cost),
        };
        let arrivals: Vec<Arrival> =
            latency.iter().map(|&latency| Arrival { latency, lost: None }).collect();
        let stage = whole.stage(1.0, period, &arrivals);
        let size = layout.size();
        let kept: Vec<usize> = (0..n).chain(n + m..size).collect();
        let made: Vec<usize> = (n..n + m).collect();
        let of = |matrix: &Matrix, rows: &[usize], columns: &[usize]| {
            Matrix::from_fn(rows.len(), columns.len(), |i, j| matrix[(rows[i], columns[j])])
        };
        RegulatorProblem {
            a: of(&stage.step, &kept, &kept),
            b: of(&stage.step, &kept, &made),
            q: of(&stage.cost, &kept, &kept),
            s: of(&stage.cost, &kept, &made),
            r: of(&stage.cost, &made, &made),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CostWeights, LinearLoop, Signal};

    fn pendulum() -> LinearPlant {
        let a = Matrix::from_rows(&[[0.0, 1.0], [6.0, -0.1]]).unwrap();
        let b = Matrix::from_rows(&[[0.0], [2.0]]).unwrap();
        LinearPlant::new(a, b, Matrix::identity(2), Matrix::zeros(2, 1)).unwrap()
    }

    fn weights() -> CostWeights {
        CostWeights { states: Matrix::diagonal(&[5.0, 1.0]), inputs: Matrix::diagonal(&[0.3]) }
    }

    #[test]
    fn without_latency_it_is_the_plain_regulator() {
        let plain = pendulum().design_regulator(&weights(), 0.05).unwrap().gain;
        let found = pendulum().design_latency_regulator(&weights().form(), &[Latency::NONE], 0.05);
        let found = found.unwrap();
        assert_eq!(found.memory(), 0);
        for (found, plain) in found.d.entries().iter().zip(plain.entries()) {
            assert!((found + plain).abs() < 1e-12 * plain.abs(), "{found} {plain}");
        }
    }

    #[test]
    fn no_other_gain_nearby_costs_less_with_the_latency_there_is() {
        for steps in [0.4, 1.0, 2.7] {
            let latency = Latency::of_steps(steps).unwrap();
            let form = weights().form();
            let best = pendulum().design_latency_regulator(&form, &[latency], 0.05).unwrap();
            let cost = |controller: &DiscreteController| {
                let plant = pendulum();
                let own = form.clone();
                let linear = LinearLoop::new(plant, controller.clone(), 0.05, own, vec![0.0; 2]);
                let linear = linear.unwrap();
                let mut timing = linear.ideal();
                timing.input_latency = vec![latency];
                linear.stationary(&timing).unwrap().map_or(f64::INFINITY, |found| found.cost)
            };
            let least = cost(&best);
            assert!(least.is_finite(), "{steps}");
            let mut tried = 0;
            for factor in [0.99, 1.01] {
                // Of a command, what it is made of and what is remembered of it are the same.
                for j in 0..2 {
                    let mut other = best.clone();
                    other.d[(0, j)] *= factor;
                    other.b[(0, j)] *= factor;
                    assert!(cost(&other) > least, "{steps} {j}");
                    tried += 1;
                }
                for j in 0..best.memory() {
                    let mut other = best.clone();
                    other.c[(0, j)] *= factor;
                    other.a[(0, j)] *= factor;
                    assert!(cost(&other) > least, "{steps} {j}");
                    tried += 1;
                }
            }
            assert!(tried >= 6);
        }
    }

    #[test]
    fn a_latency_of_several_inputs_is_designed_for_input_by_input() {
        let mass = Matrix::diagonal(&[1.0, 2.0]);
        let zero = Matrix::zeros(2, 2);
        let stiffness = Matrix::from_rows(&[[8.0, -3.0], [-3.0, 3.0]]).unwrap();
        let names = Signal::numbered("q", 2);
        let plant =
            LinearPlant::mechanical([&mass, &zero, &stiffness], &Matrix::identity(2), &names)
                .unwrap();
        let weights = CostWeights { states: Matrix::identity(4), inputs: Matrix::identity(2) };
        let latency = [1.3, 0.0].map(|steps| Latency::of_steps(steps).unwrap());
        let form = weights.form();
        let aware = plant.design_latency_regulator(&form, &latency, 0.2).unwrap();
        let plain = plant.design_regulator(&weights, 0.2).unwrap().gain;
        let cost = |controller: DiscreteController| {
            let measured = plant.clone().with_all_states_measured();
            let linear = LinearLoop::new(measured, controller, 0.2, form.clone(), vec![0.0; 4]);
            let linear = linear.unwrap();
            let mut timing = linear.ideal();
            timing.input_latency = latency.to_vec();
            linear.stationary(&timing).unwrap().map_or(f64::INFINITY, |found| found.cost)
        };
        let (aware, plain) = (cost(aware), cost(DiscreteController::gain(plain.scaled(-1.0))));
        assert!(aware < plain, "{aware} {plain}");
    }
}
