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

/// The mean growth of the energy from which it is a fault, as a part of the mean kinetic energy, which is `|E|` of a Kepler orbit and `E/2` of
/// an oscillator (virial theorem).
///
/// At the limit of [`GROWN`] an oscillator in symplectic Euler, with `ωΔt = 0.5`, has up to `2 − 2√(3/5) = 0.45`. Means of 64 states differ
/// from it: over phases and lengths of runs up to 0.68 is found.
const GROWN_IN_MEAN: f64 = 0.75;

/// The number of steps from which a mean is that of a motion: in fewer an error of first order has the size of what is exchanged.
const FEWEST: u64 = 16;

/// Roundings of an energy, whose terms are rounded one by one, with a margin.
const ROUNDINGS: f64 = 64.0;

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
    /// The growth of the energy, and the kinetic energy, at each sample; none with states of first order, whose energies are no kinetic ones.
    course: Option<Vec<[f64; 2]>>,
    /// The largest size of an energy or of a part of it.
    largest: f64,
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
        let is_coordinate = |degree: &Degree| matches!(degree, Degree::Coordinate(_));
        let has_coordinates = system.equations.degrees().iter().all(is_coordinate);
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
            course: has_coordinates.then(Vec::new),
            largest: 0.0,
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
        let potential = self.energy.potential(&state);
        let kinetic = (energy - potential).abs();
        let largest = self.largest.max(energy.abs()).max(potential.abs());
        if largest.is_finite() {
            self.largest = largest;
        }
        // The start is no mean of the motion: orbits start at a pericentre.
        if let Some(course) = self.course.as_mut().filter(|_| step > 0) {
            course.push([energy - self.first, kinetic]);
        }
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
        let is_rounding = change <= ROUNDINGS * f64::EPSILON * self.largest;
        if !self.first.is_finite() || self.looks < 2 || !self.is_passive || is_rounding {
            return None;
        }
        let part = if !change.is_finite() {
            "beyond the range of numbers".to_owned()
        } else if change > GROWN * scale {
            format!("{} % of all that the motion exchanges", number(100.0 * change / scale, 2))
        } else {
            let part = self.mean_growth().filter(|&part| part > GROWN_IN_MEAN)?;
            format!("in the mean by {} % of the mean kinetic energy", number(100.0 * part, 2))
        };
        let forces = if self.is_conservative { "conserve it" } else { "add none" };
        Some(Verdict::new(
            Outcome::Fault,
            format!(
                "the energy goes from {} to {}, {part}, though the forces {forces} at {} states that were looked at",
                number(self.first, 4),
                number(self.highest, 4),
                self.looks
            ),
        ))
    }

    /// The largest mean growth over the run, or over its last half, quarter or eighth, as a part of the mean kinetic energy.
    ///
    /// An error at a pericentre is short, and its mean is small. The kinetic energy is that of the run, or of the end if it is larger.
    fn mean_growth(&self) -> Option<f64> {
        let course = self.course.as_ref()?;
        let mean = |part: &[[f64; 2]], k: usize| {
            part.iter().map(|sample| sample[k]).sum::<f64>() / part.len() as f64
        };
        let parts = [1, 2, 4, 8].into_iter().filter(|part| self.steps / part >= FEWEST);
        let kinetic = mean(course, 1);
        let growths = parts.map(|part| {
            let end = &course[course.len() - course.len() / part as usize..];
            mean(end, 0) / kinetic.max(mean(end, 1))
        });
        growths.filter(|growth| growth.is_finite()).max_by(f64::total_cmp)
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
