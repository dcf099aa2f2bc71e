//! The search for limits of gains in the measured step.

use libration::linear::{Complex64, Matrix, eigenvalues};

use super::gain_limits::GainLimits;
use crate::BlackBoxError;
use crate::linearised_step::LinearisedStep;
use crate::modes::eigenvalue_errors;
use crate::prober::Prober;

/// Growth per step that is none, and errors of a factor that explain growth.
pub(super) const OUTSIDE: f64 = 1e-7;
pub(super) const ERRORS: f64 = 10.0;
/// Growth per step that errors may hide: beyond it nothing is known.
const UNKNOWN: f64 = 1e-4;
/// Off an equilibrium only modes that are fast beside the step count, by the distance of their factors from 1, and growth beyond this.
const FAST: f64 = 0.5;
const GROWTH_ON_A_MOTION: f64 = 0.01;
/// Relative distances from a predicted limit at which steps are measured.
const BESIDE: f64 = 1e-3;
/// Relative accuracy of limits by prediction, and by measured steps alone.
const RESOLUTION: [f64; 2] = [1e-9, 1e-3];
/// The gain in units of the given one at which the absence of a limit is measured.
pub(super) const FAR: f64 = 1e3;
/// Part of the largest entry of a row by which quick differences may be off.
const AGREES: f64 = 1e-4;
const MOST_SUBSTEPS: u32 = 1000;

/// The step under search.
pub(super) struct Search<'a, 'b> {
    pub(super) prober: &'a mut Prober<'b>,
    pub(super) kp: Vec<f64>,
    pub(super) kv: Vec<f64>,
    pub(super) dt: f64,
    pub(super) is_at_rest: bool,
    /// Growth per step that counts as none.
    pub(super) outside: f64,
    /// Whether few short differences give the derivatives of the step.
    pub(super) is_quick: bool,
}

/// Gains of position and velocity of all servos.
pub(super) type Gains = (Vec<f64>, Vec<f64>);

/// The largest factor that leaves the unit circle far from 1, where no mode of a system is at a step that resolves it.
pub(super) fn by_step_alone(step: &Matrix, outside: f64) -> Option<f64> {
    let factors = eigenvalues(step).unwrap_or_default();
    let leaving = |z: &&Complex64| z.norm().ln() > outside && (*z - 1.0).norm() > FAST;
    factors.iter().filter(leaving).map(|z| z.norm()).reduce(f64::max)
}

impl Search<'_, '_> {
    /// The step with these gains by few differences, if they suffice at the given gains; the given ones are set again.
    pub(super) fn step(&mut self, gains: &Gains, dt: f64) -> Result<Matrix, BlackBoxError> {
        self.prober.set_gains(&gains.0, &gains.1)?;
        let step = self.linearised(dt);
        self.prober.set_gains(&self.kp, &self.kv)?;
        Ok(step?.a)
    }

    /// Whether the step with these gains is stable, by all differences.
    fn holds(&mut self, gains: &Gains) -> Result<bool, BlackBoxError> {
        self.prober.set_gains(&gains.0, &gains.1)?;
        let step = LinearisedStep::of_states(self.prober, self.dt);
        self.prober.set_gains(&self.kp, &self.kv)?;
        Ok(!self.is_unstable(&step?.a))
    }

    fn linearised(&mut self, dt: f64) -> Result<LinearisedStep, BlackBoxError> {
        match self.is_quick {
            true => LinearisedStep::quick(self.prober, dt),
            false => LinearisedStep::of_states(self.prober, dt),
        }
    }

    pub(super) fn is_unstable(&self, step: &Matrix) -> bool {
        let Some(factors) = step.is_finite().then(|| eigenvalues(step)).flatten() else {
            return true;
        };
        let growth = |z: &Complex64| z.norm().ln();
        match self.is_at_rest {
            true => factors.iter().any(|z| growth(z) > self.outside),
            false => {
                factors.iter().any(|z| growth(z) > GROWTH_ON_A_MOTION && (z - 1.0).norm() > FAST)
            }
        }
    }

    /// The growth that errors of a step explain, and the number of modes that are neutral within them.
    pub(super) fn errors(&mut self, known: &Matrix) -> Result<(f64, usize), BlackBoxError> {
        let quick = LinearisedStep::quick(self.prober, self.dt)?;
        // Close contacts open within the steps of quick differences.
        self.is_quick = (0..known.rows()).all(|i| {
            let largest = |row: &[f64]| row.iter().map(|x| x.abs()).fold(0.0, f64::max);
            let apart = known.row(i).iter().zip(quick.a.row(i)).map(|(a, b)| (a - b).abs());
            apart.fold(0.0, f64::max) <= AGREES * largest(known.row(i))
        });
        let step = if self.is_quick { quick } else { self.linearised(self.dt)? };
        let factors = eigenvalues(&step.a).unwrap_or_default();
        let errors = eigenvalue_errors(&step.a, &step.a_errors, &factors);
        let near = |z: &Complex64, error: f64| z.norm().ln().abs() <= (ERRORS * error).max(OUTSIDE);
        let neutral: Vec<f64> = factors
            .iter()
            .zip(errors)
            .filter(|(z, error)| near(z, *error))
            .map(|(_, error)| ERRORS * error)
            .collect();
        let outside = neutral.iter().copied().fold(OUTSIDE, f64::max);
        Ok((outside.min(UNKNOWN), neutral.len()))
    }

    /// The limits of a gain. They are predicted by a step that is linear in it, and measured on both sides.
    pub(super) fn limits(
        &mut self,
        given: f64,
        unit: f64,
        change: &dyn Fn(f64) -> Gains,
    ) -> Result<GainLimits, BlackBoxError> {
        let apart = if given > 0.0 { given } else { unit };
        let base = self.step(&change(given), self.dt)?;
        let moved = self.step(&change(given + apart), self.dt)?;
        let slope = moved.plus(&base.scaled(-1.0)).scaled(apart.recip());
        let predicted = GainLimits::search(given, unit, RESOLUTION[0], &mut |gain| {
            let step = base.plus(&slope.scaled(gain - given));
            Ok::<_, BlackBoxError>(!self.is_unstable(&step))
        })?;
        if self.agrees(predicted, given, apart, change)? {
            return Ok(predicted);
        }
        GainLimits::search(given, unit, RESOLUTION[1], &mut |gain| self.holds(&change(gain)))
    }

    /// Whether measured steps are stable and unstable where the prediction says so.
    fn agrees(
        &mut self,
        limits: GainLimits,
        given: f64,
        apart: f64,
        change: &dyn Fn(f64) -> Gains,
    ) -> Result<bool, BlackBoxError> {
        let mut wanted = Vec::new();
        match limits.most {
            f64::INFINITY => wanted.push((given + FAR * apart, true)),
            0.0 => wanted.extend([(given / 2.0, false), (2.0 * given + apart, false)]),
            most => wanted.extend([(most * (1.0 - BESIDE), true), (most * (1.0 + BESIDE), false)]),
        }
        if limits.least > 0.0 {
            let least = limits.least;
            wanted.extend([(least * (1.0 - BESIDE), false), (least * (1.0 + BESIDE), true)]);
        }
        for (gain, is_stable) in wanted {
            if self.holds(&change(gain))? != is_stable {
                return Ok(false);
            }
        }
        Ok(true)
    }

    pub(super) fn fewest_substeps(&mut self, given: u32) -> Result<Option<u32>, BlackBoxError> {
        let (whole, gains) = (self.dt * f64::from(given), (self.kp.clone(), self.kv.clone()));
        let mut holds = |substeps: u32| {
            let step = self.step(&gains, whole / f64::from(substeps))?;
            Ok::<_, BlackBoxError>(!self.is_unstable(&step))
        };
        // Doubling finds a number that holds, bisection the fewest.
        let mut high = 1;
        while !holds(high)? {
            if high == MOST_SUBSTEPS {
                return Ok(None);
            }
            high = (2 * high).min(MOST_SUBSTEPS);
        }
        let mut low = high / 2;
        while high - low > 1 {
            let middle = u32::midpoint(low, high);
            if holds(middle)? {
                high = middle;
            } else {
                low = middle;
            }
        }
        Ok(Some(high))
    }
}
