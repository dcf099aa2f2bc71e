//! Velocity Verlet in one float type: predicted and measured drift from rounding.

use libration::analysis::{Cycle, LocalRounding};
use libration::integrator::VelocityVerlet;
use libration::{Float, State};
use libration_study::{Lab, log_spaced_steps};

use super::float_type::FloatType;
use super::in_float::InFloat;
use super::orbits::{Orbit, follow};
use crate::precision::PrecisionSettings;

/// Samples of the drift for each decade of steps.
const PER_DECADE: f64 = 8.0;

/// Predicted and measured result of one float type.
#[derive(Clone, Debug)]
pub(super) struct VerletRun {
    pub(super) name: &'static str,
    pub(super) bits: u32,
    pub(super) unit_roundoff: f64,
    /// Whether roundings are independent, and for how many steps at most: where a prediction can be compared.
    pub(super) comparable: Option<u64>,
    /// None where no step can be told from its rounding.
    pub(super) local: Option<LocalRounding>,
    /// The steps at which orbits were seen.
    pub(super) sampled: Vec<u64>,
    orbits: Vec<Orbit>,
    /// The cycle in which the configured orbit ends.
    pub(super) closed: Option<Closed>,
}

/// A cycle of an orbit, and the drift along it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closed {
    pub(super) cycle: Cycle,
    /// The largest drift that the orbit will ever have.
    pub(super) largest: f64,
    /// The drift after all steps by the cycle, and by taking them all.
    pub(super) last: [f64; 2],
}

/// Steps after which an orbit is not yet near its end in a cycle, in units of `1/u`. With 8 to 20 bits orbits were found
/// to close after a third of `1/u` to three times as many.
const OPEN: f64 = 1.0 / 16.0;

/// Follows orbits in the float `F`, beside the wide number `W`.
pub(super) fn run<F: Float, W: Float>(lab: &Lab<'_>, kind: &FloatType) -> Option<VerletRun> {
    let config = lab.config;
    let (&dt, steps) =
        (config.get::<PrecisionSettings>().dt.last()?, config.get::<PrecisionSettings>().steps);
    let one = InFloat::<_, F>::new(VelocityVerlet, config, dt)?;
    let sampled = log_spaced_steps(steps, PER_DECADE);
    let starts = one.starts(lab.effort.choose(16, 24, 128));
    let orbits = follow(&starts, &sampled, |s| one.step(s), |from, to| one.change(from, to));
    let u = F::UNIT_ROUNDOFF;
    // What a type that keeps its roundings can resolve is the square of that.
    let resolution = if kind.compensated { u * u } else { u };
    let open = sampled.iter().copied().rfind(|&n| n as f64 <= OPEN / resolution);
    // Types with more digits than an f64 has to spare are compared in a slower number.
    let samples = lab.effort.choose(400_000, 1_000_000, 8_000_000);
    let slow = if W::UNIT_ROUNDOFF < f64::UNIT_ROUNDOFF { 8 } else { 1 };
    Some(VerletRun {
        name: kind.name,
        bits: kind.bits,
        unit_roundoff: u,
        comparable: open.filter(|_| one.rounds_at_random(resolution)),
        local: one.rounding::<W>(samples / slow),
        sampled,
        orbits,
        closed: closes(&one, steps).filter(|_| !kind.compensated),
    })
}

/// The cycle of the configured orbit, if it ends in one within the steps.
pub(super) fn closes<I: libration::Integrator, F: Float>(
    one: &InFloat<I, F>,
    steps: u64,
) -> Option<Closed> {
    // An orbit closes after about as many steps as the significand has values.
    let hopeless = F::UNIT_ROUNDOFF * 64.0 * (steps as f64) < 1.0;
    if hopeless {
        return None;
    }
    let cycle = Cycle::find(one.start, steps, |s| one.step(s))?;
    let drift = |state: &State<F, 1>| one.change(&one.start, state);
    let (mut state, mut largest, mut known) = (one.start, 0.0_f64, 0.0);
    let last = cycle.first_visit(steps);
    for n in 0..steps {
        if n == last {
            known = drift(&state);
        }
        if n < cycle.pre_period + cycle.period {
            largest = largest.max(drift(&state).abs());
        }
        state = one.step(state);
    }
    Some(Closed { cycle, largest, last: [known, drift(&state)] })
}

impl VerletRun {
    /// Number of orbits.
    pub(super) fn count(&self) -> usize {
        self.orbits.len()
    }

    /// Mean and standard deviation of the drifts at the `i`-th of the sampled steps.
    pub(super) fn moments(&self, i: usize) -> (f64, f64) {
        let drifts = || self.orbits.iter().filter_map(|orbit| orbit.seen.get(i).copied());
        let count = self.orbits.len() as f64;
        let mean = drifts().sum::<f64>() / count;
        let squares = drifts().map(|drift| (drift - mean).powi(2)).sum::<f64>();
        (mean, (squares / (count - 1.0)).sqrt())
    }

    /// Root mean square of the drifts at the `i`-th of the sampled steps.
    pub(super) fn rms(&self, i: usize) -> f64 {
        let squares = self.orbits.iter().filter_map(|orbit| orbit.seen.get(i)).map(|d| d * d);
        (squares.sum::<f64>() / self.orbits.len() as f64).sqrt()
    }

    /// Root mean square of the drifts after the last step.
    pub(super) fn last_rms(&self) -> f64 {
        self.rms(self.sampled.len().saturating_sub(1))
    }

    /// Number of closed orbits.
    pub(super) fn repeating(&self) -> usize {
        self.orbits.iter().filter(|orbit| orbit.repeats.is_some()).count()
    }
}
