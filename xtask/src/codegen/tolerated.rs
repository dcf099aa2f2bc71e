//! Kernels that are known not to be made of vectors, and why.

use std::fmt;

use super::kernel::Kernel;

/// Kernels of one method on one system, for every float and instruction set.
pub(super) struct Tolerated {
    system: &'static str,
    method: &'static str,
    /// Why it cannot be had.
    reason: &'static str,
}

/// All of them. One that is made of vectors again must go.
pub(super) const TOLERATED: [Tolerated; 3] = [
    Tolerated { system: "pendulum", method: "suzuki4", reason: LONG },
    Tolerated { system: "driven-oscillator", method: "yoshida4", reason: LONG },
    Tolerated { system: "driven-oscillator", method: "suzuki4", reason: LONG },
];

const LONG: &str = "Several substeps with a sine each are too long for the compiler to unroll.";

impl Tolerated {
    /// Whether it speaks of this kernel.
    pub(super) fn covers(&self, kernel: &Kernel) -> bool {
        (self.system, self.method) == (kernel.system.as_str(), kernel.method.as_str())
    }
}

impl fmt::Display for Tolerated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}: {}", self.system, self.method, self.reason)
    }
}

#[cfg(test)]
impl Tolerated {
    /// One for tests.
    pub(super) fn new(system: &'static str, method: &'static str) -> Self {
        Tolerated { system, method, reason: "" }
    }
}
