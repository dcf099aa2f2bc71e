//! Energies along a trajectory.

use std::collections::BTreeSet;

use crate::BlackBoxError;
use crate::prober::Prober;

/// Equal windows of a trajectory, and the part of a change that one of them may take back where the energy changes in one direction.
const WINDOWS: usize = 8;
const BACK: f64 = 0.05;
/// States of a trajectory whose energies are examined part by part. Of 256 random phases one is within 0.05 rad of a peak but for a
/// part of 10⁻⁴, where a squared sine has 99.7 %.
const SAMPLES: usize = 256;
/// The golden section: squares of its multiples less integers are the places of states, more of them early, and beat with no period.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// The smallest change from window to window, relative to the first one, that is no rounding.
const SEEN: f64 = 1e-6;
/// Largest relative change whose logarithm gives the rate; beyond it the ratio of changes does, which needs no zero of the energy.
const SMALL: f64 = 0.5;

/// Energies along a trajectory, in units of their size.
pub(crate) struct Trajectory {
    dt: f64,
    pub(crate) energies: Vec<f64>,
    /// Some of the states.
    states: Vec<Vec<f64>>,
    /// Whether states and energies are finite to the end.
    pub(crate) is_finite: bool,
}

impl Trajectory {
    pub(crate) fn run(
        prober: &mut Prober<'_>,
        start: &[f64],
        dt: f64,
        steps: usize,
        size: f64,
    ) -> Result<Self, BlackBoxError> {
        let action = &prober.subject.action;
        let mut x = start.to_vec();
        let mut found = Trajectory {
            dt,
            energies: Vec::with_capacity(steps),
            states: Vec::with_capacity(SAMPLES),
            is_finite: false,
        };
        let places =
            (0..SAMPLES).map(|k| ((k as f64 * GOLDEN).fract().powi(2) * steps as f64) as usize);
        let places: BTreeSet<usize> = places.collect();
        for step in 0..steps {
            if places.contains(&step) {
                found.states.push(x.clone());
            }
            match prober.advance(&x, action, dt) {
                Ok(next) => x = next,
                Err(BlackBoxError::NotFinite { .. }) => return Ok(found),
                Err(error) => return Err(error),
            }
            let energy = prober.energy(&x)?.map(|energy| energy / size);
            let Some(energy) = energy.filter(|energy| energy.is_finite()) else { return Ok(found) };
            found.energies.push(energy);
        }
        found.is_finite = true;
        Ok(found)
    }

    /// The largest energy by which a single state of the motion differs from that of the subject.
    pub(crate) fn exchanged(&self, prober: &mut Prober<'_>) -> Result<f64, BlackBoxError> {
        let rest = &prober.subject.state;
        let mut largest = 0.0_f64;
        for state in &self.states {
            let Some(energy) = prober.energy(state)? else { continue };
            for (i, &at_rest) in rest.iter().enumerate() {
                let mut other = state.clone();
                other[i] = at_rest;
                let change = prober.energy(&other)?.map_or(0.0, |other| (energy - other).abs());
                largest = largest.max(if change.is_finite() { change } else { 0.0 });
            }
        }
        Ok(largest)
    }

    /// The kinetic energy of the motion, that of which all velocities are zero taken off: its largest value, or twice its mean over the first
    /// half of the states. The one is the energy of a linear oscillator, the other that of many (virial theorem).
    pub(crate) fn kinetic(
        &self,
        prober: &mut Prober<'_>,
        pairs: &[(usize, usize)],
    ) -> Result<f64, BlackBoxError> {
        let (mut largest, mut sum, mut count) = (0.0_f64, 0.0, 0);
        for (k, state) in self.states.iter().enumerate() {
            let mut still = state.clone();
            pairs.iter().for_each(|&(_, v)| still[v] = 0.0);
            let (Some(moving), Some(still)) = (prober.energy(state)?, prober.energy(&still)?)
            else {
                continue;
            };
            let kinetic = (moving - still).abs();
            if !kinetic.is_finite() {
                continue;
            }
            largest = largest.max(kinetic);
            if k < self.states.len() / 2 {
                (sum, count) = (sum + kinetic, count + 1);
            }
        }
        // The mean of a single oscillator errs by the phases of the states, and its largest value does not.
        match pairs.len() {
            0 | 1 => Ok(largest),
            _ => Ok(largest.max(2.0 * sum / f64::from(count.max(1)))),
        }
    }

    pub(crate) fn change_unit(&mut self, from: f64, to: f64) {
        self.energies.iter_mut().for_each(|energy| *energy *= from / to);
    }

    /// The difference of smooth averages over the halves, in 1/s, and how far the rates of parts are apart because the energy oscillates.
    pub(crate) fn rate(&self) -> (f64, f64) {
        let steps = self.energies.len();
        let span = |part: core::ops::Range<usize>| {
            let middle = (part.start + part.end) / 2;
            let time = (part.end - part.start) as f64 / 2.0 * self.dt;
            (average(&self.energies[middle..part.end])
                - average(&self.energies[part.start..middle]))
                / time
        };
        let whole = span(0..steps);
        // A shift of the window moves the phase of an oscillation, but no drift.
        let shift = steps / 50;
        let others =
            [span(shift..steps), span(0..steps - shift), span(shift / 3..steps - shift / 2)];
        (whole, others.iter().map(|other| (other - whole).abs()).fold(0.0, f64::max))
    }

    /// The change from the start to the end, and whether none of equal windows takes back a part of it.
    ///
    /// The ends of a change in one direction are half a window beyond the first and the last average, by an exponential through three.
    pub(crate) fn change(&self) -> (f64, bool) {
        let averages = self.averages();
        let [first, .., last] = averages;
        let change = last - first;
        let back = averages.windows(2).map(|pair| -(pair[1] - pair[0]) * change.signum());
        let is_steady = back.fold(0.0, f64::max) <= BACK * change.abs();
        let beyond = match is_steady {
            true => {
                let reversed: Vec<f64> = averages.iter().rev().copied().collect();
                half_a_window(&averages) - half_a_window(&reversed)
            }
            false => 0.0,
        };
        (change + beyond, is_steady)
    }

    /// The rate in 1/s at which an energy of this change from 1 grows or falls as an exponential.
    pub(crate) fn exponential_rate(&self, change: f64) -> Option<f64> {
        let duration = self.energies.len() as f64 * self.dt;
        if change.abs() <= SMALL {
            return Some(change.ln_1p() / duration);
        }
        let averages = self.averages();
        let steps: Vec<f64> = averages.windows(2).map(|pair| pair[1] - pair[0]).collect();
        // Later changes of a fast decay are roundings.
        let is_seen = |step: &f64| step / steps[0] > SEEN;
        let count = steps.iter().take_while(|step| is_seen(step)).count();
        let window = duration / WINDOWS as f64;
        (count > 1).then(|| (steps[count - 1] / steps[0]).ln() / ((count - 1) as f64 * window))
    }

    fn averages(&self) -> [f64; WINDOWS] {
        let width = self.energies.len() / WINDOWS;
        core::array::from_fn(|k| average(&self.energies[k * width..(k + 1) * width]))
    }
}

/// How much a value is beyond the last of some averages half a window later.
fn half_a_window(averages: &[f64]) -> f64 {
    let [.., before, middle, last] = averages else { return 0.0 };
    let (ratio, step) = ((last - middle) / (middle - before), last - middle);
    match ratio > 0.0 && ratio.is_finite() {
        // a + b r^k with r^½ for half a window.
        true => step * ratio / (1.0 + ratio.sqrt()),
        false => step / 2.0,
    }
}

/// The average with the weights of a squared sine, squared: an oscillation leaves the fifth power of its period over the window.
fn average(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let weight = |k: usize| (core::f64::consts::PI * (k as f64 + 0.5) / n).sin().powi(4);
    let total: f64 = (0..values.len()).map(weight).sum();
    values.iter().enumerate().map(|(k, value)| weight(k) * value).sum::<f64>() / total
}
