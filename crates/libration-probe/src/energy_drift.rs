//! Drift of the energy along a trajectory, and its reason.

use serde::Serialize;

use crate::BlackBoxError;
use crate::convergence::displaced;
use crate::energy_trajectory::Trajectory;
use crate::prober::Prober;

/// Periods of the slowest mode that a trajectory should have, and the most steps for them.
const PERIODS: f64 = 20.0;
const MOST_STEPS: usize = 100_000;
/// Steps of a trajectory of a system that conserves its energy, where a slow drift matters.
const CONSERVATIVE_STEPS: usize = 20_000;
/// Those of other systems.
const STEPS: usize = 2_000;
/// Part of the scales by which the state is displaced.
const DISPLACEMENT: f64 = 0.1;
/// Drifts per step below this, relative to the energy of the displacement, are roundings.
const ROUNDING: f64 = 1e-13;
/// Change over a trajectory of a system that conserves its energy that is a fault: half a percent of an amplitude.
const CLEAR: f64 = 0.01;
/// The same of growth in any other system, whose shorter steps show that the step makes it.
const GROWN: f64 = 0.1;
/// A change from which its direction does not matter: the energy itself.
const WHOLE: f64 = 1.0;
/// A motion that exchanges more than this times the energy of its start has left the neighbourhood of the equilibrium, whose energy is no
/// scale of it.
const LEFT: f64 = 4.0;
/// Part of the size by the scales below which energy that a motion exchanges is no scale of it: it hardly moves.
const SCARCE: f64 = 1e-3;
/// Parts of a step whose trajectory shows what the system does by itself, and the most steps of it.
const PARTS: usize = 8;
const MOST_PARTS: usize = 200_000;
/// By a method of order 1 the logarithm of a growth falls to an eighth, and a blow-up comes eight times as late; of the system, neither.
const LESS: f64 = 2.0;
const LATER: f64 = 1.8;

/// The drift of the energy.
#[derive(Clone, Debug, Serialize)]
pub struct EnergyDrift {
    /// Rate of the energy in 1/s, relative to that of a displacement from an equilibrium. Off one relative to the kinetic energy of the motion,
    /// which does not depend on the zero of the energy. Without velocities, and of a motion that leaves its equilibrium, relative to the
    /// largest energy that a single state of it adds; if none adds any, to half of the slope of the energy along a state times the scale of
    /// this state. Of a system that changes its energy, that of an exponential.
    pub rate: f64,
    /// The same with half the step.
    pub rate_halved: Option<f64>,
    /// Steps of the trajectory.
    pub steps: usize,
    /// The smallest rate that the trajectory resolves, in 1/s.
    pub resolution: f64,
    /// The reason.
    pub reason: DriftReason,
    /// Change of the energy over the trajectory, relative as the rate. None: it leaves the finite numbers.
    pub change: Option<f64>,
    /// Whether the energy changes in one direction: no eighth of the trajectory takes back a part of the change.
    pub is_steady: bool,
    /// Whether the change is one of the step and not of the system, by a trajectory with an eighth of the step. None: there is none.
    pub is_of_step: Option<bool>,
}

/// Why an energy drifts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DriftReason {
    /// It does not, within the resolution.
    None,
    /// The rate falls with the step.
    Truncation,
    /// The rate does not depend on the step: the system is not conservative.
    System,
    /// The rate grows when the step is halved.
    Rounding,
    /// The trajectory leaves the finite numbers.
    Divergence,
    /// The simulator has one step only.
    Unknown,
    /// The rate changes little with the step, but is not the same.
    Unclear,
    /// The trajectory has few periods of the slowest mode, and its oscillation looks like a drift.
    Short,
}

impl DriftReason {
    /// The reason in words.
    pub fn text(self) -> &'static str {
        match self {
            DriftReason::None => "no drift within the resolution",
            DriftReason::Truncation => "truncation: the rate falls with the step",
            DriftReason::System => "the system itself: the rate does not depend on the step",
            DriftReason::Rounding => "rounding: the rate grows when the step is halved",
            DriftReason::Divergence => "the trajectory diverges",
            DriftReason::Unclear => {
                "unknown: the rate neither falls with the step nor stays the same"
            }
            DriftReason::Short => "unknown: the trajectory has few periods of the slowest mode",
            DriftReason::Unknown => "unknown: the simulator has one step only",
        }
    }
}

impl EnergyDrift {
    /// The drift over a trajectory from a displaced state; none if the energy is unknown.
    pub(crate) fn measure(
        prober: &mut Prober<'_>,
        longest_period: f64,
        is_at_rest: bool,
        pairs: Option<&[(usize, usize)]>,
    ) -> Result<Option<Self>, BlackBoxError> {
        let subject = prober.subject;
        let start = displaced(prober, DISPLACEMENT);
        let (Some(rest), Some(energy)) = (prober.energy(&subject.state)?, prober.energy(&start)?)
        else {
            return Ok(None);
        };
        let least = if subject.is_conservative { CONSERVATIVE_STEPS } else { STEPS };
        let wanted = PERIODS * longest_period / subject.dt;
        let steps = least.max((wanted as usize).min(MOST_STEPS)) / 2 * 2;
        let is_short = wanted > 2.0 * steps as f64;
        let size = if is_at_rest { energy - rest } else { energy_size(prober, rest)? };
        let size = size.abs().max(f64::MIN_POSITIVE);
        let mut full = Trajectory::run(prober, &start, subject.dt, steps, size)?;
        let mut found = EnergyDrift {
            rate: f64::INFINITY,
            rate_halved: None,
            steps: full.energies.len(),
            resolution: 0.0,
            reason: DriftReason::Divergence,
            change: None,
            is_steady: true,
            is_of_step: None,
        };
        let shorter = subject.dt / PARTS as f64;
        if !full.is_finite {
            if !subject.has_fixed_dt {
                let steps = (2 * PARTS * (full.energies.len() + 1)).min(MOST_PARTS);
                let other = Trajectory::run(prober, &start, shorter, steps, size)?;
                let ratio = other.energies.len() as f64 / (PARTS * found.steps.max(1)) as f64;
                // A blow-up of the system comes at its own time, whatever the step.
                let is_decided = !other.is_finite || ratio > LATER;
                found.is_of_step = is_decided.then_some(ratio > LATER);
            }
            return Ok(Some(found));
        }
        let mut size = size;
        let mut half = match subject.has_fixed_dt {
            true => None,
            false => Some(Trajectory::run(prober, &start, subject.dt / 2.0, 2 * steps, size)?)
                .filter(|half| half.is_finite),
        };
        // Energy that the step adds is no scale: a step of half the length adds less.
        let of = |trajectory: &Trajectory, prober: &mut Prober<'_>| match pairs {
            Some(pairs) if !is_at_rest => trajectory.kinetic(prober, pairs),
            _ => trajectory.exchanged(prober),
        };
        let exchanged = match &half {
            Some(half) => of(&full, prober)?.min(of(half, prober)?),
            None => of(&full, prober)?,
        };
        let is_scale = match is_at_rest {
            true => exchanged > LEFT * size && half.is_some(),
            false => exchanged > SCARCE * size,
        };
        if is_scale {
            for trajectory in [Some(&mut full), half.as_mut()].into_iter().flatten() {
                trajectory.change_unit(size, exchanged);
            }
            size = exchanged;
        }
        let halved = half.map(|half| half.rate().0);
        let (change, is_steady) = full.change();
        let (rate, wobble) = full.rate();
        let rounding = ROUNDING / subject.dt * (energy.abs() / size).max(1.0);
        let is_clear = (is_steady && change.abs() > CLEAR) || change.abs() > WHOLE;
        found.resolution = if is_clear { rounding } else { wobble.max(rounding) };
        found.reason = match halved {
            _ if rate.abs() <= found.resolution => DriftReason::None,
            _ if is_short => DriftReason::Short,
            None => DriftReason::Unknown,
            Some(half) => {
                let ratio = rate.abs() / half.abs().max(f64::MIN_POSITIVE);
                match ratio {
                    0.97..=1.03 => DriftReason::System,
                    ratio if ratio > 1.25 => DriftReason::Truncation,
                    ratio if ratio < 0.8 => DriftReason::Rounding,
                    _ => DriftReason::Unclear,
                }
            }
        };
        // A line is less steep than the exponential at the start of the trajectory.
        let mut steeper = 1.0;
        if found.reason == DriftReason::System {
            match full.exponential_rate(change).filter(|own| own * rate > 0.0) {
                Some(own) => steeper = own / rate,
                None => found.reason = DriftReason::Unclear,
            }
        }
        (found.rate, found.rate_halved) = (steeper * rate, halved.map(|half| steeper * half));
        (found.change, found.is_steady) = (Some(change), is_steady);
        let is_asked = !subject.is_conservative && !subject.has_fixed_dt;
        if is_asked && found.exceeds(change, GROWN) {
            let other = Trajectory::run(prober, &start, shorter, PARTS * steps, size)?;
            let by_system = match other.is_finite {
                true => other.change().0.max(0.0).ln_1p(),
                false => f64::INFINITY,
            };
            found.is_of_step = Some(by_system < change.ln_1p() / LESS);
        }
        Ok(Some(found))
    }

    /// Whether a trajectory that leaves the finite numbers does so by the system itself.
    pub(crate) fn is_unexamined(&self) -> bool {
        self.reason == DriftReason::Short
            || (self.reason == DriftReason::Divergence && self.is_of_step != Some(true))
    }

    /// Whether the energy changes too much: in one direction by [`CLEAR`] where it is conserved, by [`GROWN`] in any system that does not do
    /// so itself; else by [`WHOLE`].
    pub(crate) fn is_fault(&self, is_conservative: bool) -> bool {
        if matches!(self.reason, DriftReason::System | DriftReason::Short) {
            return false;
        }
        let is_of_step = self.is_of_step == Some(true);
        match self.change {
            None => is_of_step,
            Some(change) if is_conservative => self.exceeds(change.abs(), CLEAR),
            Some(change) => self.exceeds(change, GROWN) && is_of_step,
        }
    }

    fn exceeds(&self, change: f64, limit: f64) -> bool {
        (self.is_steady && change > limit) || change > WHOLE
    }
}

/// The size of the energy that does not depend on its zero: for a square of a state at its scale the energy itself.
fn energy_size(prober: &mut Prober<'_>, here: f64) -> Result<f64, BlackBoxError> {
    let subject = prober.subject;
    let mut size = 0.0_f64;
    for i in 0..subject.state.len() {
        let mut at = |side: f64| {
            let mut x = subject.state.clone();
            x[i] += side * DISPLACEMENT * subject.state_scale[i];
            prober.energy(&x)
        };
        let (Some(above), Some(below)) = (at(1.0)?, at(-1.0)?) else { continue };
        let slope = (above - below).abs() / (4.0 * DISPLACEMENT);
        let bend = (above + below - 2.0 * here).abs() / 2.0;
        // `max` leaves out what is not a number.
        size = [slope, bend].into_iter().filter(|x| x.is_finite()).fold(size, f64::max);
    }
    Ok(size)
}
