//! Limits as text, not beyond themselves.

use libration_report::notation::{cut_off, cut_up};

use super::imperfection::Imperfection;
use super::subject::Subject;
use super::timed_loop::TimedLoop;

/// An upper limit as [`rounded`](super::rounded) shows it, but not beyond itself.
pub fn rounded_down(limit: f64) -> String {
    in_digits(limit, cut_off)
}

/// A lower limit as [`rounded`](super::rounded) shows it, but not beyond itself.
pub(super) fn rounded_up(limit: f64) -> String {
    in_digits(limit, cut_up)
}

/// The words for a limit that lies beyond the largest tried size. The clock is also tried faster: its sizes are negative.
pub(super) fn beyond_tried(size: f64) -> String {
    let side = if size < 0.0 { "below" } else { "above" };
    match size.abs() < 1e-2 {
        true => format!("{side} {}", rounded_down(size)),
        false => format!("{side} {:.3}", cut_to(size, 3, cut_off)),
    }
}

fn in_digits(limit: f64, cut: fn(f64, usize) -> f64) -> String {
    match limit == 0.0 || limit.abs() >= 1e-4 {
        true => format!("{:.6}", cut_to(limit, 6, cut)),
        false => format!("{:.3e}", cut(limit, 4)),
    }
}

/// A limit cut to so many decimals.
fn cut_to(limit: f64, decimals: usize, cut: fn(f64, usize) -> f64) -> f64 {
    let before = limit.abs().log10().floor();
    match before.is_finite() {
        true => cut(limit, (before as i32 + 1 + decimals as i32).max(1) as usize),
        false => limit,
    }
}

impl TimedLoop {
    /// How a limit was found, in words; `search_ended` is whether the search for all crossings ended without an answer.
    pub(super) fn method_of(&self, subject: Subject, search_ended: bool) -> &'static str {
        match subject.kind {
            Imperfection::Latency | Imperfection::OutputLatency if search_ended => {
                "the spectral radius passes 1 between tried sizes: the search for all crossings ended without an answer"
            }
            Imperfection::Latency | Imperfection::OutputLatency | Imperfection::Skew => {
                "exact: the spectral radius passes 1"
            }
            Imperfection::Jitter if self.timing.record.is_some() => {
                "exact: growth through the stretched record"
            }
            Imperfection::Jitter | Imperfection::Loss => "exact: second moments grow",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_in_decimals_are_not_beyond_themselves() {
        for (limit, down, up) in [
            (0.153_248_96, "0.153248", "0.153249"),
            (3.135_904_99, "3.135904", "3.135905"),
            (0.25, "0.250000", "0.250000"),
            (12.345_678_9, "12.345678", "12.345679"),
            (7.306_194_4e-5, "7.306e-5", "7.307e-5"),
            (0.0, "0.000000", "0.000000"),
        ] {
            assert_eq!([rounded_down(limit), rounded_up(limit)], [down, up], "{limit}");
        }
        let words = [3.564_05, -0.999, 0.001_234_567].map(beyond_tried);
        assert_eq!(words, ["above 3.564", "below -0.999", "above 0.001234"]);
        // The limit of a fast clock, toward zero.
        assert_eq!(rounded_down(-0.123_456_78), "-0.123456");
    }
}
