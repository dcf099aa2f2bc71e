//! The expected kernels: a check without kernels must fail.

use super::catalogue::{MACHINE, METHODS, SYSTEMS};
use super::census::Census;
use super::kernel::{Instructions, Kernel};

const FLOATS: [&str; 2] = ["f32", "f64"];

/// Returns a message for each missing kernel.
pub(super) fn complaints(found: &[(Kernel, Census)]) -> Vec<String> {
    let mut missing = Vec::new();
    for instructions in Instructions::ALL {
        for float in FLOATS {
            for (_, system) in SYSTEMS {
                for ((_, method), pass) in METHODS.iter().flat_map(|m| [(m, false), (m, true)]) {
                    let is_it = |(kernel, _): &(Kernel, Census)| {
                        let names = (kernel.float.as_str(), kernel.system.as_str());
                        kernel.instructions == instructions
                            && names == (float, system)
                            && kernel.method == *method
                            && kernel.pass == pass
                    };
                    if !found.iter().any(is_it) {
                        let kind = if pass { "pass" } else { "advance" };
                        missing.push(format!(
                            "{instructions} {float} {system} {method} ({kind}): not in the assembly. Is it \
                             a function of its own, and is its method and system made in \
                             crates/libration-batch/src/ensemble/any.rs?"
                        ));
                    }
                }
            }
        }
    }
    for (instructions, float) in Instructions::ALL.into_iter().flat_map(|i| FLOATS.map(|f| (i, f)))
    {
        let is_it = |(kernel, _): &(Kernel, Census)| {
            kernel.instructions == instructions
                && kernel.float == float
                && kernel.system == MACHINE[0]
        };
        if !found.iter().any(is_it) {
            missing.push(format!("{instructions} {float} {}: not in the assembly", MACHINE[0]));
        }
    }
    missing
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_assembly_without_kernels_is_refused() {
        let missing = complaints(&[]);
        assert_eq!(missing.len(), 2 * 2 * (2 * SYSTEMS.len() * METHODS.len() + 1));
        assert!(
            missing[0]
                .starts_with("avx2 f32 oscillator explicit-euler (advance): not in the assembly")
        );
    }
}
