//! Requests of `advise` about a system, whatever describes it.

use libration::catalog;
use libration::control::{Feedback, Jitter};
use libration_advise::{Control, Law, Request};
use libration_settings::equations::EquationSystem;

use super::number::Coordinates;
use super::{AdviseArgs, SystemArgs};
use crate::error::Failure;

impl AdviseArgs {
    /// The options of the system, if any is given.
    pub(crate) fn system_options(&self) -> Option<&SystemArgs> {
        self.system.as_ref()
    }

    /// Returns the options of the system and its start; the operating point of a loop is the origin by default.
    ///
    /// # Errors
    /// If there are none, or if `--feedback` is given for a system with several degrees of freedom.
    pub(crate) fn system_and_start(&self) -> Result<SystemArgs, Failure> {
        let Some(mut options) = self.system.clone() else {
            return Err(Failure::usage(
                "no request is given; expected --config FILE, --system NAME or --plant FILE, and their options",
            ));
        };
        one_degree_of_freedom(options.system.as_deref().unwrap_or_default(), self.feedback)?;
        if self.feedback.is_some() && options.is_of_catalogue() {
            options.q.get_or_insert_with(Coordinates::origin);
            options.v.get_or_insert_with(Coordinates::origin);
        }
        Ok(options)
    }

    /// Returns the request about a system, which these options describe.
    pub(crate) fn request(
        &self,
        system: EquationSystem,
        options: &SystemArgs,
    ) -> Result<Request, Failure> {
        let is_of_catalogue = system.twin.is_some();
        if !is_of_catalogue && (self.feedback.is_some() || self.period().is_some()) {
            return Err(Failure::usage(
                "--feedback and --period are given without a loop; a loop around a file of equations takes --lqr or --gain",
            ));
        }
        let control = self.feedback.map(|gains| Control {
            law: Law::Pd(gains),
            period: self.period().unwrap_or(0.01),
            latency: 0.0,
            jitter: Jitter::Gaussian(0.0),
            skew: 0.0,
            loss: 0.0,
            record: None,
            weights: self.cost_weights,
            deviation: self.deviation,
        });
        self.with_timing(Request {
            control,
            options: (!is_of_catalogue).then(|| options.words()),
            ..Request::new(system, self.tolerance.0, self.horizon)
        })
    }

    /// Fails if an option requires a loop around a system of the catalogue.
    pub(super) fn ensure_no_catalogue_options(&self) -> Result<(), Failure> {
        let system = self.system.as_ref();
        let given = [
            ("--v", system.is_some_and(|system| system.v.is_some())),
            ("--feedback", self.feedback.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((flag, _)) => Err(Failure::usage(format!(
                "{flag} requires a system of the catalogue; a loop around equations takes --lqr or --gain at an equilibrium near their `start`"
            ))),
            None => Ok(()),
        }
    }
}

/// Fails if `feedback` is given for a system with several degrees of freedom.
fn one_degree_of_freedom(system: &str, feedback: Option<Feedback>) -> Result<(), Failure> {
    match catalog::find(system) {
        Ok(entry) if feedback.is_some() && !entry.dimensions.contains(&1) => {
            let fewest = entry.dimensions.start();
            Err(Failure::usage(format!(
                "--feedback closes a loop around one degree of freedom, but --system {system} has {fewest}"
            )))
        }
        _ => Ok(()),
    }
}
