//! Energies along a trajectory.

use crate::BlackBoxError;
use crate::prober::Prober;

/// Equal windows of a trajectory, and the part of a change that one of them may take back where the energy changes in one direction.
const WINDOWS: usize = 8;
const BACK: f64 = 0.05;
/// States of a trajectory whose energies are examined part by part.
const SAMPLES: usize = 32;

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
        for step in 0..steps {
            if step % steps.div_ceil(SAMPLES) == 0 {
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

    /// The change from the first to the last of equal windows, and whether none of them takes back a part of it.
    pub(crate) fn change(&self) -> (f64, bool) {
        let width = self.energies.len() / WINDOWS;
        let averages: Vec<f64> =
            (0..WINDOWS).map(|k| average(&self.energies[k * width..(k + 1) * width])).collect();
        let change = averages[WINDOWS - 1] - averages[0];
        let back = averages.windows(2).map(|pair| -(pair[1] - pair[0]) * change.signum());
        (change, back.fold(0.0, f64::max) <= BACK * change.abs())
    }
}

/// The average with the weights of a squared sine, squared: an oscillation leaves the fifth power of its period over the window.
fn average(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let weight = |k: usize| (core::f64::consts::PI * (k as f64 + 0.5) / n).sin().powi(4);
    let total: f64 = (0..values.len()).map(weight).sum();
    values.iter().enumerate().map(|(k, value)| weight(k) * value).sum::<f64>() / total
}
