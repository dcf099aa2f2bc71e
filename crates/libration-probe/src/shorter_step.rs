//! Advice of a shorter step.
//!
//! It uses nothing of the crate: the tests of `tests/probe` compile it alone, in place of the whole crate once more.

use libration_report::notation::{number, plural};

/// The longest stable step, and the fewest substeps that are shorter.
pub(crate) fn shorter_step(dt: f64, longest: f64) -> String {
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
    fn help_names_a_step_that_is_not_above_the_limit() {
        let text = shorter_step(0.7, 0.608_799_9);
        assert!(text.starts_with("use a step of at most 0.6087 s, such as 2 substeps"), "{text}");
        assert!(rounded_down(2e-6) <= 2e-6 && rounded_down(2e-6) > 1.998e-6);
    }
}
