//! Symplecticity and reversibility of one step, along the orbit.

use libration::Float;
use libration::number::TwoFloat;
use libration_report::record::{Finding, Record, Relation, Table, Tolerance};
use libration_study::{Fit, Lab, StudyError};

use super::super::subject::{Halvings, ROUNDING};
use super::Trial;

/// Where the bound on a defect that vanishes comes from.
const BITS: &str = "2⁻⁹⁰⁰: 1024 bits, less what a step and its products can lose of them";

/// Steps a turn at which defects are taken: five of them make a fit.
const STEPS: Halvings = Halvings { coarsest: 256, finest: 4096 };

/// Measures the defects of every trial at several steps.
pub(super) fn measure(
    lab: &Lab<'_>,
    trials: &[Trial<'_>],
    record: &mut Record,
) -> Result<(), StudyError> {
    let found = lab.sweep("symmetries along the orbit", trials, |trial| {
        Ok(STEPS.steps().map(|n| trial.subject.symmetry(trial.method, n)).collect::<Vec<_>>())
    })?;
    let columns = [
        "system",
        "integrator",
        "‖MᵀJM − J‖",
        "exponent of ‖MᵀJM − J‖",
        "‖M₋M − 1‖",
        "exponent of ‖M₋M − 1‖",
        "|Φ₋Φ(y) − y|",
        "exponent of |Φ₋Φ(y) − y|",
    ];
    let mut table = Table::new("defects", &columns);
    for (trial, defects) in trials.iter().zip(&found) {
        let dt: Vec<f64> = STEPS.steps().map(|n| trial.subject.turn() / n as f64).collect();
        let p = f64::from(trial.method.order());
        let even = trial.method.order().is_multiple_of(2);
        let of = |f: fn(&super::Symmetry) -> f64| -> Vec<f64> { defects.iter().map(f).collect() };
        // The error of a step is C·Δt^{p+1}: its Jacobian breaks the symmetry to that order. A
        // step back errs by C·(−Δt)^{p+1}, which undoes an odd power: what remains is of order
        // p + 2 for even p. Areas may do better: on a linear system odd powers cannot change them.
        let areas = if even && trial.law.linear { p + 2.0 } else { p + 1.0 };
        let time = if even { p + 2.0 } else { p + 1.0 };
        let quantities = [
            (
                "symplecticity",
                columns[2],
                trial.symplectic,
                areas,
                ROUNDING,
                BITS,
                of(|s| s.symplecticity),
            ),
            (
                "reversibility",
                columns[4],
                trial.reversible,
                time,
                ROUNDING,
                BITS,
                of(|s| s.reversibility),
            ),
            (
                "return",
                columns[6],
                trial.reversible,
                time,
                100.0 * TwoFloat::UNIT_ROUNDOFF,
                RETURN,
                of(|s| s.return_error),
            ),
        ];
        let mut row = vec![trial.subject.title().into(), trial.method.title().into()];
        for (quantity, symbol, vanishes, order, bound, why, sizes) in quantities {
            let fit = Fit::new(&dt, &sizes);
            let vanishes = vanishes && !trial.law.velocity_dependent;
            row.push(sizes[0].into());
            let power = fit.filter(|_| !vanishes).map(|fit| fit.exponent);
            row.push(power.into());
            let largest = sizes.iter().copied().fold(0.0, f64::max);
            if trial.law.velocity_dependent {
                let what = format!("{symbol} of a step, largest of five steps");
                record.find(Finding::measured(trial.id(quantity), trial.text(&what), "1", largest));
            } else if vanishes {
                let what = format!("{symbol} of a step, the largest at five time steps");
                record.find(Finding::predicted(
                    trial.id(quantity),
                    trial.text(&what),
                    "1",
                    0.0,
                    largest,
                    Tolerance::absolute(bound, why),
                ));
            } else if let Some(fit) = fit {
                let what = format!("exponent of Δt in {symbol} of a step");
                let name = format!("{quantity}-order");
                record.find(match quantity == "symplecticity" && even && !trial.law.linear {
                    true => at_least(trial, &name, &what, order, fit),
                    false => trial.exponent(&name, &what, Some(order), fit),
                });
            }
        }
        table.push(row);
    }
    record.tables.push(table);
    Ok(())
}

/// Where the bound on the way there and back comes from.
const RETURN: &str = "100 roundings of a double-double, in units of the orbit’s size; the weights \
                      of a composition are the same both ways";

/// The error of a step may keep areas to leading order: theory bounds the exponent from below.
fn at_least(trial: &Trial<'_>, name: &str, what: &str, order: f64, fit: Fit) -> Finding {
    let (id, text) = (trial.id(name), trial.text(what));
    let relation = Relation::AtLeast;
    Finding::related(id, text, "1", relation, order, fit.exponent, fit.tolerance())
}
