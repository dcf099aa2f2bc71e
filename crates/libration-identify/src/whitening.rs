//! Independent errors out of a recording: the innovations of a Kalman filter for a response and for what it depends on linearly.
//!
//! The filter is linear in its measurements. Applied to the response, to the effect of the commands, to that of a constant load and to
//! those of the initial states alike, it makes a regression with independent errors (A. C. Harvey, *Forecasting, Structural Time
//! Series Models and the Kalman Filter*, Cambridge 1989, section 3.4; B. Rosenberg, Annals of Economic and Social Measurement 2, 1973).

use crate::hold::Hold;
use crate::noise::Noise;
use crate::plant_step::PlantSteps;
use crate::recording::Recording;
use crate::response::UnitPlant;

/// A regression with independent errors of variance `σ² · scale`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Whitened {
    /// The number of regressors: the command, a constant load, and the initial states of the plant.
    pub(crate) columns: usize,
    /// Samples × columns, row by row.
    pub(crate) regressors: Vec<f64>,
    /// One number for each sample.
    pub(crate) responses: Vec<f64>,
    /// The variance of each relative to `σ²`.
    pub(crate) scales: Vec<f64>,
}

/// Columns before those of initial states.
pub(crate) const COMMAND: usize = 0;
/// The column of a constant load.
pub(crate) const LOAD: usize = 1;

/// Which part of a recording is used, and how.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window<'a> {
    pub(crate) recording: &'a Recording,
    /// The first response.
    pub(crate) first: usize,
    /// Whether the plant rests at the first command, so that its initial states are known.
    pub(crate) is_at_rest: bool,
    pub(crate) hold: Hold,
    /// The median interval of the responses, in s.
    pub(crate) interval: f64,
}

/// The state of the filter.
struct Filter<'a> {
    plant: &'a UnitPlant,
    noise: Noise,
    /// Plant and coloured noise.
    states: usize,
    /// Columns, and the response itself at the end.
    width: usize,
    /// States × width.
    means: Vec<f64>,
    /// States × states.
    covariance: Vec<f64>,
    scratch: Vec<f64>,
    /// Width.
    innovations: Vec<f64>,
    /// States.
    gains: Vec<f64>,
    has_covariance: bool,
    /// The command and the load are those beyond a balance of both, in which an integral rests: its load is no unknown.
    balance: Option<f64>,
}

/// The innovations of a recording behind a dead time.
pub(crate) fn whiten(
    window: Window<'_>,
    plant: &UnitPlant,
    dead_time: f64,
    noise: Noise,
) -> Whitened {
    let Window { recording, first, is_at_rest, hold, interval } = window;
    let (times, values) = (&recording.command_times[..], &recording.commands[..]);
    let mut steps = PlantSteps::new(plant, noise.disturbance > 0.0);
    let mut filter = Filter::new(plant, noise, &mut steps, interval);
    let mut now = recording.response_times[first];
    if is_at_rest {
        filter.rest(values[0]);
        now = now.min(times[0]);
    }
    let input = |active: usize, time: f64| hold.at(times, values, active, time - dead_time);
    let count = recording.responses.len() - first;
    let columns = filter.width - 1;
    let mut whitened = Whitened {
        columns,
        regressors: Vec::with_capacity(count * columns),
        responses: Vec::with_capacity(count),
        scales: Vec::with_capacity(count),
    };
    // The command that acts now.
    let mut active = times.partition_point(|time| time + dead_time <= now).saturating_sub(1);
    for sample in first..recording.responses.len() {
        let end = recording.response_times[sample];
        while let Some(&next) = times.get(active + 1).filter(|&&time| time + dead_time <= end) {
            let arrival = (next + dead_time).max(now);
            // An equal command changes nothing, and a step is not divided for it.
            let rises = hold.slope(times, values, active) != hold.slope(times, values, active + 1);
            if values[active + 1] != values[active] || rises {
                filter.advance(&mut steps, arrival - now, input(active, now));
                now = arrival;
            }
            active += 1;
        }
        filter.advance(&mut steps, end - now, input(active, now));
        now = end;
        let (command, _) = input(active, now);
        filter.measure(command, recording.responses[sample], &mut whitened);
    }
    whitened
}

impl<'a> Filter<'a> {
    fn new(plant: &'a UnitPlant, noise: Noise, steps: &mut PlantSteps<'_>, interval: f64) -> Self {
        let n = plant.states();
        let is_coloured = noise.coloured > 0.0;
        let states = n + usize::from(is_coloured);
        let width = 2 + n + 1;
        let mut means = vec![0.0; states * width];
        for i in 0..n {
            means[i * width + LOAD + 1 + i] = 1.0;
        }
        let mut covariance = vec![0.0; states * states];
        if noise.disturbance > 0.0 && n > 0 {
            // The initial states are known a step before the first response, which would otherwise have no disturbance, and a likelihood
            // without bound if nothing else is random.
            let noises = &steps.step(interval).noise;
            for i in 0..n {
                for j in 0..n {
                    covariance[i * states + j] = noise.disturbance * noises[i * n + j];
                }
            }
        }
        if is_coloured {
            covariance[states * states - 1] = noise.coloured;
        }
        Filter {
            plant,
            noise,
            states,
            width,
            means,
            covariance,
            scratch: vec![0.0; states * width.max(states)],
            innovations: vec![0.0; width],
            gains: vec![0.0; states],
            has_covariance: is_coloured || noise.moves_plant(),
            balance: None,
        }
    }

    /// Begins at rest under a command: the initial states are no unknowns.
    fn rest(&mut self, command: f64) {
        self.balance = self.plant.integrates().then_some(command);
        let command = self.beyond_balance(command);
        for (i, rest) in self.plant.rest().into_iter().enumerate() {
            if let Some(rest) = rest {
                let row = i * self.width;
                self.means[row + LOAD + 1 + i] = 0.0;
                self.means[row + COMMAND] = rest * command;
                self.means[row + LOAD] = if self.balance.is_none() { rest } else { 0.0 };
            }
        }
    }

    fn beyond_balance(&self, command: f64) -> f64 {
        command - self.balance.unwrap_or(0.0)
    }

    /// Moves on by `h` seconds under a command and its slope.
    fn advance(&mut self, steps: &mut PlantSteps<'_>, h: f64, (command, slope): (f64, f64)) {
        let command = self.beyond_balance(command);
        let load = f64::from(u8::from(self.balance.is_none()));
        if h <= 0.0 || h.is_nan() {
            return;
        }
        let (n, width, states) = (self.plant.states(), self.width, self.states);
        let decay = if states > n { (-h / self.noise.correlation_time).exp() } else { 0.0 };
        if n > 0 {
            let step = steps.step(h);
            for i in 0..n {
                for column in 0..width {
                    let mut sum = 0.0;
                    for j in 0..n {
                        sum += step.phi[i * n + j] * self.means[j * width + column];
                    }
                    self.scratch[i * width + column] = sum;
                }
                self.scratch[i * width + COMMAND] +=
                    step.gamma[i] * command + step.slope[i] * slope;
                self.scratch[i * width + LOAD] += step.gamma[i] * load;
            }
            self.means[..n * width].copy_from_slice(&self.scratch[..n * width]);
            if self.has_covariance && self.noise.moves_plant() {
                self.advance_covariance(&step.phi, decay);
                for i in 0..n {
                    for j in 0..n {
                        self.covariance[i * states + j] +=
                            self.noise.disturbance * step.noise[i * n + j];
                    }
                }
            }
        }
        if states > n {
            for column in 0..width {
                self.means[n * width + column] *= decay;
            }
            let own = &mut self.covariance[states * states - 1];
            if !self.noise.moves_plant() || n == 0 {
                *own *= decay * decay;
            }
            *own += self.noise.coloured * (1.0 - decay * decay);
        }
    }

    /// `P = F P Fᵀ` with `F` of the plant and the decay of coloured noise.
    fn advance_covariance(&mut self, phi: &[f64], decay: f64) {
        let (n, states) = (self.plant.states(), self.states);
        let entry = |i: usize, j: usize| match (i < n, j < n) {
            (true, true) => phi[i * n + j],
            (false, false) => decay,
            _ => 0.0,
        };
        let half = &mut self.scratch[..states * states];
        for i in 0..states {
            for j in 0..states {
                half[i * states + j] =
                    (0..states).map(|k| entry(i, k) * self.covariance[k * states + j]).sum();
            }
        }
        for i in 0..states {
            for j in 0..states {
                self.covariance[i * states + j] =
                    (0..states).map(|k| half[i * states + k] * entry(j, k)).sum();
            }
        }
    }

    /// Takes a response, and leaves the innovations. Sums are plain loops, and buffers stay: half of an identification is spent here and in `advance`.
    fn measure(&mut self, command: f64, response: f64, whitened: &mut Whitened) {
        let (n, width, states) = (self.plant.states(), self.width, self.states);
        let c = |i: usize| if i < n { self.plant.c[i] } else { 1.0 };
        // Of regressors the coloured state is that of the filter with its sign turned: all columns but the last are `C m`.
        let innovations = &mut self.innovations[..];
        innovations.fill(0.0);
        for i in 0..states {
            let means = &self.means[i * width..(i + 1) * width];
            innovations.iter_mut().zip(means).for_each(|(sum, mean)| *sum += c(i) * mean);
        }
        if self.plant.d != 0.0 {
            innovations[COMMAND] += self.plant.d * (command - self.balance.unwrap_or(0.0));
            innovations[LOAD] += if self.balance.is_none() { self.plant.d } else { 0.0 };
        }
        innovations[width - 1] = response - innovations[width - 1];
        let mut scale = self.noise.white;
        if self.has_covariance {
            let mut variance = 0.0;
            for i in 0..states {
                let row = &self.covariance[i * states..(i + 1) * states];
                let mut gain = 0.0;
                for (j, entry) in row.iter().enumerate() {
                    gain += entry * c(j);
                }
                self.gains[i] = gain;
                variance += c(i) * gain;
            }
            scale += variance;
            for i in 0..states {
                let gain = self.gains[i] / scale;
                let means = &mut self.means[i * width..(i + 1) * width];
                for (mean, error) in means.iter_mut().zip(&innovations[..width - 1]) {
                    *mean -= gain * error;
                }
                means[width - 1] += gain * innovations[width - 1];
                let row = &mut self.covariance[i * states..(i + 1) * states];
                for (entry, other) in row.iter_mut().zip(&self.gains) {
                    *entry -= gain * other;
                }
            }
        }
        whitened.regressors.extend_from_slice(&innovations[..width - 1]);
        whitened.responses.push(innovations[width - 1]);
        whitened.scales.push(scale);
    }
}
