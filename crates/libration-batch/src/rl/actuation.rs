//! Commands of actions: saturation, and accelerations of a mass.

use libration_core::Float;

use super::block_size::LANES;
use super::stepper::Stepper;
use super::{Policy, World};

impl<T, E, P, const O: usize, const D: usize> Stepper<'_, T, E, P, O, D>
where
    T: Float,
    E: World<T, O, D>,
    P: Policy<T, O, D>,
{
    /// Whether commands are accelerations without a limit.
    #[inline(always)]
    pub(super) fn is_unlimited_acceleration(&self) -> bool {
        self.saturation.to_f64() == f64::INFINITY && self.is_per_mass()
    }

    /// Whether commands are accelerations as they are.
    #[inline(always)]
    fn is_per_mass(&self) -> bool {
        self.mobility == T::one()
    }

    /// The accelerations of these commands.
    #[inline(always)]
    pub(super) fn accelerations(&self, commands: &[[T; LANES]; D]) -> [[T; LANES]; D] {
        let mut accelerations = *commands;
        if self.is_per_mass() {
            return accelerations;
        }
        for row in &mut accelerations {
            for x in row {
                *x = *x * self.mobility;
            }
        }
        accelerations
    }

    /// The commands of these actions after saturation. NaN stays NaN.
    #[inline(always)]
    pub(super) fn commands(&self, actions: &[[T; LANES]; D]) -> [[T; LANES]; D] {
        let mut commands = *actions;
        if self.is_unlimited_acceleration() {
            return commands;
        }
        let most = self.saturation;
        for row in &mut commands {
            for x in row {
                let low = if *x < -most { -most } else { *x };
                *x = if low > most { most } else { low };
            }
        }
        commands
    }
}
