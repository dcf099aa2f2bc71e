//! Errors of simulations without a loop.

use std::f64::consts::TAU;

use libration::{Integrator, Method};
use libration_work::Work;

use super::AdviseError;
use super::integrator_choice::StepTrial;
use super::motion_rates::{EnergyKind, MotionRates};
use super::request::{Measure, Request, steps_over};
use super::system_programs::{Steps, SystemPrograms};

/// The motion of a system from its start over a horizon.
pub(super) struct FreeMotion<'a> {
    pub(super) system: &'a SystemPrograms<'a>,
    /// Positions, then velocities.
    pub(super) start: Vec<f64>,
    pub(super) horizon: f64,
    pub(super) of: Measure,
    /// The mean one scales velocities to lengths.
    pub(super) rates: MotionRates,
    /// The energy that errors of the energy are relative to.
    pub(super) energy_scale: Option<f64>,
    /// Whether that is the energy at the start, since the motion has no kinetic energy.
    pub(super) is_relative_to_start: bool,
}

/// The angle of the fastest motion in a step below which errors fall with the step, in rad.
const RESOLVED: f64 = 0.1;

/// Reference steps of order four per step of a method of order four. Their error is 1/4096 of its.
const FINER: u32 = 8;

/// The references of methods of high orders, where forces depend on positions alone and where they do not, in at least two steps per step
/// of a method of order four, and three per step of others.
const PRECISE: [&str; 2] = ["sofroniou-spaletta-10-35", "dormand-prince-8"];

/// The largest turn of the fastest motion in such a reference step, in rad: the leading error of a step of the first is 4·10⁻¹² there, by its
/// error constant. Tables take steps of several radians, in which those of as long references would be as large.
const PRECISE_TURN: f64 = 0.35;

/// The most reference steps per step: a turn of 22 rad. The stiffest rate of a motion may be far above the fastest that its steps follow.
const MOST_FINER: f64 = 64.0;

/// Reference steps per step of a method of some order in which the fastest motion turns by `angle`, so that their error is 1/4096 of its.
///
/// Errors of the orders `p` and 4 of steps that are `n` times as short have the ratio `angle^(4 − p)/n⁴`.
fn finer(order: u32, angle: f64) -> u32 {
    // The phase of a first-order method may be of second order.
    let difference = 4_u32.saturating_sub(order.max(2));
    let number = f64::from(FINER) * angle.min(1.0).powf(f64::from(difference) / 4.0);
    // Of an infinite angle, or of none, the most.
    if number > 0.0 { number.ceil() as u32 } else { FINER }
}

/// Safety factor of errors against the reference, so that advised steps meet the tolerance against the true motion.
const WIDER: f64 = 1.001;

/// Steps between two checks of the stop flag.
const LOOK: u64 = 1 << 16;

impl<'a> FreeMotion<'a> {
    /// The motion of `request`.
    pub(super) fn new(
        work: &Work<'_>,
        system: &'a SystemPrograms<'a>,
        request: &Request,
    ) -> Result<Self, AdviseError> {
        let start = request.system.initial_state();
        let of = request.tolerance.of;
        let tolerance_error = |why: &str| Err(AdviseError::Tolerance { of, why: why.into() });
        if of == Measure::Cost {
            return tolerance_error(
                "a cost requires a loop; add a controller, or set a tolerance of energy, phase or trajectory",
            );
        }
        let is_plane = system.degrees() == 1 && system.states().len() == 2;
        if of == Measure::Phase && !is_plane {
            return tolerance_error(
                "a phase requires one degree of freedom, and forces without time",
            );
        }
        if of == Measure::Energy && system.energy().is_none() {
            return tolerance_error(
                "the system has no `energy`; add one, or set a tolerance of trajectory",
            );
        }
        let rates = MotionRates { mean: 1.0, fastest: 1.0, stiffest: 1.0 };
        let (energy_scale, is_relative_to_start) = (None, false);
        let horizon = request.horizon;
        let free =
            FreeMotion { system, start, horizon, of, rates, energy_scale, is_relative_to_start };
        let mut free = FreeMotion { rates: free.rates(work)?, ..free };
        if of == Measure::Energy {
            match free.energy_kind(&free.rates) {
                EnergyKind::Kept => {}
                EnergyKind::Lost => {
                    return tolerance_error(
                        "the system does not conserve it; set a tolerance of trajectory",
                    );
                }
            }
            free.energy_scale = free.energy_scale(work)?;
            if free.energy_scale.is_none() {
                // Such as of states of first order alone.
                let start = system.energy().map(|mut energy| energy(&free.start).abs());
                free.energy_scale = start.filter(|start| start.is_finite() && *start > 0.0);
                free.is_relative_to_start = true;
            }
            if free.energy_scale.is_none() {
                return tolerance_error(
                    "the motion has no kinetic energy and the energy at the start is zero, so a relative error is undefined; set a tolerance of trajectory",
                );
            }
        }
        let [least, longest] = free.steps();
        if least > longest {
            let why = format!(
                "its motion requires steps of at most {longest:.3e} s, which are {:.1e} steps over the horizon; a search takes at most \
                 {:.0e}; choose a shorter horizon",
                free.horizon / longest,
                free.horizon / least
            );
            return tolerance_error(&why);
        }
        Ok(free)
    }

    /// The angle of the fastest motion in a step of `dt` seconds, in rad; zero without forces that depend on the state.
    pub(super) fn turn(&self, dt: f64) -> f64 {
        self.rates.stiffest * dt
    }

    /// The shortest and the longest tried step.
    pub(super) fn steps(&self) -> [f64; 2] {
        let is_compared = self.of != Measure::Energy && self.system.exact_rate().is_none();
        let most = self.system.most_steps()[usize::from(is_compared)];
        let longest = (4.0 / self.rates.fastest).min(self.horizon);
        [self.horizon / most, longest]
    }

    /// The shortest and the longest tried step of a method; a step with many evaluations is tried as long as many steps with few. The shortest
    /// is longer than the longest if the horizon is too long for the method.
    pub(super) fn steps_of(&self, method: Method) -> [f64; 2] {
        let [shortest, longest] = self.steps();
        let share = (method.evaluations() / Method::Rk4.evaluations()).max(1);
        [share as f64 * shortest, longest]
    }

    /// The method of reference steps, and how many are one step of `method`.
    fn reference_of(&self, method: Method, dt: f64) -> (Method, u32) {
        let is_splitting = matches!(method, Method::Splitting(_));
        if method.order() > 4 || (is_splitting && method.order() == 4) {
            let name = PRECISE[usize::from(!self.system.is_positional())];
            let least = if method.order() == 4 { 2.0 } else { 3.0 };
            let times = (self.turn(dt) / PRECISE_TURN).ceil().clamp(least, MOST_FINER);
            return (Method::from_name(name).unwrap_or(Method::Suzuki4), times as u32);
        }
        let finer = finer(method.order(), self.turn(dt));
        // The error of the splitting method of order 2 is a fifth of that of leapfrog.
        (self.system.reference_method(), if is_splitting { 2 * finer } else { finer })
    }

    /// The error in `f32` or `f64`.
    pub(super) fn lost_in(
        &self,
        work: &Work<'_>,
        is_narrow: bool,
        method: Method,
        dt: f64,
        most: f64,
    ) -> Result<f64, AdviseError> {
        let steps = steps_over(self.horizon, dt);
        let trajectory = (self.system.steps(is_narrow, method, dt, &self.start), steps);
        if let (Some(scale), Some(mut energy)) = (self.energy_scale, self.system.energy()) {
            let first = energy(&self.start);
            let mut error = |state: &[f64]| ((energy(state) - first) / scale).abs();
            return largest(work, trajectory, most, &mut error);
        }
        match self.system.exact_steps(dt, &self.start) {
            Some(exact) => self.reference_error(work, trajectory, most, (exact, 1)),
            None => {
                let (method, times) = self.reference_of(method, dt);
                let fine = dt / f64::from(times);
                let reference = (self.system.steps(false, method, fine, &self.start), times);
                Ok(self.reference_error(work, trajectory, most / WIDER, reference)? * WIDER)
            }
        }
    }

    /// The largest distance from the reference, so many steps of which are one of the trajectory, or the final phase error.
    fn reference_error(
        &self,
        work: &Work<'_>,
        trajectory: (Box<dyn Steps>, u64),
        most: f64,
        (mut reference, times): (Box<dyn Steps>, u32),
    ) -> Result<f64, AdviseError> {
        let mut size = self.size(&self.start);
        let mut difference = self.start.clone();
        // The phase error with all turns: a whole turn is no agreement.
        let mut ahead = 0.0_f64;
        let lost = largest(work, trajectory, most, &mut |state| {
            for _ in 1..times {
                reference.next();
            }
            let truth = reference.next();
            size = size.max(self.size(truth));
            if self.of == Measure::Phase {
                let share = self.size(state) / self.size(truth);
                let turn = self.angle(state, truth) - ahead;
                ahead += turn - TAU * (turn / TAU).round();
                // A motion of twice or half the amplitude has no comparable phase; a large phase error does not recover.
                let lost = !(0.5..2.0).contains(&share) || ahead.abs() > 4.0 * most + 2.0;
                return if lost { f64::INFINITY } else { 0.0 };
            }
            let pairs = state.iter().zip(truth);
            difference.iter_mut().zip(pairs).for_each(|(to, (a, b))| *to = a - b);
            self.size(&difference) / size
        })?;
        Ok(if self.of == Measure::Phase && lost == 0.0 { ahead.abs() } else { lost })
    }

    /// The size of a state with velocities scaled to lengths.
    fn size(&self, state: &[f64]) -> f64 {
        let (positions, velocities) = state.split_at(self.system.degrees());
        let (mut of_positions, mut of_velocities) = (0.0, 0.0);
        for &place in self.system.states() {
            match positions.get(place) {
                Some(q) => of_positions += q * q,
                None => of_velocities += velocities[place - positions.len()].powi(2),
            }
        }
        (of_positions + of_velocities / self.rates.mean.powi(2)).sqrt()
    }

    /// The angle from one state of one degree of freedom to another in the plane of position and velocity.
    fn angle(&self, a: &[f64], b: &[f64]) -> f64 {
        let (aq, av) = (a[0], a[1] / self.rates.mean);
        let (bq, bv) = (b[0], b[1] / self.rates.mean);
        (aq * bv - av * bq).atan2(aq * bq + av * bv)
    }
}

impl StepTrial for FreeMotion<'_> {
    fn lost(
        &self,
        work: &Work<'_>,
        method: Method,
        dt: f64,
        most: f64,
    ) -> Result<f64, AdviseError> {
        self.lost_in(work, false, method, dt, most)
    }

    fn resolving_step(&self) -> f64 {
        RESOLVED / self.rates.fastest
    }

    fn longest_step(&self) -> f64 {
        (4.0 / self.rates.mean).min(self.horizon)
    }
}

/// The largest value of `see` after a step, or the first above `most`; infinite if it is not finite.
fn largest(
    work: &Work<'_>,
    (mut trajectory, steps): (Box<dyn Steps>, u64),
    most: f64,
    see: &mut dyn FnMut(&[f64]) -> f64,
) -> Result<f64, AdviseError> {
    let mut largest = 0.0_f64;
    for step in 1..=steps {
        if step.is_multiple_of(LOOK) {
            work.check()?;
        }
        let here = see(trajectory.next());
        largest = if here.is_finite() { largest.max(here) } else { f64::INFINITY };
        if largest > most || largest.is_infinite() {
            break;
        }
    }
    Ok(largest)
}
