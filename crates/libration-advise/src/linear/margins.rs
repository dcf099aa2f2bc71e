//! Gain and phase margins at each input.

use libration::linear::{LinearLoop, LoopTiming, Signal, StabilityMargins};
use serde::Serialize;

use crate::AdviseError;
use crate::loops::LoopError;

/// The margins of the loop that is opened at one input, with all others closed.
#[derive(Clone, Debug, Serialize)]
pub struct InputMargins {
    /// The input.
    pub input: String,
    /// The smallest factor above 1 of its commands at which the loop loses stability; none if there is none.
    pub gain_up: Option<f64>,
    /// The largest factor below 1; none if there is none.
    pub gain_down: Option<f64>,
    /// The phase margin in degrees; none if the gain never passes 1.
    pub phase: Option<f64>,
    /// The frequency of the phase margin in Hz.
    pub crossover: Option<f64>,
}

impl InputMargins {
    /// The margins of the input with the least phase margin; none without inputs.
    pub fn tightest<'a>(all: impl IntoIterator<Item = &'a Self>) -> Option<&'a Self> {
        let phase = |own: &InputMargins| own.phase.unwrap_or(f64::INFINITY);
        all.into_iter().min_by(|a, b| phase(a).total_cmp(&phase(b)))
    }
}

/// The gain and phase margins at each input, without jitter and losses; none of an unstable loop, and of a cascade.
pub(super) fn margins(
    linear: &LinearLoop,
    stated: &LoopTiming,
) -> Result<Vec<InputMargins>, AdviseError> {
    let even = LoopTiming { loss: 0.0, jitter: stated.jitter.with_rms(0.0), ..stated.clone() };
    // A cascade has no frequency response.
    let periodic = linear.controllers().periods() > 1;
    if periodic || !linear.is_stable(&even).map_err(LoopError::from)? {
        return Ok(Vec::new());
    }
    let of = |(i, input): (usize, &Signal)| {
        let found = linear.stability_margins(&even, i).map_err(LoopError::from)?;
        let StabilityMargins { gain_up, gain_down, phase, crossover } = found;
        let (input, phase) = (input.name.clone(), phase.map(f64::to_degrees));
        Ok(InputMargins { input, gain_up, gain_down, phase, crossover })
    };
    linear.plant().inputs.iter().enumerate().map(of).collect()
}
