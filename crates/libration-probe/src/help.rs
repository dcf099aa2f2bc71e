//! What the reader of a finding should change.

use libration_report::notation::{number, plural};

/// The change that answers a finding of this kind, in a sentence; empty for an unknown kind. `dt` and `longest_dt` are the step and the
/// longest stable one, in s.
pub(crate) fn help(kind: &str, dt: f64, longest_dt: Option<f64>) -> String {
    if let ("unstable-step", Some(longest)) = (kind, longest_dt) {
        return shorter_step(dt, longest);
    }
    let text = match kind {
        "not-reproducible" => {
            "seed the generator in each call, return all states, and read no clock; or audit the step without its noise"
        }
        "shared-generator" => {
            "give each environment its own generator, seeded by the seed and its number"
        }
        "same-noise" => {
            "seed the generator of each environment differently, by the seed and its number"
        }
        "bits-differ" => {
            "sum in one order for every batch and number of threads, and initialise all memory; else compare results with a tolerance"
        }
        "single-precision" => {
            "compute in f64 (JAX: `jax_enable_x64`, PyTorch: `torch.float64`), or compare results to six digits only"
        }
        "rough" => {
            "tighten the tolerance of iterative solvers or fix the number of their iterations, and interpolate tables smoothly"
        }
        "late-command" => {
            "use the command in the call that receives it, or design the controller for this latency (`report.advise` in Python adds it)"
        }
        "late-state" => "return the state at the end of the call, not one of an earlier call",
        "constant-observation" => {
            "compute the observation from the state, and check that the function is given the right one"
        }
        "stale-observation" => "compute the observation from the state after the step",
        "irregular-delay" => {
            "count the delay in whole steps; a comparison of rounded times requires a margin of half a step"
        }
        "hidden-state" => {
            "return every state that the next step uses, such as filters, or reset it in each call"
        }
        "ignores-dt" => {
            "pass dt to the integrator; if the step has one length only, audit with `--fixed-dt` (Python: `fixed_dt=True`)"
        }
        "negative-damping" => {
            "reverse the sign of the force that grows with this velocity, unless it is a drive"
        }
        "energy-leak" => {
            "remove damping, friction and forces without a potential; if they are meant, audit without `--conservative` (Python: `conservative`)"
        }
        "unstable-step" => "shorten the step, or use an implicit integrator",
        "grows-always" => {
            "replace the integrator, e.g. by symplectic Euler: the new velocity first, and with it the position"
        }
        "limited-validity" => {
            "audit again at each other state in which the simulator runs, such as without these contacts"
        }
        "no-equilibrium" => {
            "audit at an equilibrium (MuJoCo: `--settle`); if the motion is meant, add `--moving` (Python: `equilibrium=False`)"
        }
        "not-differentiable" => {
            "audit at a state off the contact, the limit or the standstill of friction"
        }
        "nonlinear" => {
            "use the modes for smaller deviations only, and audit again at the other states of the motion"
        }
        "derivatives-differ" => {
            "use the matrices of this audit, and look for terms that the derivatives of the simulator leave out"
        }
        _ => "",
    };
    text.to_owned()
}

/// The longest stable step, and the fewest substeps that are shorter.
fn shorter_step(dt: f64, longest: f64) -> String {
    let substeps = (dt / longest).ceil();
    let by_substeps = match substeps <= 1000.0 {
        true => format!(", such as {} of each step", plural(substeps as usize, "substep")),
        false => String::new(),
    };
    format!(
        "use a step of at most {} s{by_substeps}, or an integrator that is implicit in the stiff forces",
        number(rounded_down(longest), 4)
    )
}

/// A positive number rounded down to four digits, so that a limit stays one.
fn rounded_down(x: f64) -> f64 {
    let unit = 10.0_f64.powf(x.log10().floor() - 3.0);
    (x / unit).floor() * unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_finding_has_help() {
        let source = include_str!("finding.rs");
        let docs = include_str!("../../../docs/probe.md");
        // The first argument of each constructor.
        let literal = |rest: &'static str| rest.trim_start().strip_prefix('"')?.split('"').next();
        let kinds: Vec<&str> = ["Finding::fault(", "Finding::warning(", "Finding::new("]
            .into_iter()
            .flat_map(|constructor| source.split(constructor).skip(1).filter_map(literal))
            .collect();
        assert!(kinds.len() >= 20, "{kinds:?}");
        for kind in kinds {
            let text = help(kind, 0.1, None);
            assert!(!text.is_empty() && !text.ends_with('.'), "{kind}: {text}");
            assert!(docs.contains(&format!("`{kind}`")), "{kind} is not in docs/probe.md");
        }
    }

    #[test]
    fn help_names_a_step_that_is_not_above_the_limit() {
        let text = shorter_step(0.7, 0.608_799_9);
        assert!(text.starts_with("use a step of at most 0.6087 s, such as 2 substeps"), "{text}");
        assert!(rounded_down(2e-6) <= 2e-6 && rounded_down(2e-6) > 1.998e-6);
    }
}
