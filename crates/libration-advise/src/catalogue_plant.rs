//! The compiled plants of loops around systems of the catalogue.
//!
//! The kernels of these loops are compiled for the type of the plant. Everything else of a request takes its system by programs.

use libration::AnySystem;
use libration::catalog::Actuation;
use libration::system::{DampedOscillator, Oscillator};
use libration_settings::equations::Twin;
use libration_settings::units::{self, Units};
use libration_work::Work;

use super::advice::Advice;
use super::budget::Budget;
use super::control::Control;
use super::request::Request;
use super::{AdviseError, advisor};

/// Evaluates an expression with the compiled plant of a loop.
macro_rules! with_plant {
    ($request:expr, |$plant:ident| $use:expr) => {{
        let twin = $request.system.twin.map(|twin| twin.system);
        match (twin, $request.system.q.len()) {
            // Without damping it has the bits of the oscillator, up to the sign of a zero.
            (Some(AnySystem::Oscillator(Oscillator { omega2 })), 1) => {
                let $plant = DampedOscillator { omega2, gamma: 0.0 };
                $use
            }
            (Some(AnySystem::DampedOscillator($plant)), 1) => $use,
            (Some(AnySystem::Pendulum($plant)), 1) => $use,
            (Some(AnySystem::Duffing($plant)), 1) => $use,
            (None, _) => {
                Err(dimension_error($request, "a loop requires a system of the catalogue"))
            }
            _ => Err(dimension_error($request, "a loop requires one")),
        }
    }};
}

/// The advice on a loop.
pub(super) fn advise(
    work: &Work<'_>,
    control: &Control,
    request: &Request,
) -> Result<Advice, AdviseError> {
    with_plant!(request, |plant| advisor::advise_loop(work, plant, control, request))
}

/// The budgets of a loop.
pub(super) fn budgets(
    work: &Work<'_>,
    control: &Control,
    request: &Request,
) -> Result<Vec<Budget>, AdviseError> {
    with_plant!(request, |plant| advisor::loop_budgets(work, plant, control, request))
}

fn dimension_error(request: &Request, allowed: &'static str) -> AdviseError {
    let (system, dimension) = (request.system.name.clone(), request.system.q.len());
    AdviseError::Dimension { system, dimension, allowed }
}

impl Request {
    /// The quantity of the commands of a loop.
    pub(super) fn actuation(&self) -> Actuation {
        self.system.twin.map_or(Actuation::Acceleration, |twin| twin.actuation)
    }

    /// The units of states, commands and gains of a loop.
    pub(super) fn units(&self) -> Units {
        let of = |Twin { system, actuation }| units::of(system, actuation);
        self.system.twin.map_or_else(Units::default, of)
    }
}
