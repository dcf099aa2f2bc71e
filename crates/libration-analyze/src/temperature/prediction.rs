//! Predicted temperatures of a method, mode by mode.

use libration::analysis::{bias_orders, mode_biases, mode_memory, stability_margin};
use libration::thermostat::{LangevinLetter, LangevinMethod};

use super::BIAS_LIMIT;

/// Points of the search for limits of the time step; between two of them a limit is bisected.
const POINTS: u32 = 512;

/// Halvings of an interval, to the last digit.
const HALVINGS: u32 = 100;

/// A method on the modes of a system.
pub(super) struct Prediction<'a> {
    pub(super) method: &'a LangevinMethod,
    /// Angular frequencies in rad/s, the slowest first.
    pub(super) frequencies: &'a [f64],
    /// Friction in 1/s.
    pub(super) friction: f64,
}

/// Relative biases of a temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ModeBiases {
    pub(super) fastest: f64,
    pub(super) mean: f64,
}

impl Prediction<'_> {
    fn fastest(&self) -> f64 {
        self.frequencies.last().copied().unwrap_or(f64::NAN)
    }

    /// The biases of the temperatures of positions and velocities with a step of `dt` seconds; none if a mode is not stable.
    pub(super) fn biases(&self, dt: f64) -> Option<[ModeBiases; 2]> {
        let each = |&omega: &f64| mode_biases(self.method, omega * dt, self.friction / omega);
        let all: Vec<[f64; 2]> = self.frequencies.iter().map(each).collect::<Option<_>>()?;
        let fastest = all.last().copied()?;
        Some([0, 1].map(|i| ModeBiases {
            fastest: fastest[i],
            mean: all.iter().map(|both| both[i]).sum::<f64>() / all.len() as f64,
        }))
    }

    /// Powers of the time step as which the biases vanish; none of a bias that is zero.
    pub(super) fn orders(&self) -> [Option<u32>; 2] {
        bias_orders(self.method).unwrap_or_default()
    }

    /// The end of the stable time steps of the fastest mode in s.
    pub(super) fn stable_dt(&self) -> f64 {
        let friction = self.friction / self.fastest();
        self.largest(|z| stability_margin(self.method, z, friction) > 0.0)
    }

    /// The end of the time steps in s at which the biases of the fastest mode are within [`BIAS_LIMIT`].
    pub(super) fn accurate_dt(&self) -> [f64; 2] {
        let friction = self.friction / self.fastest();
        [0, 1].map(|i| {
            self.largest(|z| {
                let biases = mode_biases(self.method, z, friction);
                biases.is_some_and(|biases| biases[i].abs() <= BIAS_LIMIT)
            })
        })
    }

    /// The first time step in s at which a property of `z = ωΔt` of the fastest mode ends.
    fn largest(&self, holds: impl Fn(f64) -> bool) -> f64 {
        let most = match self.method {
            // Steps of the longest letter, of which a leapfrog has the limit 2; and room.
            LangevinMethod::Word(word) => {
                let count = |letter| word.count(letter);
                2.5 * count(LangevinLetter::Drift).max(count(LangevinLetter::Kick)) as f64
            }
            LangevinMethod::Gjf | LangevinMethod::EulerMaruyama => 2.5,
        };
        let at = |k: u32| most * f64::from(k) / f64::from(POINTS);
        let first = (1..=POINTS).find(|&k| !holds(at(k))).unwrap_or(POINTS);
        let (mut low, mut high) = (at(first - 1), at(first));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if holds(middle) { low = middle } else { high = middle }
        }
        low / self.fastest()
    }

    /// The part of a deviation that a step of `dt` seconds leaves in the mode that forgets most slowly.
    pub(super) fn memory(&self, dt: f64) -> f64 {
        let each = |&omega: &f64| mode_memory(self.method, omega * dt, self.friction / omega);
        self.frequencies.iter().map(each).fold(0.0, f64::max)
    }
}
