//! Stability windows beyond the first limit.

use libration::analysis::{CostError, Imperfections, Plant};
use serde::Serialize;

use super::control::Law;
use super::limits::Imperfection;
use super::loops::{Loop, LoopError, PlantModel};
use super::request::{Measure, Tolerance};

/// A stability window beyond the first limit that contains the stated size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StabilityWindow {
    /// The smallest size in the window, in the unit of the budget.
    pub from: f64,
    /// The largest size in the window; none if no end was found.
    pub to: Option<f64>,
}

/// Relative accuracy of the ends of a window, which are printed to six digits.
const SHARP: f64 = 1e-7;

impl<M: PlantModel> Loop<M> {
    /// The window around the size `stated` of `kind`, if the loop is stable there but not at smaller sizes above its
    /// first limit `first`. A tolerance of the cost must be met as well.
    pub(super) fn stability_window(
        &self,
        plant: &Plant<'_>,
        kind: Imperfection,
        [first, stated]: [f64; 2],
        tolerance: Tolerance,
    ) -> Result<Option<StabilityWindow>, LoopError> {
        if stated <= first {
            return Ok(None);
        }
        let cost_limit = match tolerance {
            Tolerance { of: Measure::Cost, most } => {
                Some((1.0 + most) * self.cost(plant, &Imperfections::NONE, self.weights)?)
            }
            _ => None,
        };
        let holds = |size: f64| -> Result<bool, LoopError> {
            let with = self.single(kind, size)?;
            let held: Result<bool, CostError> = match cost_limit {
                Some(most) => self.cost(plant, &with, self.weights).map(|cost| cost <= most),
                None => self.decays(plant, &with),
            };
            Ok(held?)
        };
        if !holds(stated)? {
            return Ok(None);
        }
        let end = |mut inside: f64, mut outside: f64| -> Result<f64, LoopError> {
            while (inside - outside).abs() > SHARP * inside.abs() {
                let middle = 0.5 * (inside + outside);
                if holds(middle)? { inside = middle } else { outside = middle }
            }
            Ok(inside)
        };
        let sizes = match (kind, self.control.law) {
            // The textbook's windows are those of simulations at whole periods.
            (Imperfection::Latency, Law::Pd(_) | Law::Lqr(_)) => {
                let windows = plant.latency_windows(self.gains()).stable.into_iter();
                let ends = windows.flat_map(|(from, to)| [Some(from), to]).flatten();
                ends.flat_map(|end| [end.floor(), end.ceil()]).collect()
            }
            _ => self.tried_sizes(kind, self.largest(kind))?,
        };
        // Where no smaller size on the grid fails, the gap is narrow and lies at the first limit.
        let (mut inside, mut below) = (stated, first * (1.0 + 1e-9));
        for &size in sizes.iter().rev().filter(|&&size| first < size && size < stated) {
            if !holds(size)? {
                below = size;
                break;
            }
            inside = size;
        }
        let from = end(inside, below)?;
        let mut inside = stated;
        for &size in sizes.iter().filter(|&&size| size > stated) {
            if !holds(size)? {
                return Ok(Some(StabilityWindow { from, to: Some(end(inside, size)?) }));
            }
            inside = size;
        }
        Ok(Some(StabilityWindow { from, to: None }))
    }
}
