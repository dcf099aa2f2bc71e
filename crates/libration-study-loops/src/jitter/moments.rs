//! Second moments with jitter, from the moment matrix.

use libration::Method;
use libration_report::notation::count;
use libration_report::record::{Finding, Record, Table, Tolerance};
use libration_study::{Lab, StudyError};

use super::setting::{FREE, Setting};
use super::{free, start};
use crate::sample::Sample;

/// Where they are compared, and after how many steps: before they hang on a few trajectories that have grown most.
const SETTINGS: [(Method, f64, f64, u64); 6] = [
    (Method::SymplecticEuler, 0.1, 0.1, 2000),
    (Method::SymplecticEuler, 0.3, 0.05, 400),
    (Method::SymplecticEuler, 0.3, 0.1, 100),
    (Method::VelocityVerlet, 0.3, 0.1, 400),
    (Method::VelocityVerlet, 0.3, 0.2, 100),
    (Method::Rk4, 0.3, 0.1, 400),
];

/// Compares mean energies with theory.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let known = SETTINGS.iter().filter(|(m, ..)| lab.config.integrators.contains(m));
    let settings: Vec<(Setting, u64)> =
        known.map(|&(m, dt, rms, n)| (Setting::new(lab.config, m, dt, rms), n)).collect();
    let begin = start(lab);
    let starts = vec![begin; lab.effort.choose(2048, 16_384, 131_072)];
    let runs = lab.sweep("second moments", &settings, |(setting, steps)| {
        let Some(theory) = setting.theory() else { return Ok(None) };
        let square = setting.plant().mean_square(FREE, setting.law());
        let omega2 = setting.model.omega2;
        let energy = |[qq, _, vv]: [f64; 3]| omega2 * qq + vv;
        let first = energy(square.moments(&begin, 0));
        let wanted = energy(square.moments(&begin, *steps)) / first;
        let seen = free(lab, setting, setting.model, &starts, &[*steps])?;
        let energies = seen
            .iter()
            .flat_map(|s| s.logarithms(|y| (omega2 * y.q[0] * y.q[0] + y.v[0] * y.v[0]) / first));
        let found = Sample::of(&energies.map(f64::exp).collect::<Vec<_>>());
        let excess = (square.radius - libration::Scalar::one()).to_f64();
        Ok(Some((wanted, found, excess, theory.rate)))
    })?;
    let columns = [
        "integrator",
        "Δt (s)",
        "σ",
        "ρ(E[M⊗M]) − 1",
        "4γ",
        "steps",
        "mean of E/E₀",
        "standard error",
        "predicted",
    ];
    let mut table = Table::new("second moments", &columns);
    for ((setting, steps), run) in settings.iter().zip(runs) {
        let Some((wanted, found, excess, rate)) = run else { continue };
        let text = format!(
            "mean of E/E₀ over {} trajectories after {} steps",
            count(starts.len() as u64),
            count(*steps)
        );
        let why = "three standard errors";
        let tolerance = Tolerance::absolute(3.0 * found.error(), why);
        let (id, text) = (setting.id("second-moment"), setting.text(&text));
        record.find(Finding::predicted(id, text, "1", wanted, found.mean, tolerance));
        table.push([
            setting.method.title().into(),
            setting.dt.into(),
            setting.rms.into(),
            excess.into(),
            (4.0 * rate).into(),
            (*steps).into(),
            found.mean.into(),
            found.error().into(),
            wanted.into(),
        ]);
    }
    record.tables.push(table);
    Ok(())
}
