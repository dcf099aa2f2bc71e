//! The kernels whose instructions are counted.

use std::fmt;

/// Systems with the methods that are counted on them: what the studies and the readers run most. The
/// other kernels are made of the same parts.
const KERNELS: [(&str, &[&str]); 4] = [
    ("oscillator", &["symplectic-euler", "velocity-verlet", "rk4", "yoshida4"]),
    ("pendulum", &["symplectic-euler", "velocity-verlet"]),
    ("kepler", &["symplectic-euler", "velocity-verlet"]),
    ("henon-heiles", &["symplectic-euler", "velocity-verlet"]),
];

const FLOATS: [&str; 2] = ["f32", "f64"];

/// A kernel, by names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kernel {
    pub(super) system: &'static str,
    pub(super) method: &'static str,
    pub(super) float: &'static str,
}

impl Kernel {
    /// All that are counted.
    pub(super) fn all() -> impl Iterator<Item = Kernel> {
        let pairs = KERNELS
            .into_iter()
            .flat_map(|(system, methods)| methods.iter().map(move |&method| (system, method)));
        pairs.flat_map(|(system, method)| {
            FLOATS.into_iter().map(move |float| Kernel { system, method, float })
        })
    }
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", self.system, self.method, self.float)
    }
}
