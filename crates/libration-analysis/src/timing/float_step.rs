//! Steps of a plant in `f64`, whole or split.

use libration_core::number::Wide;
use libration_core::{Scalar, State};
use libration_linear::{Discretisation, LinearPlant, Matrix, Signal};

use super::{Plant, ZohStep};

impl Plant<'_> {
    /// `A` and `B` of the plant, `ẏ = Ay + Bu` with `y = (q, v)`.
    pub(super) fn matrices(&self) -> [Matrix; 2] {
        let [aq, av] = [0, 1].map(|j| self.generator.entry(1, j).to_f64());
        let a = Matrix::from_fn(2, 2, |i, j| [[0.0, 1.0], [aq, av]][i][j]);
        [a, Matrix::from_fn(2, 1, |i, _| [0.0, 1.0][i])]
    }

    /// The plant in matrices, with the states and outputs `q` and `v`, the input `u`, and noise that accelerates it.
    pub fn linear(&self) -> LinearPlant {
        let [a, b] = self.matrices();
        let signals = |names: &[&str]| names.iter().map(|name| Signal::new(name, "")).collect();
        LinearPlant {
            a,
            g: b.clone(),
            b,
            c: Matrix::identity(2),
            d: Matrix::zeros(2, 1),
            sampling_period: None,
            has_first_order_states: false,
            states: signals(&["q", "v"]),
            inputs: signals(&["u"]),
            outputs: signals(&["q", "v"]),
        }
    }

    /// A step of `seconds`, from one phase to another.
    pub(super) fn float_step(&self, seconds: f64, [from, to]: [f64; 2]) -> Discretisation {
        if self.flows {
            // The exponential in 1024 bits takes a thousand times as long, and hundreds of lengths may be used.
            let [a, b] = self.matrices();
            return Discretisation::exact(&a, &b, (to - from) * seconds);
        }
        let dt = Wide::from_f64(seconds);
        let ZohStep { phi, gamma } = match (from == 0.0, to == 1.0) {
            (true, true) => (self.step)(dt),
            (true, false) => self.before(to, dt),
            _ => self.after(from, dt),
        };
        Discretisation {
            phi: Matrix::from_fn(2, 2, |i, j| phi.entry(i, j).to_f64()),
            gamma: Matrix::from_fn(2, 1, |i, _| numbers(&gamma)[i]),
        }
    }
}

fn numbers(state: &State<Wide, 1>) -> [f64; 2] {
    [state.q[0], state.v[0]].map(Wide::to_f64)
}

#[cfg(test)]
mod tests {
    use libration_core::system::DampedOscillator;

    use super::super::latency::SplitStep;
    use super::super::sample::ORIGIN;
    use super::*;

    #[test]
    fn floats_are_those_of_the_exponential_in_1024_bits() {
        for (omega2, gamma) in [(10.0, 0.3), (-4.0, 0.0), (0.0, 2.0), (400.0, -1.0)] {
            let plant = Plant::exact(DampedOscillator { omega2, gamma }, ORIGIN, 0.1);
            for part in [0.0, 0.3] {
                let SplitStep { phi, old, new } = plant.split(part, Wide::from_f64(0.13));
                let after = plant.float_step(0.13, [part, 1.0]);
                let found = match part {
                    0.0 => after.clone(),
                    _ => plant.float_step(0.13, [0.0, part]).then(&after),
                };
                let wide = |i: usize, j: usize| phi.entry(i, j).to_f64();
                let wanted = Matrix::from_fn(2, 2, wide);
                let size = wanted.largest().max(1.0);
                // Six squarings, of each of two steps, double what rounding leaves.
                let close = |x: f64, y: f64| (x - y).abs() < 3e-14 * size;
                for (x, y) in found.phi.entries().iter().zip(wanted.entries()) {
                    assert!(close(*x, *y), "{omega2} {gamma} {part}: {x} {y}");
                }
                for i in 0..2 {
                    let [old, new] = [&old, &new].map(|gamma| numbers(gamma)[i]);
                    assert!(close(after.gamma[(i, 0)], new));
                    assert!(close(found.gamma[(i, 0)], old + new));
                }
            }
        }
    }
}
