//! Windows of stability that are lost and regained.

use libration::Model;
use libration::analysis::{CostError, Imperfections, Plant};
use serde::Serialize;

use super::control::Law;
use super::limits::Kind;
use super::loops::{Loop, LoopError};
use super::request::{Measure, Tolerance};

/// A window of stability beyond the first limit, around the size that is stated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Regained {
    /// The smallest size in the window, in the unit of the budget.
    pub from: f64,
    /// The largest; none where the window has no end that was found.
    pub to: Option<f64>,
}

/// To such a part the ends of a window are found: they are printed to six digits, and each trial of a long latency is costly.
const SHARP: f64 = 1e-7;

impl<M: Model<1>> Loop<M> {
    /// The window around `stated`, in the sizes of `kind`, if the loop holds there although it does not at
    /// smaller sizes above `first`, its first limit. Its cost is part of that where a cost is tolerated.
    pub(super) fn regained(
        &self,
        plant: &Plant<'_>,
        kind: Kind,
        [first, stated]: [f64; 2],
        tolerance: Tolerance,
    ) -> Result<Option<Regained>, LoopError> {
        if stated <= first {
            return Ok(None);
        }
        let dear = match tolerance {
            Tolerance { of: Measure::Cost, most } => {
                Some((1.0 + most) * self.cost(plant, &Imperfections::NONE, self.weights)?)
            }
            _ => None,
        };
        let holds = |size: f64| -> Result<bool, LoopError> {
            let with = self.only(kind, size)?;
            let held: Result<bool, CostError> = match dear {
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
            (Kind::Latency, Law::Pd(_) | Law::Lqr(_)) => {
                let windows = plant.latency_windows(self.gains()).stable.into_iter();
                let ends = windows.flat_map(|(from, to)| [Some(from), to]).flatten();
                ends.flat_map(|end| [end.floor(), end.ceil()]).collect()
            }
            _ => self.tried(kind, self.largest(kind))?,
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
                return Ok(Some(Regained { from, to: Some(end(inside, size)?) }));
            }
            inside = size;
        }
        Ok(Some(Regained { from, to: None }))
    }
}
