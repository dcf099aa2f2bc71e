//! Whether a loop is stable, where rounding allows an answer.

use crate::{LinearLoop, LinearLoopError, LinearPlant, LoopTiming, Matrix, eigenvalues};

/// Growth of second moments per period, up or down, that may be rounding.
pub const GROWTH_ROUNDING: f64 = 1e-11;

/// Whether a loop is stable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopStability {
    /// The answer.
    pub outcome: StabilityOutcome,
    /// The logarithm of the growth factor of second moments per period.
    pub growth: f64,
    /// The factor by which the plant alone grows in a period, where its rounding hides whether the loop is stable; none elsewhere.
    pub hidden_by: Option<f64>,
}

/// The answer to the question whether a loop is stable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StabilityOutcome {
    /// Second moments decay.
    Stable,
    /// Second moments grow.
    Unstable,
    /// They change by less than rounding, and the equations of rest do not decide either.
    Undecided,
}

impl LoopStability {
    /// The stability of a loop with this growth, without more evidence.
    pub fn of_growth(growth: f64) -> Self {
        let outcome = match growth {
            growth if growth < -GROWTH_ROUNDING => StabilityOutcome::Stable,
            growth if growth > GROWTH_ROUNDING => StabilityOutcome::Unstable,
            _ => StabilityOutcome::Undecided,
        };
        LoopStability { outcome, growth, hidden_by: None }
    }

    /// Whether the loop is certainly stable.
    pub fn is_stable(&self) -> bool {
        self.outcome == StabilityOutcome::Stable
    }

    /// Whether growth alone does not decide.
    pub fn is_near_neutral(&self) -> bool {
        self.growth.abs() <= GROWTH_ROUNDING
    }
}

/// Roundings of the factor by which the plant grows in a period, up to which a multiplier of the loop may be off.
const DOUBT: f64 = 16.0 * f64::EPSILON;

/// Distance from 1 in which a multiplier of a period may be one of a slow motion.
const NEAR: f64 = 1e-9;

/// Roundings of scaled equations, for each of them, below which a pivot counts as zero.
const ROUNDINGS: f64 = 1e3;

impl LinearLoop {
    /// Whether second moments decay, in one place for all commands.
    ///
    /// A slow motion in short periods changes less per period than rounding. If it is the only one, and does not oscillate, its multiplier `μ`
    /// is below 1 where `det(1 − M)` of the matrix `M` of a period is above zero, and that has the sign of the determinant of the
    /// equations of rest, without a period in them: `1 − e^{AT} = −A ∫ e^{At} dt`, and the determinant of the integral is above zero.
    ///
    /// # Errors
    /// As for [`LinearLoop::growth`].
    pub fn stability(&self, timing: &LoopTiming) -> Result<LoopStability, LinearLoopError> {
        let found = LoopStability::of_growth(self.growth(timing)?);
        self.decided(found, timing)
    }

    /// The stability of the loop with this growth under `timing` or a record, decided by the equations of rest where growth does not.
    ///
    /// # Errors
    /// As for [`LinearLoop::growth`].
    pub fn decided(
        &self,
        found: LoopStability,
        timing: &LoopTiming,
    ) -> Result<LoopStability, LinearLoopError> {
        // The commands take away what the plant adds in a period, with its rounding. A loop that decays does so by the digits that are left.
        let plant = self.plant_growth(timing);
        let off = ((0.5 * found.growth).exp() - 1.0).abs();
        if DOUBT * plant > 1e-3 && (off.is_nan() || off <= DOUBT * plant) {
            let outcome = StabilityOutcome::Undecided;
            return Ok(LoopStability { outcome, hidden_by: Some(plant), ..found });
        }
        if found.outcome != StabilityOutcome::Undecided || self.controllers().periods() > 1 {
            return Ok(found);
        }
        let modes = self.modes(timing, usize::MAX)?;
        let mut near = modes.iter().filter(|mode| mode.radius >= 1.0 - NEAR);
        let is_lone = match (near.next(), near.next()) {
            (Some(mode), None) => mode.angle == 0.0 && mode.radius <= 1.0 + NEAR,
            _ => false,
        };
        let sign = if is_lone { self.sign_at_rest() } else { None };
        let outcome = match sign {
            Some(1.0) => StabilityOutcome::Stable,
            Some(_) => StabilityOutcome::Unstable,
            None => StabilityOutcome::Undecided,
        };
        Ok(LoopStability { outcome, ..found })
    }

    /// The factor by which the fastest growth of the plant alone multiplies deviations in a period.
    fn plant_growth(&self, timing: &LoopTiming) -> f64 {
        let seconds = self.period() * (1.0 + timing.skew);
        match self.plant().sampling_period {
            None => self.motions().iter().map(|rate| (rate.re * seconds).exp()).fold(0.0, f64::max),
            Some(_) => {
                let factors = eigenvalues(&self.plant().a).unwrap_or_default();
                factors.iter().map(|factor| factor.norm()).fold(0.0, f64::max)
            }
        }
    }

    /// The sign of the determinant of the equations of rest; none within rounding.
    fn sign_at_rest(&self) -> Option<f64> {
        let LinearPlant { a, b, c, d, sampling_period, .. } = self.plant();
        let own = self.controller();
        let (n, k, m) = (a.rows(), own.memory(), b.columns());
        let mut rest = Matrix::identity(n + k + m);
        // −Ax − Bu = 0, of a sampled plant (1 − A)x − Bu = 0.
        let mut still =
            if sampling_period.is_some() { Matrix::identity(n) } else { Matrix::zeros(n, n) };
        still.add_scaled(-1.0, a);
        rest.set_block((0, 0), &still);
        rest.set_block((0, n + k), &b.scaled(-1.0));
        // The memory and the commands, with y = Cx + Du.
        for (first, of_memory, of_output) in [(n, &own.a, &own.b), (n + k, &own.c, &own.d)] {
            let mut kept = rest.block((first, n), (of_memory.rows(), k));
            kept.add_scaled(-1.0, of_memory);
            rest.set_block((first, n), &kept);
            rest.set_block((first, 0), &(of_output * c).scaled(-1.0));
            let mut direct = rest.block((first, n + k), (of_output.rows(), m));
            direct.add_scaled(-1.0, &(of_output * d));
            rest.set_block((first, n + k), &direct);
        }
        sign_of_determinant(rest)
    }
}

/// The sign of the determinant; none where a pivot of the scaled matrix is within rounding.
fn sign_of_determinant(mut matrix: Matrix) -> Option<f64> {
    let n = matrix.rows();
    // Powers of two scale rows and columns without rounding, and keep the sign.
    for _ in 0..4 {
        for i in 0..n {
            let most = matrix.row(i).iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let factor = most.log2().round().exp2().recip();
            if !(factor.is_finite() && factor > 0.0) {
                return None;
            }
            matrix.row_mut(i).iter_mut().for_each(|x| *x *= factor);
        }
        for j in 0..n {
            let most = (0..n).fold(0.0, |most: f64, i| most.max(matrix[(i, j)].abs()));
            let factor = most.log2().round().exp2().recip();
            if !(factor.is_finite() && factor > 0.0) {
                return None;
            }
            (0..n).for_each(|i| matrix[(i, j)] *= factor);
        }
    }
    let mut sign = 1.0;
    for k in 0..n {
        let largest =
            (k..n).max_by(|&i, &j| matrix[(i, k)].abs().total_cmp(&matrix[(j, k)].abs()))?;
        if largest != k {
            matrix.swap_rows(k, largest);
            sign = -sign;
        }
        let pivot = matrix[(k, k)];
        if pivot.is_nan() || pivot.abs() <= ROUNDINGS * n as f64 * f64::EPSILON {
            return None;
        }
        sign *= pivot.signum();
        for i in k + 1..n {
            let factor = matrix[(i, k)] / pivot;
            (k..n).for_each(|j| matrix[(i, j)] -= factor * matrix[(k, j)]);
        }
    }
    Some(sign)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DiscreteController;

    /// The loop `u = −K y` around a transfer function.
    fn looped(numerator: &[f64], denominator: &[f64], gain: f64, period: f64) -> LoopStability {
        let plant = LinearPlant::from_transfer_functions(
            &[vec![numerator.to_vec()]],
            &[vec![denominator.to_vec()]],
        )
        .unwrap();
        let n = plant.states.len();
        let controller = DiscreteController::gain(Matrix::from_rows(&[[-gain]]).unwrap());
        let cost = Matrix::identity(n + 1);
        let linear = LinearLoop::new(plant, controller, period, cost, vec![0.0]).unwrap();
        linear.stability(&linear.ideal()).unwrap()
    }

    /// `s + a + K b = 0` of the loop around `b/(s + a)`: in periods so short that it changes by 10⁻¹⁵ the sign of `a + K b` decides.
    #[test]
    fn slow_motions_in_short_periods_are_judged_by_their_rate() {
        for (a, b, gain) in
            [(1e-6, 1.0, 0.0), (-1e-6, 3e-6, 1.0), (1e-6, 3e-6, -1.0), (-1e-6, 1.0, 0.0)]
        {
            let found = looped(&[b], &[1.0, a], gain, 1e-9);
            assert!(found.is_near_neutral(), "{found:?}");
            assert_eq!(found.is_stable(), a + gain * b > 0.0, "{a} {b} {gain}: {found:?}");
            assert_ne!(found.outcome, StabilityOutcome::Undecided);
        }
        // With fast poles beside it, and a zero that nearly cancels the slow one.
        let cancelled = [3.4e-14, 3.7e-7, 1.4, 2.5e6, 1.9];
        assert!(looped(&[0.4, 2.5e6, 1.9], &cancelled, 1.0, 25e-9).is_stable());
        let growing = [3.4e-14, 3.7e-7, 1.4, 2.5e6, -1.9];
        let found = looped(&[0.4, 2.5e6, -1.9], &growing, 1.0, 25e-9);
        assert_eq!(found.outcome, StabilityOutcome::Unstable);
    }

    /// The plant `s − 1` whose commands place the multiplier at zero: in a period of `h` seconds its digits end at `e^h = 2⁵³`, at 36.7 s.
    #[test]
    fn a_loop_is_unknown_where_the_plant_outgrows_the_digits_of_a_float() {
        for (period, is_known) in [(1.0_f64, true), (20.0, true), (36.0, false), (50.0, false)] {
            let gain = period.exp() / period.exp_m1();
            let found = looped(&[1.0], &[1.0, -1.0], gain, period);
            assert_eq!(found.is_stable(), is_known, "{period} s: {found:?}");
            let factor = found.hidden_by.unwrap_or(f64::NAN);
            assert_eq!((factor / period.exp() - 1.0).abs() < 1e-12, !is_known, "{found:?}");
        }
        // Without commands the growth is known, however large it is.
        let found = looped(&[1.0], &[1.0, -1.0], 0.0, 50.0);
        assert_eq!((found.outcome, found.hidden_by), (StabilityOutcome::Unstable, None));
    }

    #[test]
    fn a_motion_that_neither_grows_nor_decays_is_undecided() {
        // An integrator that no command moves, and a pair without damping.
        for denominator in [vec![1.0, 0.0], vec![1.0, 0.0, 4.0], vec![1.0, 3.0, 0.0]] {
            let found = looped(&[1.0], &denominator, 0.0, 0.01);
            assert_eq!(found.outcome, StabilityOutcome::Undecided, "{denominator:?}: {found:?}");
        }
    }
}
