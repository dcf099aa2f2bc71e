//! Simulated responses with every imperfection: arrivals that vary, losses, two delays, noise of each kind.

use libration::linear::{Matrix, cholesky};
use libration::random::{Address, Purpose};

use crate::hold::Hold;
use crate::noise::Noise;
use crate::plant_step::PlantSteps;
use crate::recording::Recording;
use crate::response::ResponseKind;

/// A loop whose parameters are known.
#[derive(Clone, Debug)]
pub struct SimulatedLoop {
    /// The form of the response.
    pub response: ResponseKind,
    /// Its parameters in their order, the dead time first, in s.
    pub shape: Vec<f64>,
    /// What the receiver makes of commands between their times.
    pub hold: Hold,
    /// The gain.
    pub gain: f64,
    /// The constant load at the input.
    pub load: f64,
    /// The initial states of the plant; zeros if there are too few.
    pub start: Vec<f64>,
    /// The standard deviation of independent errors.
    pub white: f64,
    /// The standard deviation of coloured errors, and their correlation time in s.
    pub coloured: (f64, f64),
    /// The root of the intensity of a disturbance at the input.
    pub disturbance: f64,
    /// The root mean square of arrivals about their mean, in s.
    pub jitter: f64,
    /// The probability that a command is lost.
    pub loss: f64,
    /// A longer dead time and its probability.
    pub second_delay: Option<(f64, f64)>,
}

impl SimulatedLoop {
    /// A loop of unit gain without imperfections.
    pub fn new(response: ResponseKind, shape: &[f64]) -> Self {
        SimulatedLoop {
            response,
            shape: shape.to_vec(),
            hold: Hold::Zero,
            gain: 1.0,
            load: 0.0,
            start: Vec::new(),
            white: 0.0,
            coloured: (0.0, 1.0),
            disturbance: 0.0,
            jitter: 0.0,
            loss: 0.0,
            second_delay: None,
        }
    }

    /// The responses to the commands of `recording` at its times. All draws follow from `seed` and `trajectory`.
    pub fn responses(&self, recording: &Recording, seed: u64, trajectory: u64) -> Vec<f64> {
        let draw = |step: u64, purpose: Purpose| Address { seed, trajectory, step, purpose };
        let plant = self.response.dynamics(&self.shape[1..]);
        let n = plant.states();
        let (times, values) = (&recording.command_times[..], &recording.commands[..]);
        let arrivals =
            self.arrivals(times, |k| draw(k, Purpose::Latency), |k| draw(k, Purpose::Delay));
        let mut steps = PlantSteps::new(&plant, self.disturbance > 0.0);
        let mut state = vec![0.0; n];
        state.iter_mut().zip(&self.start).for_each(|(x, start)| *x = *start);
        let mut colour = self.coloured.0 * draw(u64::MAX, Purpose::Observation).gaussian()[0];
        let (mut now, mut active, mut next, mut pieces) = (recording.response_times[0], 0, 0, 0);
        while next < arrivals.len() && arrivals[next].0 <= now {
            active = active.max(arrivals[next].1);
            next += 1;
        }
        let mut responses = Vec::with_capacity(recording.responses.len());
        for (i, &end) in recording.response_times.iter().enumerate() {
            let begin = now;
            loop {
                let arrival = arrivals.get(next).filter(|arrival| arrival.0 <= end);
                let until = arrival.map_or(end, |arrival| arrival.0);
                let (command, slope) = self.hold.at(times, values, active, now - self.shape[0]);
                let [command, slope] = [self.gain * command + self.load, self.gain * slope];
                if until > now && n > 0 {
                    let step = steps.step(until - now);
                    state = step.moved(&state, command, slope);
                    if self.disturbance > 0.0 {
                        let covariance = Matrix::from_fn(n, n, |i, j| {
                            step.noise[i * n + j] * self.disturbance.powi(2)
                        });
                        let root = cholesky(&covariance);
                        let draws: Vec<f64> = (0..n)
                            .map(|j| {
                                let address = draw(pieces, Purpose::Disturbance);
                                Address { trajectory: trajectory ^ ((j as u64) << 32), ..address }
                                    .gaussian()[0]
                            })
                            .collect();
                        for i in 0..n {
                            state[i] += (0..=i).map(|j| root[(i, j)] * draws[j]).sum::<f64>();
                        }
                        pieces += 1;
                    }
                }
                now = until;
                let Some(&(_, k)) = arrival else { break };
                active = active.max(k);
                next += 1;
            }
            let (command, _) = self.hold.at(times, values, active, now - self.shape[0]);
            let direct = plant.d * (self.gain * command + self.load);
            let output: f64 = plant.c.iter().zip(&state).map(|(c, x)| c * x).sum();
            let errors = draw(i as u64, Purpose::Observation).gaussian();
            let decay = (-(now - begin) / self.coloured.1).exp();
            colour = decay * colour + self.coloured.0 * (1.0 - decay * decay).sqrt() * errors[1];
            responses.push(output + direct + colour + self.white * errors[0]);
        }
        responses
    }

    /// Arrivals of commands with their numbers, in the order of time. A lost command does not arrive.
    fn arrivals(
        &self,
        times: &[f64],
        jitter: impl Fn(u64) -> Address,
        loss: impl Fn(u64) -> Address,
    ) -> Vec<(f64, usize)> {
        let mut arrivals: Vec<(f64, usize)> = Vec::with_capacity(times.len());
        for (k, &time) in times.iter().enumerate() {
            let [lost, late] = loss(k as u64).uniform();
            if lost < self.loss {
                continue;
            }
            let mut arrival = time + self.shape[0] + self.jitter * jitter(k as u64).gaussian()[0];
            if let Some((longer, share)) = self.second_delay {
                arrival += if late < share { longer - self.shape[0] } else { 0.0 };
            }
            arrivals.push((arrival, k));
        }
        arrivals.sort_by(|a, b| a.0.total_cmp(&b.0));
        arrivals
    }

    /// The loop of an estimate, for a bootstrap.
    pub(crate) fn with_noise(self, noise: Noise, deviation: f64) -> Self {
        SimulatedLoop {
            white: deviation * noise.white.sqrt(),
            coloured: (deviation * noise.coloured.sqrt(), noise.correlation_time),
            disturbance: deviation * noise.disturbance.sqrt(),
            ..self
        }
    }

    /// The loop without noise and jitter.
    #[must_use]
    pub fn without_noise(self) -> Self {
        let coloured = (0.0, self.coloured.1);
        SimulatedLoop { white: 0.0, coloured, disturbance: 0.0, jitter: 0.0, ..self }
    }
}
