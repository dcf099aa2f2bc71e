//! Ranges of the axes of rates.
//!
//! It uses public types of the crate alone: the tests of `tests/probe` compile it, in place of the whole crate once more.

use core::f64::consts::TAU;

use crate::Rates;

/// Least growth rate at the end of its axis relative to the fastest rate `|s|` of a mode: a damping ratio of 5 % fills the axis, and one
/// of 0.1 % can still be seen. Roundings are far below.
const LEAST_GROWTH: f64 = 0.05;

/// Least rate in units of `1/dt` that counts as the fastest one. That of a free mass is the root of a rounding, 1e-8.
const LEAST_RATE: f64 = 1e-4;

/// Ranges of growth rates and of frequencies that show all rates, with a margin, but never roundings alone.
pub(crate) fn rate_ranges(all: &[&[Rates]], dt: f64) -> [[f64; 2]; 2] {
    const MARGIN: f64 = 0.08;
    let all = || all.iter().copied().flatten();
    let size = |rates: &Rates| rates.growth_rate.hypot(TAU * rates.frequency);
    let fastest = all().map(size).fold(LEAST_RATE / dt, f64::max);
    let least = LEAST_GROWTH * fastest;
    let low = all().map(|rates| rates.growth_rate).fold(0.0, f64::min);
    let high = all().map(|rates| rates.growth_rate).fold(0.0, f64::max);
    let margin = MARGIN * (high - low);
    let growth = [(low - margin).min(-least), (high + margin).max(least)];
    let top = all().map(|rates| rates.frequency).fold(least / TAU, f64::max);
    [growth, [-MARGIN / 2.0 * top, (1.0 + MARGIN) * top]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rate(growth_rate: f64, frequency: f64) -> Rates {
        Rates { growth_rate, frequency, damping_ratio: None }
    }

    #[test]
    fn an_axis_never_shows_roundings_alone() {
        // Nothing is damped: the axis shows a damping ratio of 5 %.
        let [[low, high], [_, top]] = rate_ranges(&[&[rate(1e-13, 2.0), rate(0.0, 0.5)]], 0.01);
        assert_eq!((low, high), (-LEAST_GROWTH * TAU * 2.0, LEAST_GROWTH * TAU * 2.0));
        assert!(top > 2.0 && top < 2.5, "{top}");
        // A free mass, whose factors are 1 up to the root of a rounding.
        let [[low, high], [_, top]] = rate_ranges(&[&[rate(1e-6, 2e-7)], &[]], 0.01);
        assert!(high >= 5e-4 && low == -high && top >= 5e-4 / TAU, "{low} {high} {top}");
        // A slow mode beside a fast one that decays: both are inside, and so is zero.
        let [[low, high], [bottom, top]] =
            rate_ranges(&[&[rate(-190.0, 50.0)], &[rate(-0.1, 1.4)]], 0.002);
        assert!(
            low < -190.0
                && low > -220.0
                && high > 10.0
                && high < 40.0
                && bottom < 0.0
                && top > 50.0
        );
    }
}
