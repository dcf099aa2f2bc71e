//! What a receiver makes of commands between their times.

use serde::Serialize;

/// The command between two times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hold {
    /// Each command acts until the next arrives.
    #[default]
    Zero,
    /// The command moves on a straight line to the next.
    Linear,
}

impl Hold {
    /// The name on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            Hold::Zero => "zero",
            Hold::Linear => "linear",
        }
    }

    /// The slope between command `i` and the next, per second.
    pub(crate) fn slope(self, times: &[f64], values: &[f64], i: usize) -> f64 {
        match (self, times.get(i + 1)) {
            (Hold::Linear, Some(&next)) if next > times[i] => {
                (values[i + 1] - values[i]) / (next - times[i])
            }
            _ => 0.0,
        }
    }

    /// The command and its slope at `time`, of command `i` or behind it.
    pub(crate) fn at(self, times: &[f64], values: &[f64], i: usize, time: f64) -> (f64, f64) {
        let slope = self.slope(times, values, i);
        (values[i] + slope * (time - times[i]).max(0.0), slope)
    }
}
