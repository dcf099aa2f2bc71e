//! Observers of a trajectory.

use crate::{Float, Hamiltonian, State};

/// A trajectory at one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<S, const D: usize> {
    /// Number of steps taken from the start.
    pub step: u64,
    /// Time since the start, `step · Δt`, in seconds: a product, never a running sum.
    pub time: f64,
    /// The state after `step` steps.
    pub state: State<S, D>,
}

/// Sees the start and the state after every step.
pub trait Observer<S, const D: usize> {
    /// Takes note of one sample.
    fn observe(&mut self, sample: &Sample<S, D>);
}

impl<S, const D: usize, F: FnMut(&Sample<S, D>)> Observer<S, D> for F {
    #[inline(always)]
    fn observe(&mut self, sample: &Sample<S, D>) {
        self(sample);
    }
}

/// Nobody watches.
impl<S, const D: usize> Observer<S, D> for () {
    #[inline(always)]
    fn observe(&mut self, _: &Sample<S, D>) {}
}

/// Two observers watch, in this order.
impl<S, const D: usize, A: Observer<S, D>, B: Observer<S, D>> Observer<S, D> for (A, B) {
    #[inline(always)]
    fn observe(&mut self, sample: &Sample<S, D>) {
        self.0.observe(sample);
        self.1.observe(sample);
    }
}

/// Passes on every `n`-th sample, beginning with the start.
#[derive(Clone, Debug)]
pub struct Every<O> {
    /// The stride, in steps; at least 1.
    pub n: u64,
    /// The observer of those samples.
    pub observer: O,
}

impl<S, const D: usize, O: Observer<S, D>> Observer<S, D> for Every<O> {
    #[inline(always)]
    fn observe(&mut self, sample: &Sample<S, D>) {
        if sample.step.is_multiple_of(self.n.max(1)) {
            self.observer.observe(sample);
        }
    }
}

/// The running maximum of the relative energy drift `|E − E₀| / |E₀|`.
///
/// The energies are taken in the float type of the simulation and compared in `f64`. Where
/// `E₀ = 0` the drift is absolute.
#[derive(Clone, Copy, Debug)]
pub struct EnergyDrift<Sys> {
    system: Sys,
    initial: f64,
    lowest: f64,
    highest: f64,
    largest: f64,
    at_step: u64,
}

impl<Sys> EnergyDrift<Sys> {
    /// The drift of `system` from its energy at `start`.
    pub fn new<S: Float, const D: usize>(system: Sys, start: &State<S, D>) -> Self
    where
        Sys: Hamiltonian<S, D>,
    {
        let initial = system.energy(start).to_f64();
        EnergyDrift { system, initial, lowest: 0.0, highest: 0.0, largest: 0.0, at_step: 0 }
    }

    /// The relative drift of `state`, with its sign.
    #[inline(always)]
    pub fn of<S: Float, const D: usize>(&self, state: &State<S, D>) -> f64
    where
        Sys: Hamiltonian<S, D>,
    {
        let difference = self.system.energy(state).to_f64() - self.initial;
        if self.initial == 0.0 { difference } else { difference / self.initial.abs() }
    }

    /// Energy at the start, in J/kg.
    pub fn initial(&self) -> f64 {
        self.initial
    }

    /// Largest drift so far, by absolute value; NaN once an energy was NaN.
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// The step at which the largest drift was first reached.
    pub fn at_step(&self) -> u64 {
        self.at_step
    }

    /// Lowest and highest drift so far, with their signs.
    pub fn range(&self) -> (f64, f64) {
        (self.lowest, self.highest)
    }
}

impl<S: Float, const D: usize, Sys: Hamiltonian<S, D>> Observer<S, D> for EnergyDrift<Sys> {
    #[inline(always)]
    fn observe(&mut self, sample: &Sample<S, D>) {
        let drift = self.of(&sample.state);
        self.lowest = self.lowest.min(drift);
        self.highest = self.highest.max(drift);
        let size = drift.abs();
        if size > self.largest || size.is_nan() {
            self.largest = size;
            self.at_step = sample.step;
        }
    }
}
