//! The frequency at which forces change in space.

use libration_core::Scalar;
use libration_core::number::Dual;

use super::program::Program;
use super::{Dynamics, Recorded};

impl Dynamics {
    /// The program from positions, velocities and inputs to the fourth power of the local frequency, and to its rate of change along the
    /// motion.
    ///
    /// The frequency is `ω = (Σ (∂aᵢ/∂qⱼ)²)^(1/4)`, the root of the Frobenius norm of the stiffness: that of an oscillator, and
    /// `⁴√5·√(μ/r³)` of an orbit in a plane. Its reciprocal is a time in which a step is short everywhere. A coordinate that never
    /// accelerates, such as time, is no direction of space.
    pub fn fourth_power_of_frequency(&self) -> Program {
        let d = self.degrees();
        let is_positional = self.is_positional();
        let accelerated: Vec<usize> =
            (0..d).filter(|&i| !self.accelerations().is_zero(i)).collect();
        Program::record(2 * d + self.inputs(), |x| {
            let accelerations: Vec<Recorded> = match is_positional {
                true => vec![Recorded::zero(); d],
                false => self.accelerations().on::<Recorded>().run(x).collect(),
            };
            // Along the motion, then along a position.
            let moving = |i: usize| match i {
                i if i < d => Dual { re: x[i], du: x[d + i] },
                i if i < 2 * d => Dual { re: x[i], du: accelerations[i - d] },
                i => Dual::constant(x[i]),
            };
            let mut run = self.accelerations().on::<Dual<Dual<Recorded>>>();
            let mut sum = Dual::constant(Recorded::zero());
            for &j in &accelerated {
                let inputs: Vec<_> = (0..x.len())
                    .map(|i| {
                        let du = if i == j { Recorded::one() } else { Recorded::zero() };
                        Dual { re: moving(i), du: Dual::constant(du) }
                    })
                    .collect();
                for entry in run.run(&inputs) {
                    sum = sum + entry.du * entry.du;
                }
            }
            vec![sum.re, sum.du]
        })
    }
}
