//! The physics does not know that SIMD exists; only the batch kernels do.

use super::code::{has_word, prefixes};
use super::finding::Finding;
use super::source::Source;
use crate::workspace;

/// Modules that may choose instructions.
const KERNELS: [&str; 2] = ["ensemble/", "rl/horizon"];

/// SIMD in the engine outside the batch kernels.
pub(super) fn check(source: &Source) -> Vec<Finding> {
    let in_engine = workspace::in_engine(&source.path);
    if !in_engine || KERNELS.iter().any(|module| source.path.contains(module)) {
        return Vec::new();
    }
    let advice = "choose instructions in a batch kernel (`ensemble` or `rl/horizon.rs`); here \
                  write the scalar step, which a loop over lanes turns into vectors";
    source
        .code_lines()
        .filter(|(_, line)| {
            has_word(line, "pulp")
                || has_word(line, "target_feature")
                || prefixes(line, "_mm").next().is_some()
        })
        .map(|(number, _)| Finding::new(&source.path, number, advice))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn findings(path: &str, text: &str) -> usize {
        check(&Source::new(path, text)).len()
    }

    #[test]
    fn simd_outside_the_kernels_is_found() {
        let physics = "crates/libration-core/src/integrator/euler.rs";
        assert_eq!(findings(physics, "use pulp::Arch;"), 1);
        assert_eq!(findings(physics, "#[target_feature(enable = \"avx2\")]"), 1);
        assert_eq!(findings(physics, "let x = _mm256_add_pd(a, b);"), 1);
    }

    #[test]
    fn kernels_comments_and_millimetres_pass() {
        assert_eq!(findings("crates/libration-batch/src/ensemble/run.rs", "use pulp::Arch;"), 0);
        assert_eq!(findings("crates/libration-core/src/state.rs", "// pulp"), 0);
        assert_eq!(findings("crates/libration-core/src/state.rs", "let length_mm = 1;"), 0);
        assert_eq!(findings("crates/libration-lab/src/lib.rs", "use pulp::Arch;"), 0);
    }
}
