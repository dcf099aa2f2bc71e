//! Motions of bodies as files.

use std::cell::RefCell;
use std::io::Write;

use libration::bodies::PairPotential;
use serde_json::{Value, json};

use super::{BodiesAudit, BodiesRequest, COLUMNS, SCHEMA, simulate};
use crate::export::Rows;
use crate::recording::{self, Recording};
use crate::trajectory::{Divergence, Format, Monitor, Outcome, TrajectoryError};

/// Simulates bodies and writes their rows into `out`.
///
/// # Errors
/// [`TrajectoryError`], before any work if the request is invalid.
pub fn write(
    request: &BodiesRequest,
    format: Format,
    out: &mut (dyn Write + Send),
    monitor: &dyn Monitor,
) -> Result<BodiesAudit, TrajectoryError> {
    let recording = BodiesRecording { request, audit: RefCell::new(None) };
    recording::write::<f64>(&recording, format, out, monitor)?;
    // A recording that ended without error has run.
    recording.audit.into_inner().ok_or(TrajectoryError::Interrupted)
}

struct BodiesRecording<'a> {
    request: &'a BodiesRequest,
    /// What the run left.
    audit: RefCell<Option<BodiesAudit>>,
}

impl Recording<f64> for BodiesRecording<'_> {
    fn columns(&self) -> Vec<(String, String)> {
        COLUMNS.iter().map(|&name| (name.to_owned(), String::new())).collect()
    }

    fn is_ensemble(&self) -> bool {
        false
    }

    fn index_columns(&self) -> usize {
        2
    }

    fn rows(&self) -> u64 {
        self.request.rows()
    }

    fn head(&self) -> Vec<(&'static str, Value)> {
        let BodiesRequest { system, integrator, dt, steps, .. } = self.request;
        vec![
            ("schema", SCHEMA.into()),
            ("system", system.name.clone().into()),
            ("names", json!(system.names)),
            ("masses", json!(system.bodies.masses())),
            ("gravitational_constant", system.bodies.constant().into()),
            ("softening", system.bodies.softening_length().into()),
            ("charges", json!(system.bodies.charges())),
            ("pair_potential", json!(system.bodies.pairs().map(PairPotential::text))),
            ("parameters", json!(system.bodies.pairs().map(PairPotential::parameters))),
            ("integrator", integrator.name().into()),
            ("dt", (*dt).into()),
            ("steps", (*steps).into()),
            ("columns", json!(COLUMNS)),
        ]
    }

    fn run(
        &self,
        rows: &mut dyn Rows<f64>,
        monitor: &dyn Monitor,
    ) -> Result<Outcome, TrajectoryError> {
        let audit = simulate(self.request, rows, monitor)?;
        let outcome = audit.stopped.as_ref().map_or(Outcome::Complete, |reason| {
            let (step, t) = (audit.steps + 1, (audit.steps + 1) as f64 * audit.dt);
            Outcome::Diverged(Divergence { step, t, reason: reason.clone(), newton_residual: None })
        });
        self.audit.replace(Some(audit));
        Ok(outcome)
    }
}
