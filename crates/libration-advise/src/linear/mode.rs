//! Modes of the plant, and of lags and filters.

use libration::analysis::without_rounding;
use libration::linear::{Complex64, LinearPlant, ModeDetails, PlantMode};
use libration_report::notation::number;
use serde::Serialize;

use super::LinearRequest;

/// A mode of the plant, or of lags and filters.
#[derive(Clone, Debug, Serialize)]
pub struct Mode {
    /// The growth rate in 1/s; below zero the mode decays.
    pub growth_rate: f64,
    /// The frequency in Hz; 0 without oscillation.
    pub frequency: f64,
    /// The states that move most, with their sizes relative to the largest.
    pub states: Vec<(String, f64)>,
    /// Growth rate and frequency for readers: 0 within rounding.
    #[serde(skip)]
    pub shown: [f64; 2],
}

impl LinearRequest {
    /// Names the modes of the plant that the controller does not move, as a zero cancels their pole, or that it does not see.
    pub(super) fn hidden_modes_warning(&self) -> Option<String> {
        let is_single = self.plant.inputs.len() == 1 && self.plant.outputs.len() == 1;
        let hidden = |mode: &ModeDetails| {
            let [reached, shown] = [mode.controllability, mode.observability];
            let is_reached = mode.is_controllable() && !mode.is_weakly_controllable();
            let is_shown = mode.is_observable() && !mode.is_weakly_observable();
            let why = match (is_single, is_reached, is_shown) {
                (_, true, true) => return None,
                (true, ..) => "a zero cancels its pole",
                (false, false, _) => "no input reaches it",
                (false, true, false) => "no output shows it",
            };
            let part = reached.min(shown);
            let nearly = match mode.is_controllable() && mode.is_observable() {
                true => format!(", to a relative {}", number(part, 2)),
                false => String::new(),
            };
            let rate = number(mode.value.re, 4);
            let turn = match mode.value.im {
                0.0 => String::new(),
                turn => format!(" ± {}i", number(turn, 4)),
            };
            Some(format!("{rate}{turn} 1/s ({why}{nearly})"))
        };
        let named: Vec<String> = self.plant.mode_details().iter().filter_map(hidden).collect();
        (!named.is_empty()).then(|| {
            format!("the controller does not move the modes of the plant at {}", named.join(", "))
        })
    }

    /// The modes of the plant, and those of its lags and filters in continuous time, whose states come last.
    ///
    /// In the order of signals (lags of inputs, plant, filters of outputs) the state matrix is block triangular: so both together
    /// are the modes of the whole.
    pub(super) fn modes(&self) -> (Vec<Mode>, Vec<Mode>) {
        let whole = self.timed.linear.plant();
        let parts = whole.modes_of(self.plant.states.len()..whole.states.len());
        (shown(self.plant.modes(), &self.plant), shown(parts, whole))
    }
}

/// The modes as results; `plant` has the matrix whose rounding they have.
fn shown(modes: Vec<PlantMode>, plant: &LinearPlant) -> Vec<Mode> {
    let rounding = plant.mode_rounding();
    let rates: Vec<Complex64> = modes
        .iter()
        .map(|mode| Complex64::new(mode.growth_rate, core::f64::consts::TAU * mode.frequency))
        .collect();
    // A double zero that rounding parts is off by the root of a rounding.
    let rates = without_rounding(&rates);
    let known = |x: f64| if x.abs() <= rounding { 0.0 } else { x };
    let mode =
        |(PlantMode { growth_rate, frequency, states }, rate): (PlantMode, Complex64)| Mode {
            growth_rate,
            frequency,
            states,
            shown: [known(rate.re), known(rate.im) / core::f64::consts::TAU],
        };
    modes.into_iter().zip(rates).map(mode).collect()
}
