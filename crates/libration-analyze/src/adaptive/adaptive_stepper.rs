//! Steps whose length follows the motion.

use libration::equations::{Evaluation, Flow};

use super::{AdaptivePrograms, StepControl};

/// Why a motion with adaptive steps cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AdaptiveFailure {
    /// The state is not finite.
    NotFinite,
    /// The density of steps is not positive, or far from the frequency of the forces: the steps are too long, or the frequency passes near
    /// zero.
    Density,
    /// The equation of a symmetric step has no solution near the last: the steps are too long for the motion.
    NoSolution,
    /// Steps are so short that time stands still, as in a collision.
    NoTime,
    /// Numbers are too large for the grid.
    OffGrid,
}

/// A motion whose steps follow the local frequency `ω` of its forces: a step is `dt·ω₀/ω`, with `ω₀` at the start.
#[derive(Debug)]
pub struct AdaptiveStepper<'p> {
    control: StepControl,
    /// The length of the first step.
    dt: f64,
    /// The fourth power of the frequency at the start.
    reference: f64,
    step: Evaluation<'p, f64>,
    frequency: Evaluation<'p, f64>,
    accelerations: Evaluation<'p, f64>,
    flows: Option<&'p [Flow]>,
    /// Positions and velocities, the inputs of the system, and the time step.
    state: Vec<f64>,
    states: usize,
    next: Vec<f64>,
    /// The density of the last step; of an integrating control that of half a step before the state.
    density: f64,
    time: f64,
    last_length: f64,
    /// The spacing of the grid on which states and density lie, of a motion that is reversible to the bits.
    grid: Option<f64>,
    evaluations: u64,
}

/// The part of the frequency at the start below which steps no longer grow: where forces vanish a step stays finite.
const LEAST_FREQUENCY: f64 = 1e-5;

/// Largest ratio of an integrated density and the frequency of the forces.
const MOST_RATIO: f64 = 8.0;

/// Iterations of the equation of a symmetric step.
const MOST_ITERATIONS: usize = 60;

impl<'p> AdaptiveStepper<'p> {
    /// From positions and velocities. None if forces do not change in space at the start, or its frequency is not finite.
    pub fn new(
        programs: &'p AdaptivePrograms,
        control: StepControl,
        start: &[f64],
        dt: f64,
    ) -> Option<Self> {
        let states = start.len();
        let mut state = start.to_vec();
        state.resize(states + programs.dynamics.inputs() + 1, 0.0);
        let mut stepper = AdaptiveStepper {
            control,
            dt,
            reference: 1.0,
            step: programs.step.program().on(),
            frequency: programs.frequency.on(),
            accelerations: programs.dynamics.accelerations().on(),
            flows: None,
            next: Vec::with_capacity(states),
            state,
            states,
            density: 1.0,
            time: 0.0,
            last_length: 0.0,
            grid: None,
            evaluations: 0,
        };
        let [power, _] = stepper.fourth_power();
        if !(power > 0.0 && power.is_finite()) {
            return None;
        }
        stepper.reference = power;
        stepper.begin();
        Some(stepper)
    }

    /// The same on a grid of a power of two: positions, velocities and the density of steps are multiples of it, and a step back undoes a
    /// step to the last bit, as long as all are below 2⁵³ multiples (D. Levesque, L. Verlet, *Journal of Statistical Physics* 72, 1993).
    ///
    /// None if the integrator is not symmetric, no sequence of kicks and drifts, or the control is not integrating.
    pub fn on_grid(mut self, programs: &'p AdaptivePrograms, exponent: i32) -> Option<Self> {
        let flows = programs.flows.as_deref()?;
        if !programs.is_symmetric() || self.control != StepControl::Integrating {
            return None;
        }
        let spacing = 2.0_f64.powi(exponent);
        self.grid = Some(spacing);
        self.flows = Some(flows);
        for x in &mut self.state[..self.states] {
            *x = rounded(*x, spacing);
        }
        self.density = 1.0;
        self.begin();
        Some(self)
    }

    /// The density half a step before the start.
    fn begin(&mut self) {
        if self.control == StepControl::Integrating {
            let change = 0.5 * self.dt * self.density_rate();
            self.density = 1.0;
            self.density -= self.on_spacing(change);
        }
    }

    fn on_spacing(&self, x: f64) -> f64 {
        self.grid.map_or(x, |spacing| rounded(x, spacing))
    }

    /// The fourth power of the frequency and its rate of change.
    fn fourth_power(&mut self) -> [f64; 2] {
        let mut out = self.frequency.run(&self.state[..self.state.len() - 1]);
        [out.next().unwrap_or(f64::NAN), out.next().unwrap_or(f64::NAN)]
    }

    /// The density of steps at the state: the frequency over that of the start, with a floor.
    fn density_here(&mut self) -> f64 {
        let [power, _] = self.fourth_power();
        (power / self.reference + LEAST_FREQUENCY.powi(4)).sqrt().sqrt()
    }

    /// The rate of change of the density along the motion, per unit of the fictitious time in which steps are equal.
    fn density_rate(&mut self) -> f64 {
        let [power, rate] = self.fourth_power();
        let floored = power + LEAST_FREQUENCY.powi(4) * self.reference;
        // ρ = x^(1/4), so that ρ̇/ρ = ẋ/4x.
        0.25 * rate / floored
    }

    /// Whether a density is that of the forces. Where their frequency passes near zero, one that is integrated loses it.
    fn is_lost(&mut self, density: f64) -> bool {
        let ratio = density / self.density_here();
        !(1.0 / MOST_RATIO..MOST_RATIO).contains(&ratio)
    }

    /// Takes a step.
    ///
    /// # Errors
    /// [`AdaptiveFailure`]; the state is then that before the step.
    pub fn advance(&mut self) -> Result<(), AdaptiveFailure> {
        let length = match self.control {
            StepControl::Naive => self.dt / self.density_here(),
            StepControl::Symmetric => return self.symmetric_step(),
            StepControl::Integrating => {
                let change = self.dt * self.density_rate();
                let next = self.density + self.on_spacing(change);
                if next.is_nan() || next <= 0.0 || self.is_lost(next) {
                    return Err(AdaptiveFailure::Density);
                }
                self.density = next;
                self.dt / next
            }
        };
        self.evaluate(length)?;
        self.accept(length)
    }

    /// A step whose length is the mean of the lengths at its ends.
    fn symmetric_step(&mut self) -> Result<(), AdaptiveFailure> {
        let before = 1.0 / self.density_here();
        let start = self.state.clone();
        // The length with which the last step ended is near.
        let mut length = if self.last_length > 0.0 { self.last_length } else { self.dt * before };
        let mut last_change = f64::INFINITY;
        let mut before_that: Option<(f64, f64)> = None;
        for _ in 0..MOST_ITERATIONS {
            let ran = self.evaluate(length);
            self.state[..self.states].copy_from_slice(&self.next);
            let after = 1.0 / self.density_here();
            self.state.copy_from_slice(&start);
            ran?;
            let wanted = self.dt * 0.5 * (before + after);
            let excess = wanted - length;
            if excess.abs() <= 2.0 * f64::EPSILON * length
                || (excess.abs() <= 1e-12 * length && excess.abs() >= last_change)
            {
                return self.accept(length);
            }
            // The secant of the last two, or the iteration itself.
            let next = match before_that {
                Some((old, old_excess)) if old_excess != excess => {
                    length - excess * (length - old) / (excess - old_excess)
                }
                _ => wanted,
            };
            before_that = Some((length, excess));
            last_change = excess.abs();
            length = if next > 0.0 && next.is_finite() { next } else { wanted };
        }
        Err(AdaptiveFailure::NoSolution)
    }

    /// Writes the state after a step of a length to `next`.
    fn evaluate(&mut self, length: f64) -> Result<(), AdaptiveFailure> {
        self.next.clear();
        match (self.flows, self.grid) {
            (Some(flows), Some(spacing)) => {
                self.next.extend_from_slice(&self.state[..self.states]);
                let half = self.states / 2;
                for flow in flows {
                    match *flow {
                        Flow::Drift(part) => {
                            let (q, v) = self.next.split_at_mut(half);
                            for (q, v) in q.iter_mut().zip(v) {
                                *q += rounded(part * length * *v, spacing);
                            }
                        }
                        Flow::Kick(part) => {
                            let mut inputs = self.next.clone();
                            inputs.extend_from_slice(&self.state[self.states..]);
                            let accelerations = self.accelerations.run(&inputs);
                            for (v, a) in self.next[half..].iter_mut().zip(accelerations) {
                                *v += rounded(part * length * a, spacing);
                            }
                        }
                    }
                }
            }
            _ => {
                if let Some(last) = self.state.last_mut() {
                    *last = length;
                }
                self.next.extend(self.step.run(&self.state));
            }
        }
        self.evaluations += 1;
        match self.next.iter().all(|x| x.is_finite()) {
            true => Ok(()),
            false => Err(AdaptiveFailure::NotFinite),
        }
    }

    fn accept(&mut self, length: f64) -> Result<(), AdaptiveFailure> {
        if self.time + length == self.time {
            return Err(AdaptiveFailure::NoTime);
        }
        // Beyond 2⁵³ multiples sums on the grid are rounded.
        let most = self.grid.map_or(f64::INFINITY, |spacing| spacing * 2.0_f64.powi(53));
        if self.next.iter().any(|x| x.abs() >= most) || self.density >= most {
            return Err(AdaptiveFailure::OffGrid);
        }
        self.state[..self.states].copy_from_slice(&self.next);
        self.time += length;
        self.last_length = length;
        Ok(())
    }

    /// Turns the motion around: the next steps go back.
    pub fn reverse(&mut self) {
        if self.control == StepControl::Integrating {
            let change = self.dt * self.density_rate();
            self.density += self.on_spacing(change);
        }
        self.state[self.states / 2..self.states].iter_mut().for_each(|v| *v = -*v);
    }

    /// Positions and velocities.
    pub fn state(&self) -> &[f64] {
        &self.state[..self.states]
    }

    /// The sum of the lengths of the steps.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The length of the last step.
    pub fn last_length(&self) -> f64 {
        self.last_length
    }

    /// Steps that were evaluated; a symmetric control evaluates several for each.
    pub fn evaluated_steps(&self) -> u64 {
        self.evaluations
    }
}

/// The multiple of a power of two that is nearest to `x`.
fn rounded(x: f64, spacing: f64) -> f64 {
    (x / spacing).round_ties_even() * spacing
}
