//! An energy that grows in a run although no force adds any.

use libration::Float;
use libration::equations::{Degree, Dynamics, Evaluation};
use libration::number::Dual;
use libration_report::notation::number;
use libration_report::verdict::{Outcome, Verdict};
use libration_settings::equations::EquationSystem;

use crate::motion::{EnergyOf, EnergyScale};

/// The number of states that are looked at, beside the start and the end.
const SAMPLES: u64 = 64;

/// The part of the single powers of all states up to which their sum is zero: their rounding, with a wide margin.
const ROUNDING: f64 = 1e-9;

/// The growth of the energy from which it is a fault, as a part of all that the motion exchanges: of growth without end it becomes 1.
const GROWN: f64 = 0.5;

/// The energy of a run, at states that follow no rhythm.
///
/// The power of all forces is the derivative of the energy along the flow, by dual numbers. It is taken with the velocities of the run and
/// with the opposite ones. Forces that depend on time, and those with kinks and jumps, may act between the states, and are not judged.
pub(crate) struct EnergyGrowth<'a> {
    energy: EnergyOf<'a>,
    power: Power<'a>,
    scale: EnergyScale,
    steps: u64,
    sample: u64,
    next: u64,
    first: f64,
    highest: f64,
    looks: u32,
    /// Whether no power was positive, and whether all were zero.
    is_passive: bool,
    is_conservative: bool,
}

impl<'a> EnergyGrowth<'a> {
    /// For a run of so many steps; none of a system without an energy, or with forces that are not judged.
    pub(crate) fn new(system: &'a EquationSystem, steps: u64) -> Option<Self> {
        let dynamics = system.equations.dynamics();
        let is_timeless = !system.equations.degrees().contains(&Degree::Time);
        let is_smooth = dynamics.accelerations().is_smooth() && dynamics.energy()?.is_smooth();
        (is_timeless && is_smooth).then_some(())?;
        Some(EnergyGrowth {
            energy: EnergyOf::new(dynamics)?,
            power: Power::new(dynamics)?,
            scale: EnergyScale::new(),
            steps,
            sample: 0,
            next: 0,
            first: f64::NAN,
            highest: f64::NAN,
            looks: 0,
            is_passive: true,
            is_conservative: true,
        })
    }

    /// The next step that is looked at.
    pub(crate) fn next_step(&self, step: u64) -> u64 {
        self.next.max(step + 1)
    }

    /// Looks at the state after a step, if it is one of the samples.
    pub(crate) fn observe<S: Float>(&mut self, step: u64, state: &[S]) {
        if step < self.next {
            return;
        }
        let state: Vec<f64> = state.iter().map(|x| x.to_f64()).collect();
        let energy = self.energy.total(&state);
        if step == 0 {
            (self.first, self.highest) = (energy, energy);
        }
        // An energy that is not a number counts as the highest.
        if energy.is_nan() || energy > self.highest {
            self.highest = energy;
        }
        self.scale.add(&mut self.energy, &state);
        let [power, sum] = self.power.largest(&state);
        // A power beyond the range of numbers says nothing.
        if sum.is_finite() {
            self.looks += 1;
            self.is_passive &= power <= ROUNDING * sum;
            self.is_conservative &= power.abs() <= ROUNDING * sum;
        }
        self.sample += 1;
        // Fractions of the golden ratio are never near a rhythm.
        let offset = (self.sample as f64 * 0.618_033_988_749_895).fract();
        let next = (self.sample as f64 - offset) / SAMPLES as f64 * self.steps as f64;
        self.next = (next as u64).max(step + 1).min(self.steps);
    }

    /// The verdict on an energy that grows; none if it does not, or if a force may add some.
    pub(crate) fn fault(&self) -> Option<Verdict> {
        let change = self.highest - self.first;
        let scale = self.scale.value()?;
        let is_kept = change <= GROWN * scale;
        (self.first.is_finite() && self.looks > 1 && self.is_passive && !is_kept).then(|| {
            let forces = if self.is_conservative { "conserve it" } else { "add none" };
            let part = match change.is_finite() {
                true => format!("{} % of all that the motion exchanges", number(100.0 * change / scale, 2)),
                false => "beyond the range of numbers".to_owned(),
            };
            Verdict::new(
                Outcome::Fault,
                format!(
                    "the energy goes from {} to {}, {part}, though the forces {forces} at {} states that were looked at",
                    number(self.first, 4),
                    number(self.highest, 4),
                    self.looks
                ),
            )
        })
    }
}

/// The derivative of the energy along the flow.
struct Power<'a> {
    energy: Evaluation<'a, Dual<f64>>,
    accelerations: Evaluation<'a, f64>,
    degrees: usize,
}

impl<'a> Power<'a> {
    fn new(dynamics: &'a Dynamics) -> Option<Self> {
        Some(Power {
            energy: dynamics.energy()?.on(),
            accelerations: dynamics.accelerations().on(),
            degrees: dynamics.degrees(),
        })
    }

    /// The larger power with these velocities and with the opposite ones, and the sum of its absolute parts.
    fn largest(&mut self, state: &[f64]) -> [f64; 2] {
        let mut opposite = state.to_vec();
        opposite[self.degrees..].iter_mut().for_each(|v| *v = -*v);
        let [one, other] = [state, &opposite].map(|state| self.of(state));
        if one[0] >= other[0] { one } else { other }
    }

    fn of(&mut self, state: &[f64]) -> [f64; 2] {
        let accelerations: Vec<f64> = self.accelerations.run(state).collect();
        let rates = state[self.degrees..].iter().chain(&accelerations);
        let rates: Vec<f64> = rates.copied().collect();
        let mut at: Vec<Dual<f64>> = state.iter().map(|&x| Dual::constant(x)).collect();
        let (mut power, mut sum) = (0.0, 0.0);
        for (i, rate) in rates.into_iter().enumerate() {
            at[i] = Dual { re: state[i], du: rate };
            let part = self.energy.run(&at).next().map_or(f64::NAN, |energy| energy.du);
            at[i] = Dual::constant(state[i]);
            power += part;
            sum += part.abs();
        }
        [power, sum]
    }
}
