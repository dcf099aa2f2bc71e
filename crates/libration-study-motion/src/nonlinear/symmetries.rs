//! Symplecticity and reversibility of one step, along the orbit.

use libration::Float;
use libration::number::TwoFloat;
use libration_report::record::{Cell, Finding, Record, Table, Tolerance};
use libration_study::{Fit, Lab, StudyError};

use super::super::subject::{Halvings, ROUNDING};
use super::Case;

/// Explanation of the bound on a zero defect.
const BITS: &str = "2⁻⁹⁰⁰: 1024 bits, less what a step and its products can lose of them";

/// Steps a turn at which defects are taken: five of them make a fit.
const STEPS: Halvings = Halvings { coarsest: 256, finest: 4096 };

/// The most operations of a derivative of a step in 1024 bits: those of all steps take some seconds.
const MOST: usize = 20_000;

/// Measures the defects of every case at several steps, but for those of systems so large that it would take minutes.
pub(super) fn measure(
    lab: &Lab<'_>,
    cases: &[Case<'_>],
    record: &mut Record,
) -> Result<(), StudyError> {
    // A kick that depends on the velocity keeps no form, and nothing is promised of its reverse.
    let promised = cases.iter().filter(|case| !case.law.velocity_dependent);
    let (cases, too_large): (Vec<&Case<'_>>, Vec<&Case<'_>>) =
        promised.partition(|case| case.subject.symmetry_operations(case.method) <= MOST);
    let found = lab.sweep("symmetries along the orbit", &cases, |case| {
        Ok(STEPS.steps().map(|n| case.subject.symmetry(case.method, n)).collect::<Vec<_>>())
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
    for (case, defects) in cases.iter().zip(&found) {
        let dt: Vec<f64> = STEPS.steps().map(|n| case.subject.turn() / n as f64).collect();
        let p = f64::from(case.method.order());
        let even = case.method.order().is_multiple_of(2);
        let of = |f: fn(&super::Symmetry) -> f64| -> Vec<f64> { defects.iter().map(f).collect() };
        // The error of a step is C·Δt^{p+1}: its Jacobian breaks the symmetry to that order. A
        // step back errs by C·(−Δt)^{p+1}, which undoes an odd power: what remains is of order
        // p + 2 for even p. Areas may do better: on a linear system odd powers cannot change them.
        let areas = if even && case.law.linear { p + 2.0 } else { p + 1.0 };
        let time = if even { p + 2.0 } else { p + 1.0 };
        let quantities = [
            (
                "symplecticity",
                columns[2],
                case.symplectic,
                areas,
                ROUNDING,
                BITS,
                of(|s| s.symplecticity),
            ),
            (
                "reversibility",
                columns[4],
                case.reversible,
                time,
                ROUNDING,
                BITS,
                of(|s| s.reversibility),
            ),
            (
                "return",
                columns[6],
                case.reversible,
                time,
                100.0 * TwoFloat::UNIT_ROUNDOFF,
                RETURN,
                of(|s| s.return_error),
            ),
        ];
        let mut row = vec![case.subject.title().into(), case.method.title().into()];
        for (quantity, symbol, vanishes, order, bound, why, sizes) in quantities {
            let fit = Fit::new(&dt, &sizes);
            let is_promised = quantity != "symplecticity" || case.law.has_potential;
            let vanishes = vanishes && is_promised;
            row.push(sizes[0].into());
            let power = fit.filter(|_| !vanishes).map(|fit| fit.exponent);
            row.push(power.into());
            let largest = sizes.iter().copied().fold(0.0, f64::max);
            if !is_promised {
                let what = format!("{symbol} of a step, the largest at five time steps");
                record.find(Finding::measured(case.id(quantity), case.text(&what), "1", largest));
            } else if vanishes {
                let what = format!("{symbol} of a step, the largest at five time steps");
                record.find(Finding::predicted(
                    case.id(quantity),
                    case.text(&what),
                    "1",
                    0.0,
                    largest,
                    Tolerance::absolute(bound, why),
                ));
            } else if let Some(fit) = fit.filter(|_| largest > bound) {
                let what = format!("exponent of Δt in {symbol} of a step");
                let name = format!("{quantity}-order");
                record.find(match quantity == "symplecticity" && even && !case.law.linear {
                    // The error of a step may keep areas to leading order: theory bounds the exponent from below.
                    true => case.at_least(&name, &what, Some(order), fit),
                    false => case.exponent(&name, &what, Some(order), fit),
                });
            }
        }
        table.push(row);
    }
    for case in too_large {
        let names = [case.subject.title().into(), case.method.title().into()];
        let absent = (names.len()..columns.len()).map(|_| Cell::absent("too large"));
        table.push(names.into_iter().chain(absent));
    }
    record.tables.push(table);
    Ok(())
}

/// Explanation of the bound on the return error.
const RETURN: &str = "100 roundings of a double-double, in units of the orbit’s size; the weights \
                      of a composition are the same both ways";
