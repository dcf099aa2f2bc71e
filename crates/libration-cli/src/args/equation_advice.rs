//! Requests of `advise` about systems by equations.

use super::{AdviseArgs, SystemArgs};
use crate::error::Failure;

impl AdviseArgs {
    /// The options of the system, if any is given.
    pub(crate) fn system_options(&self) -> Option<&SystemArgs> {
        self.system.as_ref()
    }

    /// Fails if an option requires a loop around a system of the catalogue.
    pub(super) fn ensure_no_catalogue_options(&self) -> Result<(), Failure> {
        let system = self.system.as_ref();
        let given = [
            ("--q", system.is_some_and(|system| system.q.is_some())),
            ("--v", system.is_some_and(|system| system.v.is_some())),
            ("--start", system.is_some_and(|system| !system.start.is_empty())),
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
