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
use super::loops::PlantModel;
use super::request::Request;
use super::{AdviseError, advisor};

/// A function of a loop around any plant.
trait OfLoop {
    type Output;

    fn around<M: PlantModel>(
        &self,
        work: &Work<'_>,
        model: M,
        control: &Control,
        request: &Request,
    ) -> Result<Self::Output, AdviseError>;
}

/// Advice on a loop.
struct OfAdvice;

/// The budgets of a loop.
struct OfBudgets;

impl OfLoop for OfAdvice {
    type Output = Advice;

    fn around<M: PlantModel>(
        &self,
        work: &Work<'_>,
        model: M,
        control: &Control,
        request: &Request,
    ) -> Result<Advice, AdviseError> {
        advisor::advise_loop(work, model, control, request)
    }
}

impl OfLoop for OfBudgets {
    type Output = Vec<Budget>;

    fn around<M: PlantModel>(
        &self,
        work: &Work<'_>,
        model: M,
        control: &Control,
        request: &Request,
    ) -> Result<Vec<Budget>, AdviseError> {
        advisor::loop_budgets(work, model, control, request)
    }
}

/// The advice on a loop.
pub(super) fn advise(
    work: &Work<'_>,
    control: &Control,
    request: &Request,
) -> Result<Advice, AdviseError> {
    with_plant(work, control, request, &OfAdvice)
}

/// The budgets of a loop.
pub(super) fn budgets(
    work: &Work<'_>,
    control: &Control,
    request: &Request,
) -> Result<Vec<Budget>, AdviseError> {
    with_plant(work, control, request, &OfBudgets)
}

fn with_plant<F: OfLoop>(
    work: &Work<'_>,
    control: &Control,
    request: &Request,
    of: &F,
) -> Result<F::Output, AdviseError> {
    let twin = request.system.twin.map(|twin| twin.system);
    match (twin, request.system.q.len()) {
        (None, _) => Err(dimension_error(request, "a loop requires a system of the catalogue")),
        // Without damping it has the bits of the oscillator, up to the sign of a zero.
        (Some(AnySystem::Oscillator(Oscillator { omega2 })), 1) => {
            of.around(work, DampedOscillator { omega2, gamma: 0.0 }, control, request)
        }
        (Some(AnySystem::DampedOscillator(model)), 1) => of.around(work, model, control, request),
        (Some(AnySystem::Pendulum(model)), 1) => of.around(work, model, control, request),
        (Some(AnySystem::Duffing(model)), 1) => of.around(work, model, control, request),
        _ => Err(dimension_error(request, "a loop requires one")),
    }
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
