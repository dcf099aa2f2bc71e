//! Gain and phase margins of a loop.

use core::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::{DiscreteController, LinearLoop, LinearLoopError, LoopTiming, Matrix, solve};

/// The margins of a loop that is opened at one input, with all others closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilityMargins {
    /// The smallest factor above 1 of the commands at which the loop loses stability; none if there is none.
    pub gain_up: Option<f64>,
    /// The largest factor below 1 at which it does; none if there is none.
    pub gain_down: Option<f64>,
    /// The smallest shift of the phase in rad at which it does; none if the gain never passes 1.
    pub phase: Option<f64>,
    /// The frequency in Hz of that shift: the crossover.
    pub crossover: Option<f64>,
}

/// Angles per period at which the response is computed, in equal ratios from the slowest.
const ANGLES: usize = 5200;

/// The slowest angle, in rad.
const SLOWEST: f64 = 1e-8;

/// Bisections of an angle.
const HALVINGS: u32 = 50;

impl LinearLoop {
    /// The margins at input `i`, without jitter and losses: from the frequency response of the period, with all commands and
    /// measurements in transit.
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing, or a schedule of several controllers, whose loop has no frequency response.
    pub fn stability_margins(
        &self,
        timing: &LoopTiming,
        i: usize,
    ) -> Result<StabilityMargins, LinearLoopError> {
        self.only_controller("gain and phase margins")?;
        let response = self.open_loop(timing, i)?;
        let ratio = (PI / SLOWEST).ln() / (ANGLES - 1) as f64;
        let angles: Vec<f64> =
            (0..ANGLES).map(|k| (SLOWEST * (ratio * k as f64).exp()).min(PI)).collect();
        let values: Vec<Complex64> = angles.iter().map(|&angle| response.at(angle)).collect();
        let mut margins =
            StabilityMargins { gain_up: None, gain_down: None, phase: None, crossover: None };
        for (pair, ends) in values.windows(2).zip(angles.windows(2)) {
            let [from, to] = [ends[0], ends[1]];
            // Where the response is real and negative. It may pass behind the origin, as at a pole.
            if pair[0].im * pair[1].im < 0.0 && pair[0].re + pair[1].re < 0.0 {
                let rises = pair[0].im < 0.0;
                let at = root(from, to, |angle| (response.at(angle).im < 0.0) == rises);
                margins.count_gain(response.at(at));
            }
            let outside = |value: Complex64| value.norm() > 1.0;
            if outside(pair[0]) != outside(pair[1]) {
                let at = root(from, to, |angle| outside(response.at(angle)) == outside(pair[0]));
                let phase = (-response.at(at)).arg().abs();
                if margins.phase.is_none_or(|least| phase < least) {
                    margins.phase = Some(phase);
                    margins.crossover = Some(at / (TAU * self.period() * (1.0 + timing.skew)));
                }
            }
        }
        // No turn per period and half a one, where the response is real.
        for end in [0.0, PI].map(|angle| response.at(angle)) {
            if end.is_finite() && end.re < 0.0 {
                margins.count_gain(end);
            }
        }
        Ok(margins)
    }

    /// What the loop makes of a command at input `i`, with the sign of negative feedback.
    fn open_loop(&self, timing: &LoopTiming, i: usize) -> Result<OpenLoop, LinearLoopError> {
        // The memory gets a command from outside, and keeps the one that the controller would have sent.
        let own = self.controller_after(0, self.period() * (1.0 + timing.skew));
        let (memory, measurements) = (own.memory(), own.measurements());
        let mut controller = DiscreteController {
            a: Matrix::zeros(memory + 2, memory + 2),
            b: Matrix::zeros(memory + 2, measurements),
            c: Matrix::zeros(own.commands(), memory + 2),
            d: own.d.clone(),
        };
        controller.a.set_block((0, 0), &own.a);
        controller.b.set_block((0, 0), &own.b);
        controller.c.set_block((0, 0), &own.c);
        controller.a.row_mut(memory + 1)[..memory].copy_from_slice(own.c.row(i));
        controller.b.row_mut(memory + 1).copy_from_slice(own.d.row(i));
        controller.c.row_mut(i).fill(0.0);
        controller.c[(i, memory)] = 1.0;
        controller.d.row_mut(i).fill(0.0);
        let opened = self.with_controller(controller)?.period_matrix(timing)?;
        let outside = self.plant().states.len() + memory;
        let kept: Vec<usize> = (0..opened.rows()).filter(|&k| k != outside).collect();
        let sent = outside + 1;
        Ok(OpenLoop {
            a: Matrix::from_fn(kept.len(), kept.len(), |r, c| opened[(kept[r], kept[c])]),
            b: kept.iter().map(|&k| opened[(k, outside)]).collect(),
            c: kept.iter().map(|&k| opened[(sent, k)]).collect(),
            d: opened[(sent, outside)],
        })
    }
}

impl StabilityMargins {
    /// The response is real and negative here.
    fn count_gain(&mut self, response: Complex64) {
        let factor = response.norm().recip();
        let factor = Some(factor).filter(|factor| factor.is_finite());
        match factor {
            Some(factor) if factor >= 1.0 => {
                self.gain_up = Some(self.gain_up.map_or(factor, |least| least.min(factor)));
            }
            Some(factor) => {
                self.gain_down = Some(self.gain_down.map_or(factor, |most| most.max(factor)));
            }
            None => {}
        }
    }
}

/// `x' = Ax + bv` and, in the same period, the command `c·x + dv` that the controller would send.
struct OpenLoop {
    a: Matrix,
    b: Vec<f64>,
    c: Vec<f64>,
    d: f64,
}

impl OpenLoop {
    /// The response at this angle per period, with the sign of negative feedback.
    fn at(&self, angle: f64) -> Complex64 {
        let z = Complex64::from_polar(1.0, angle);
        let row = |i: usize| -> Vec<Complex64> {
            let entry = |j: usize| {
                let own = if i == j { z } else { Complex64::ZERO };
                own - self.a[(i, j)]
            };
            (0..self.b.len()).map(entry).chain([Complex64::from(self.b[i])]).collect()
        };
        let rows = (0..self.b.len()).map(row).collect();
        let x = solve(rows, |x: Complex64| x.norm());
        -(x.iter().zip(&self.c).map(|(x, c)| x * c).sum::<Complex64>() + self.d)
    }
}

/// Where `holds` ends, between an end at which it does and one at which it does not.
fn root(mut from: f64, mut to: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (from + to);
        if holds(middle) { from = middle } else { to = middle }
    }
    from
}

#[cfg(test)]
mod tests {
    use libration_core::control::Latency;

    use super::*;
    use crate::{LinearPlant, log_spectral_radius};

    fn looped(a: [[f64; 2]; 2], gain: [f64; 2], period: f64) -> LinearLoop {
        let a = Matrix::from_rows(&a).unwrap();
        let b = Matrix::from_rows(&[[0.0], [1.0]]).unwrap();
        let plant = LinearPlant::new(a, b, Matrix::identity(2), Matrix::zeros(2, 1)).unwrap();
        let controller = DiscreteController::gain(Matrix::from_fn(1, 2, |_, j| -gain[j]));
        LinearLoop::new(plant, controller, period, Matrix::identity(3), vec![0.0; 2]).unwrap()
    }

    #[test]
    fn in_short_periods_they_are_those_of_continuous_time() {
        // (2s + 1)/s²: |L| = 1 where ω⁴ = 4ω² + 1, and the phase there is atan 2ω above half a turn.
        let found = looped([[0.0, 1.0], [0.0, 0.0]], [1.0, 2.0], 1e-5);
        let margins = found.stability_margins(&found.ideal(), 0).unwrap();
        let omega = (2.0 + 5.0_f64.sqrt()).sqrt();
        // A hold of 10⁻⁵ s turns by 10⁻⁵ rad.
        assert!((margins.phase.unwrap() - (2.0 * omega).atan()).abs() < 2e-5, "{margins:?}");
        assert!((margins.crossover.unwrap() * TAU - omega).abs() < 1e-4, "{margins:?}");
        assert_eq!(margins.gain_down, None);
    }

    #[test]
    fn at_a_gain_margin_the_spectral_radius_is_one() {
        // Upside down: too little gain lets it fall, too much swings it up.
        let linear = looped([[0.0, 1.0], [9.0, -0.1]], [20.0, 6.0], 0.05);
        for (steps, measured) in [(0.0, 0.0), (1.3, 0.0), (0.4, 1.2)] {
            let mut timing = linear.ideal();
            timing.input_latency = vec![Latency::of_steps(steps).unwrap()];
            timing.output_latency = vec![Latency::of_steps(measured).unwrap(); 2];
            let margins = linear.stability_margins(&timing, 0).unwrap();
            for factor in [margins.gain_up.unwrap(), margins.gain_down.unwrap()] {
                let controller = linear.controller().amplified(factor);
                let edge = linear.with_controller(controller).unwrap();
                let radius = log_spectral_radius(&edge.period_matrix(&timing).unwrap());
                assert!(radius.abs() < 1e-7, "{steps} {factor}: {radius:e}");
            }
        }
    }
}
