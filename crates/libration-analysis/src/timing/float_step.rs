//! Steps of a plant in `f64`, with one command or with a change of commands.

use libration_core::number::Wide;
use libration_core::{Scalar, State};

use super::dense_matrix::exponential;
use super::latency::SplitStep;
use super::{Plant, ZohStep};

/// `y' = Φy + γ_old·u_old + γ_new·u_new`.
#[derive(Clone, Copy, Debug)]
pub(super) struct FloatSplitStep {
    pub(super) phi: [[f64; 2]; 2],
    pub(super) old: [f64; 2],
    pub(super) new: [f64; 2],
}

/// `y' = Φy + γu`.
#[derive(Clone, Copy, Debug)]
pub(super) struct FloatStep {
    pub(super) phi: [[f64; 2]; 2],
    pub(super) gamma: [f64; 2],
}

impl Plant<'_> {
    /// A step of `dt` seconds.
    pub(super) fn whole(&self, dt: Wide) -> FloatStep {
        if !self.flows {
            let ZohStep { phi, gamma } = (self.step)(dt);
            let phi = [0, 1].map(|i| [0, 1].map(|j| phi.entry(i, j).to_f64()));
            return FloatStep { phi, gamma: numbers(&gamma) };
        }
        // The exponential in 1024 bits takes a thousand times as long, and hundreds of lengths may be asked for.
        let h = dt.to_f64();
        let [aq, av] = [0, 1].map(|j| h * self.generator.entry(1, j).to_f64());
        let power = exponential(vec![vec![0.0, h, 0.0], vec![aq, av, h], vec![0.0; 3]]);
        let phi = [0, 1].map(|i| [0, 1].map(|j| power[i][j]));
        FloatStep { phi, gamma: [power[0][2], power[1][2]] }
    }

    /// A step of `dt` seconds that splits after a part of it.
    pub(super) fn split_in_floats(&self, part: f64, dt: Wide) -> FloatSplitStep {
        if !self.flows {
            let SplitStep { phi, old, new } = self.split(part, dt);
            let phi = [0, 1].map(|i| [0, 1].map(|j| phi.entry(i, j).to_f64()));
            return FloatSplitStep { phi, old: numbers(&old), new: numbers(&new) };
        }
        if part == 0.0 {
            let FloatStep { phi, gamma } = self.whole(dt);
            return FloatSplitStep { phi, old: [0.0; 2], new: gamma };
        }
        let first = dt * Wide::from_f64(part);
        let (before, after) = (self.whole(first), self.whole(dt - first));
        let apply = |x: [f64; 2]| after.phi.map(|row| row[0] * x[0] + row[1] * x[1]);
        let columns = [0, 1].map(|j| apply([before.phi[0][j], before.phi[1][j]]));
        let phi = [0, 1].map(|i| [0, 1].map(|j| columns[j][i]));
        FloatSplitStep { phi, old: apply(before.gamma), new: after.gamma }
    }
}

fn numbers(state: &State<Wide, 1>) -> [f64; 2] {
    [state.q[0], state.v[0]].map(Wide::to_f64)
}

#[cfg(test)]
mod tests {
    use libration_core::system::DampedOscillator;

    use super::super::sample::ORIGIN;
    use super::*;

    #[test]
    fn floats_are_those_of_the_exponential_in_1024_bits() {
        for (omega2, gamma) in [(10.0, 0.3), (-4.0, 0.0), (0.0, 2.0), (400.0, -1.0)] {
            let plant = Plant::exact(DampedOscillator { omega2, gamma }, ORIGIN, 0.1);
            for part in [0.0, 0.3] {
                let dt = Wide::from_f64(0.13);
                let (found, wanted) = (plant.split_in_floats(part, dt), plant.split(part, dt));
                let size = wanted
                    .phi
                    .rows()
                    .concat()
                    .into_iter()
                    .fold(1.0, |size: f64, x| size.max(x.to_f64().abs()));
                for i in 0..2 {
                    for j in 0..2 {
                        let off = found.phi[i][j] - wanted.phi.entry(i, j).to_f64();
                        // Six squarings, of each of two steps, double what rounding leaves.
                        assert!(off.abs() < 3e-14 * size, "{omega2} {gamma} {part}: {off}");
                    }
                    let old = found.old[i] - numbers(&wanted.old)[i];
                    let new = found.new[i] - numbers(&wanted.new)[i];
                    assert!(old.abs() < 3e-14 * size && new.abs() < 3e-14 * size);
                }
            }
        }
    }
}
