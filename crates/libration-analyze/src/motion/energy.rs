//! The energy of a motion under steps, beside that of the exact motion.

use libration::equations::{Dynamics, Evaluation};
use serde::Serialize;

use super::MotionSubject;
use super::reference::Reference;

/// The largest change of the energy.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EnergyChange {
    /// The energy at the start.
    pub start: f64,
    /// The unit; empty without one.
    pub unit: String,
    /// Number of steps.
    pub steps: u64,
    /// The largest absolute change.
    pub largest: f64,
    /// The step at which it occurs.
    pub largest_at_step: u64,
    /// The change in the end.
    pub last: f64,
    /// The energy that the exact motion exchanges: the largest of the kinetic energy and of the ranges of potential and total energy. A
    /// constant that is added to the potential does not change it. None of a motion without such an exchange.
    pub scale: Option<f64>,
    /// The largest change of the energy in the exact motion; none if that is not known.
    pub exact_change: Option<f64>,
    /// The largest difference from the exact motion at samples; none if that is not known.
    pub error: Option<f64>,
    /// The factor by which a halved step reduces the largest change over the same time, measured; none without a change.
    pub reduction: Option<f64>,
}

impl EnergyChange {
    /// Of a motion whose energy at the start is `start`.
    pub(super) fn new(of: &mut EnergyOf<'_>, subject: &MotionSubject<'_>, steps: u64) -> Self {
        EnergyChange {
            start: of.total(subject.start),
            unit: subject.energy_unit.to_owned(),
            steps,
            largest: 0.0,
            largest_at_step: 0,
            last: 0.0,
            scale: None,
            exact_change: None,
            error: None,
            reduction: None,
        }
    }

    /// Adds the energy after a step.
    pub(super) fn add(&mut self, step: u64, energy: f64) {
        self.last = energy - self.start;
        // The first energy that is no finite number has the largest change.
        let is_first = self.largest.is_finite() && !self.last.is_finite();
        if is_first || self.last.abs() > self.largest {
            (self.largest, self.largest_at_step) = (self.last.abs(), step);
        }
    }

    /// Adds the energy of the exact motion.
    pub(super) fn compare(
        &mut self,
        of: &mut EnergyOf<'_>,
        start: &[f64],
        samples: &[Vec<f64>],
        reference: &Reference,
    ) {
        let mut scale = EnergyScale::new();
        let before = scale.add(of, start);
        let (mut error, mut change) = (0.0_f64, 0.0_f64);
        let known = reference.known();
        for (exact, own) in reference.exact.states.iter().zip(samples).take(known) {
            let energy = scale.add(of, exact);
            error = error.max((of.total(own) - energy).abs());
            change = change.max((energy - before).abs());
        }
        if known > 0 {
            (self.error, self.exact_change) = (Some(error), Some(change));
        } else {
            for own in samples {
                scale.add(of, own);
            }
        }
        self.scale = scale.value();
    }
}

/// The energy of states.
pub(crate) struct EnergyOf<'a> {
    program: Evaluation<'a, f64>,
    degrees: usize,
    at_rest: Vec<f64>,
}

impl<'a> EnergyOf<'a> {
    /// None without an energy.
    pub(crate) fn new(dynamics: &'a Dynamics) -> Option<Self> {
        let program = dynamics.energy()?.on::<f64>();
        Some(EnergyOf { program, degrees: dynamics.degrees(), at_rest: Vec::new() })
    }

    pub(crate) fn total(&mut self, state: &[f64]) -> f64 {
        self.program.run(state).next().unwrap_or(f64::NAN)
    }

    /// The energy with velocities of zero, and states of first order of zero.
    pub(crate) fn potential(&mut self, state: &[f64]) -> f64 {
        self.at_rest.clear();
        self.at_rest.extend_from_slice(state);
        self.at_rest[self.degrees..2 * self.degrees].fill(0.0);
        self.program.run(&self.at_rest).next().unwrap_or(f64::NAN)
    }
}

/// The scale of the energy of a motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EnergyScale {
    kinetic: f64,
    potential: [f64; 2],
    total: [f64; 2],
}

impl EnergyScale {
    pub(crate) fn new() -> Self {
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        EnergyScale { kinetic: 0.0, potential: none, total: none }
    }

    /// Adds a state, and returns its energy.
    pub(crate) fn add(&mut self, energy: &mut EnergyOf<'_>, state: &[f64]) -> f64 {
        let (total, potential) = (energy.total(state), energy.potential(state));
        if total.is_finite() && potential.is_finite() {
            let wider = |[low, high]: [f64; 2], x: f64| [low.min(x), high.max(x)];
            self.kinetic = self.kinetic.max((total - potential).abs());
            self.potential = wider(self.potential, potential);
            self.total = wider(self.total, total);
        }
        total
    }

    pub(crate) fn value(self) -> Option<f64> {
        let range = |[low, high]: [f64; 2]| if high > low { high - low } else { 0.0 };
        let value = self.kinetic.max(range(self.potential)).max(range(self.total));
        (value > 0.0 && value.is_finite()).then_some(value)
    }
}
