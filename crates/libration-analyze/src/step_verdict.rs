//! Whether a step lets deviations grow more than exact steps do.

use libration::linear::Complex64;
use libration_report::verdict::{Outcome, Verdict, follows_growth};

use crate::digits::{beside_one, change_per_step, significant};
use crate::stable_steps::{is_at_limit, is_within};

/// Growth per step of a matrix of simple eigenvalues that is rounding.
const ROUNDING: f64 = 1e-11;

/// The same of a plant with eigenvalues at zero or multiple ones, which rounding parts by their root.
const ROUNDING_OF_ZEROS: f64 = 1e-7;

/// Growth per step that is visible in `f64` where exact windows say that there is some: a method of order 12 has less in short steps.
const VISIBLE: f64 = 1e-14;

/// Growth per step up to which exact windows are believed, not eigenvalues of matrices in `f64`: of eigenvalues that nearly coincide these
/// are known to the root of a rounding.
const DEFECTIVE: f64 = 1e-6;

/// A mode of the plant that grows may grow by this part faster in steps: they are inaccurate then, not unstable.
const FASTER: f64 = 1.5;

/// Distance of eigenvalues, relative to their size, up to which they may be one that rounding parted.
const PARTED: f64 = 1e-6;

/// Whether two of these eigenvalues, of each pair of complex ones the upper one or both, may be one that rounding parted.
pub(crate) fn has_multiple(values: impl Iterator<Item = Complex64>) -> bool {
    let upper: Vec<Complex64> = values.filter(|value| value.im >= 0.0).collect();
    let is_near = |a: &Complex64, b: &Complex64| (a - b).norm() <= PARTED * a.norm();
    upper.iter().enumerate().any(|(i, a)| upper[i + 1..].iter().any(|b| is_near(a, b)))
}

/// A mode of a plant in an exact step and in a step of an integrator.
pub(crate) struct ModeGrowth {
    /// The size of the multiplier of the step.
    pub(crate) growth: f64,
    /// The angle of the multiplier of the step in rad.
    pub(crate) angle: f64,
    /// The size of the multiplier of the exact step.
    pub(crate) exact_growth: f64,
    /// The angle of the multiplier of the exact step in rad.
    pub(crate) exact_angle: f64,
}

/// A multiplier in words: real ones with their sign.
fn multiplier(size: f64, angle: f64) -> String {
    match (angle.sin().abs() < 1e-9, angle.cos() < 0.0) {
        (true, true) => format!("−{}", significant(size, 4)),
        (true, false) => significant(size, 4),
        _ => format!("{} at {} rad", significant(size, 4), significant(angle, 4)),
    }
}

/// The growth of deviations in steps of an integrator on a linear system, or about an equilibrium.
pub(crate) struct StepGrowth<'a> {
    /// The time step in s.
    pub(crate) dt: f64,
    /// The largest size of a multiplier of a step; none if the step overflows.
    pub(crate) radius: Option<f64>,
    /// The largest growth rate of an exact mode in 1/s.
    pub(crate) exact_rate: f64,
    /// Whether the system has eigenvalues at zero, or multiple ones.
    pub(crate) has_parted: bool,
    /// The time steps at which no mode grows that does not grow in exact steps, if they are known.
    pub(crate) stable_dt: Option<&'a [[Option<f64>; 2]]>,
    /// Whether the integrator has a stability function: a step of it has the shapes of the modes of the plant.
    pub(crate) has_stability_function: bool,
    /// The modes, if it is known which multiplier belongs to which.
    pub(crate) modes: Vec<ModeGrowth>,
}

impl StepGrowth<'_> {
    /// The verdict on the step.
    pub(crate) fn verdict(&self) -> Verdict {
        let inside = self.stable_dt.map(|windows| is_within(windows, self.dt));
        let Some(radius) = self.radius else {
            return match inside {
                Some(false) => Verdict::new(Outcome::Unstable, "multipliers of the step overflow"),
                _ => Verdict::unknown("multipliers of the step overflow"),
            };
        };
        let rounding = if self.has_parted { ROUNDING_OF_ZEROS } else { ROUNDING };
        let exact = (self.exact_rate * self.dt).exp_m1();
        let is_growing = exact > rounding;
        let excess = radius - 1.0;
        let evidence =
            format!("spectral radius {}, {} of exact steps", beside_one(excess), beside_one(exact));
        let spurious = self.modes.iter().filter(|mode| mode.exact_growth <= 1.0 + rounding);
        let spurious = spurious.map(|mode| mode.growth - 1.0).fold(0.0, f64::max);
        let added = match is_growing {
            true if radius.ln() > FASTER * self.exact_rate * self.dt => excess - exact,
            true => spurious,
            false => excess.max(spurious),
        };
        let evidence = match is_growing && spurious > rounding {
            true => format!(
                "{evidence}; motions that do not grow in exact steps {}",
                change_per_step(spurious)
            ),
            false => evidence,
        };
        let decays = excess < -ROUNDING_OF_ZEROS && spurious <= 0.0;
        if added <= DEFECTIVE && self.stable_dt.is_some_and(|windows| is_at_limit(windows, self.dt))
        {
            return self.verdict_at_limit();
        }
        if inside == Some(false) && !decays && added <= VISIBLE {
            return Verdict::unknown(format!(
                "motions grow in such steps, but by less per step than the rounding of f64: {evidence}"
            ));
        }
        let outcome = match inside {
            _ if added <= ROUNDING
                && is_growing
                && let Some(lost) = self.lost_growth(rounding) =>
            {
                return Verdict::new(Outcome::NotResolved, format!("{lost}; {evidence}"));
            }
            Some(true) if added <= DEFECTIVE => Outcome::Stable,
            Some(false) if !decays => Outcome::Unstable,
            _ if added <= ROUNDING => Outcome::Stable,
            _ if added <= rounding => Outcome::Unknown,
            _ => Outcome::Unstable,
        };
        Verdict::new(outcome, evidence)
    }

    /// A mode that grows in exact steps and that these steps do not follow, in words: they damp it, turn it round, or let it grow at
    /// another rate. None if they follow all of them.
    fn lost_growth(&self, rounding: f64) -> Option<String> {
        let lost = self.modes.iter().find(|mode| {
            let own = [mode.growth.ln(), mode.angle];
            let exact = [mode.exact_growth.ln(), mode.exact_angle];
            mode.exact_growth > 1.0 + rounding && !follows_growth(own, exact)
        });
        if let Some(mode) = lost {
            let own = multiplier(mode.growth, mode.angle);
            let exact = multiplier(mode.exact_growth, mode.exact_angle);
            return Some(format!(
                "the steps do not follow a growing motion: a step multiplies it by {own}, an exact one by {exact}"
            ));
        }
        let exact = [self.exact_rate * self.dt, 0.0];
        let is_lost = |radius: &f64| !follows_growth([radius.ln(), 0.0], exact);
        let radius = self.radius.filter(|radius| self.modes.is_empty() && is_lost(radius));
        radius.map(|_| "the steps do not follow a growing motion".to_owned())
    }

    /// Without damping, the two multipliers of a mode leave the unit circle where they meet, at ±1. If steps have other shapes than the plant,
    /// both have one shape there, and deviations grow with the number of steps. Steps by a stability function keep the shapes of the plant.
    fn verdict_at_limit(&self) -> Verdict {
        let is_double = |mode: &ModeGrowth| {
            (mode.growth - 1.0).abs() <= DEFECTIVE
                && (mode.exact_growth - 1.0).abs() <= ROUNDING
                && mode.exact_angle.abs() > ROUNDING
                && mode.angle.sin().abs() <= DEFECTIVE
        };
        match !self.has_stability_function && self.modes.iter().any(is_double) {
            true => Verdict::new(
                Outcome::Unstable,
                "at the limit of stability, motions grow without bound, but not exponentially",
            ),
            false => Verdict::unknown(
                "at the limit of stability, a motion neither grows nor decays beyond rounding",
            ),
        }
    }
}
