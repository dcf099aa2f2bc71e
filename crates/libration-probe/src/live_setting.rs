//! The setting of the live section of a page about a simulator.

use libration::AnyMethod;
use libration::linear::Matrix;
use libration::live::{MOST_DEGREES, Setting};
use libration_report::live::LiveSetting;

use crate::ProbeReport;

/// Largest size of an entry beside the largest of all that is taken for rounding of differences.
const ROUNDING: f64 = 1e-11;

/// The matrix without the entries that are no larger than their errors: a reader would take them for terms of the equations.
fn without_noise(matrix: &Matrix, errors: &Matrix) -> Matrix {
    let (rows, columns) = (matrix.rows(), matrix.columns());
    let entries = || (0..rows).flat_map(|i| matrix.row(i).iter());
    let largest = entries().fold(0.0_f64, |most, x| most.max(x.abs()));
    Matrix::from_fn(rows, columns, |i, j| match matrix[(i, j)] {
        x if x.abs() <= errors[(i, j)].max(ROUNDING * largest) => 0.0,
        x => x,
    })
}

/// The linearised simulator in steps of its length, from which a reader may change gains and timing; none of a simulator whose steps have
/// one length only, or that is too large.
pub(crate) fn live_settings(audit: &ProbeReport) -> Vec<LiveSetting> {
    let Some(flow) = audit.flow.as_ref().filter(|flow| flow.a.rows() <= MOST_DEGREES) else {
        return Vec::new();
    };
    let names = |given: &[String]| {
        given.iter().map(|name| name.split(' ').next().unwrap_or_default().to_owned()).collect()
    };
    let names = [names(&audit.states), names(&audit.inputs)];
    let a = without_noise(&flow.a, &flow.a_errors);
    let mut setting = Setting::of_plant("the simulator, linearised", &a, &flow.b, names);
    // Its own integrator, where it is known and this form of the plant has positions and velocities.
    let recognised = audit.recognition.as_ref().and_then(|own| own.by_results.methods.first());
    let mechanical = !setting.definitions.coordinates.is_empty();
    if let Some(method) =
        recognised.and_then(|name| AnyMethod::from_name(name)).filter(|_| mechanical)
    {
        setting.integrator = method;
    }
    setting.dt = audit.dt;
    setting.horizon = setting.horizon.max(100.0 * audit.dt);
    vec![LiveSetting { title: setting.system.clone(), text: setting.to_string() }]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_within_their_errors_are_no_terms_and_all_others_keep_their_bits() {
        let a = Matrix::from_fn(2, 2, |i, j| [[1.5e-12, 1.0], [-9.81, 1e-3]][i][j]);
        let errors = Matrix::from_fn(2, 2, |i, j| [[1e-13, 1e-12], [1e-12, 2e-3]][i][j]);
        let found = without_noise(&a, &errors);
        // The first is rounding beside 9.81, the last within its error.
        assert_eq!(found, Matrix::from_fn(2, 2, |i, j| [[0.0, 1.0], [-9.81, 0.0]][i][j]));
        assert_eq!(without_noise(&a, &errors.scaled(0.0))[(1, 1)], 1e-3);
    }
}
