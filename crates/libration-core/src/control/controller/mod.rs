//! Controllers.

mod force;
mod luenberger;
mod open_loop;
mod pid;
mod saturation;
mod state_feedback;

pub use force::Force;
pub use luenberger::Luenberger;
pub use open_loop::OpenLoop;
pub use pid::{Pid, PidGains};
pub use saturation::Saturated;
pub use state_feedback::StateFeedback;

use super::{ControlError, Memory};
use crate::{Float, State};

/// Computes commands: an acceleration in each degree of freedom.
pub trait Controller<T: Float, const D: usize>: Copy + Send + Sync {
    /// Whether it computes commands.
    #[doc(hidden)]
    const ACTS: bool = true;

    /// The memory per trajectory from sample to sample.
    type Memory: Memory<T>;

    /// Checks the parameters for samples every `period` seconds; `Loops` call it before they
    /// begin.
    ///
    /// # Errors
    /// The first invalid parameter.
    fn check(&self, period: f64) -> Result<(), ControlError> {
        let _ = period;
        Ok(())
    }

    /// The memory before the first sample of a trajectory that begins at `state`.
    fn start(&self, state: &State<T, D>) -> Self::Memory;

    /// The command for an observation `period` seconds after the last sample. An implementation branches on values
    /// of `self` only and is `#[inline(always)]`; otherwise its loops are not vectorised.
    fn command(&self, memory: &mut Self::Memory, observed: &State<T, D>, period: T) -> [T; D];
}

/// `x`, but not beyond `±most`.
#[inline(always)]
fn within<T: Float>(x: T, most: T) -> T {
    let low = if x < -most { -most } else { x };
    if low > most { most } else { low }
}
