//! Rows of loops around a linear plant.

use libration::ensemble::Execution;

use super::LinearRequest;
use crate::export::Rows;
use crate::trajectory::{Divergence, Monitor, Outcome, TrajectoryError};

/// Periods of a loop between two checks of the monitor: a tenth of a second.
const CHUNK: u64 = 1 << 16;

/// Simulates the loops of a checked request.
pub(super) fn run(
    request: &LinearRequest,
    rows: &mut dyn Rows<f64>,
    monitor: &dyn Monitor,
) -> Result<Outcome, TrajectoryError> {
    let LinearRequest { steps, every, ensemble, .. } = *request;
    let execution = match &ensemble {
        Some(ensemble) => ensemble.execution()?,
        None => Execution::serial(),
    };
    let count = ensemble.map_or(1, |ensemble| ensemble.count);
    let mut all = request.loops(execution)?;
    let [states_at, outputs_at, inputs_at] = request.operating_point();
    let mut values = Vec::with_capacity(request.columns().len());
    let at_once = (CHUNK / count as u64).max(1);
    loop {
        let step = all.step();
        let is_finite = |n| all.is_finite(n);
        if ensemble.is_none() && !is_finite(0) {
            let reason = "the state stopped being finite: the loop is unstable".to_owned();
            return Ok(Outcome::Diverged(Divergence {
                step,
                t: all.time(0),
                reason,
                newton_residual: None,
            }));
        }
        if step.is_multiple_of(every) || step == steps {
            for n in 0..count {
                if monitor.should_stop() {
                    return Err(TrajectoryError::Interrupted);
                }
                values.clear();
                values.extend(states_at.iter().enumerate().map(|(i, at)| at + all.state(n, i)));
                let outputs = outputs_at.iter().enumerate();
                values.extend(outputs.map(|(j, at)| at + all.measurement(n, j)));
                values.extend(inputs_at.iter().enumerate().map(|(i, at)| at + all.input(n, i)));
                values.push(all.cost(n));
                let index = [n as u64, step];
                let index = if ensemble.is_some() { &index[..] } else { &index[1..] };
                rows.row(index, all.time(n), &values)?;
            }
        }
        if step == steps {
            let lost: Vec<usize> = (0..count).filter(|&n| !is_finite(n)).collect();
            return Ok(match lost.len() {
                0 => Outcome::Complete,
                count => Outcome::NotFinite {
                    count,
                    first: lost.into_iter().take(10).collect(),
                    reason: Some("the loop is unstable".to_owned()),
                    newton_residual: None,
                },
            });
        }
        if monitor.should_stop() {
            return Err(TrajectoryError::Interrupted);
        }
        let to_next_row = (every - step % every).min(steps - step);
        // A single loop is checked in each period.
        let most = if ensemble.is_none() { 1 } else { at_once };
        all.advance(to_next_row.min(most));
        monitor.on_step(all.step());
    }
}
