//! The study `spectrum`: matrix, eigenvalues, symmetries and stability of one step.

mod claims;
mod exact;
mod limit;
mod region;
mod render;
mod settings;
mod source_claims;
mod step;

use libration_study::SourceClaim;

pub use self::settings::SpectrumSettings;
use self::source_claims::SOURCE_CLAIMS;
use libration::Method;
use libration::analysis::SymbolicStep;
use libration::system::Oscillator;
use libration_study::Section;

use self::limit::Limit;
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::{Finding, RecordError, Relation, Series, Table, Tolerance};
use libration_study::{Lab, Study, StudyError};

use self::region::Region;
use self::step::{Measured, Run, Theory, defects};

/// The study `spectrum`.
#[derive(Clone, Copy, Debug)]
pub struct Spectrum;

impl Study for Spectrum {
    fn name(&self) -> &'static str {
        "spectrum"
    }

    fn question(&self) -> &'static str {
        "What does one step do to the oscillator, and which steps keep it stable?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<SpectrumSettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        record.tables.push(matrices(&lab.config.integrators)?);
        exact::eigenvalues(lab.config, &mut record);
        steps(lab, &mut record)?;
        sweeps(lab, &mut record)?;
        limits(lab, &mut record)?;
        regions(lab, &mut record)?;
        claims::judge(&mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// The update matrices as polynomials, by running the steps on polynomials.
fn matrices(methods: &[Method]) -> Result<Table, StudyError> {
    let columns = ["integrator", "x → x", "v/ω → x", "x → v/ω", "v/ω → v/ω", "determinant"];
    let mut table = Table::new("update matrices", &columns);
    for &method in methods {
        let step = SymbolicStep::new(method)
            .ok_or_else(|| StudyError::Exact(format!("deriving {}", method.title())))?;
        let entries = step.matrix.rows().concat().into_iter().map(|p| p.to_string().into());
        table.push(
            [method.title().into()]
                .into_iter()
                .chain(entries)
                .chain([step.determinant().to_string().into()]),
        );
    }
    Ok(table)
}

/// The findings at the configured time step.
fn steps(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let (oscillator, dt) =
        (lab.config.oscillator.system(), lab.config.get::<SpectrumSettings>().dt);
    let count = lab.effort.choose(10_000, 100_000, 1_000_000);
    let found = lab.sweep("one step, many times", &lab.config.integrators, |&method| {
        let theory = Theory::of(method, oscillator, dt);
        let run = Run::new(method, oscillator, dt, count, &theory)?;
        Ok((method, theory, run, defects(method, oscillator, dt)))
    })?;
    let columns =
        ["integrator", "det M − 1", "ρ − 1", "phase error (rad)", "‖MᵀJM − J‖", "‖M₋M − 1‖"];
    let mut table = Table::new("one step", &columns);
    for (method, theory, run, (symplecticity, reversibility)) in found {
        let title = method.title();
        let id = |quantity: &str| format!("spectrum.{}.{quantity}", method.name());
        let mut find =
            |quantity: &str, text: String, unit, predicted, measured: Measured, why: &str| {
                let tolerance = Tolerance::absolute(measured.rounding, why);
                let value = measured.value;
                let finding =
                    Finding::predicted(id(quantity), text, unit, predicted, value, tolerance);
                record.find(finding);
            };
        // What rounding may have left alone, at extreme steps, is no evidence.
        if let Some(run) = run.filter(|r| r.radius_minus_one.tells(1.0 + theory.radius_minus_one)) {
            let n = run.steps;
            find(
                "radius",
                format!("{title}: spectral radius minus one, from the area after {n} steps"),
                "1",
                theory.radius_minus_one,
                run.radius_minus_one,
                "20 roundings a step that add up like √n, over n steps, and 4 of the coefficients, \
                 times the condition of the eigenvectors",
            );
            if let (Some((angle, predicted)), Some(measured)) = (theory.angle, run.phase_error)
                && measured.tells(angle)
            {
                find(
                    "phase-error",
                    format!("{title}: phase error per step, from the angle after {n} steps"),
                    "rad",
                    predicted,
                    measured,
                    "20 roundings a step that add up like √n, over n steps, and 4 of the coefficients, \
                     times the condition of the eigenvectors; and 4 of nθ",
                );
            }
        }
        let defects = [
            ("symplecticity", "‖MᵀJM − J‖", theory.symplecticity_defect, symplecticity),
            ("reversibility", "‖M(−Δt)M(Δt) − 1‖", theory.reversibility_defect, reversibility),
        ];
        for (quantity, norm, predicted, measured) in defects {
            if measured.tells(1.0 + predicted) {
                let text = format!("{title}: {norm} of one step in f64");
                let why = "40 roundings of the largest product of entries, in each substep";
                find(quantity, text, "1", predicted, measured, why);
            }
        }
        let phase = theory.angle.map(|(_, error)| error).into();
        table.push([
            title.into(),
            theory.determinant_minus_one.into(),
            theory.radius_minus_one.into(),
            phase,
            theory.symplecticity_defect.into(),
            theory.reversibility_defect.into(),
        ]);
    }
    record.tables.push(table);
    Ok(())
}

/// Growth and phase error over three decades of `z = ωΔt`.
fn sweeps(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let points: u32 = lab.effort.choose(13, 25, 49);
    let count = lab.effort.choose(2_000, 20_000, 200_000);
    let (low, high) = (1e-3_f64.ln(), 1.9_f64.ln());
    let step = (high - low) / f64::from(points - 1);
    let z: Vec<f64> = (0..points).map(|i| (low + step * f64::from(i)).exp()).collect();
    let unit = Oscillator { omega2: 1.0 };
    let jobs: Vec<(Method, f64)> =
        lab.config.integrators.iter().flat_map(|&m| z.iter().map(move |&z| (m, z))).collect();
    let found = lab.sweep("phase errors over three decades of z", &jobs, |&(method, z)| {
        let theory = Theory::of(method, unit, z);
        Ok((theory, Run::new(method, unit, z, count, &theory)?))
    })?;
    for (&method, rows) in lab.config.integrators.iter().zip(found.chunks(z.len())) {
        let mut series = [const { Vec::new() }; 4];
        let mut worst = 0.0_f64;
        for (theory, run) in rows {
            let Some(run) = run else { continue };
            let predicted = theory.angle.map_or(f64::NAN, |(_, error)| error);
            let measured = run.phase_error.map_or(f64::NAN, |m| m.value);
            let row = [predicted, measured, theory.radius_minus_one, run.radius_minus_one.value];
            series.iter_mut().zip(row).for_each(|(column, x)| column.push(x));
            let radius = run.radius_minus_one;
            worst = worst.max((radius.value - row[2]).abs() / radius.rounding);
            if let Some(phase) = run.phase_error {
                worst = worst.max((phase.value - predicted).abs() / phase.rounding);
            }
        }
        let [predicted, measured, growth, measured_growth] = series;
        record.series.push(
            Series::new(format!("sweep-{}", method.name()))
                .with("z", "1", z.clone())
                .with("phase_error_predicted", "rad", predicted)
                .with("phase_error_measured", "rad", measured)
                .with("radius_minus_one_predicted", "1", growth)
                .with("radius_minus_one_measured", "1", measured_growth),
        );
        record.find(Finding::related(
            format!("spectrum.{}.sweep", method.name()),
            format!(
                "{}: largest distance of measured growth and phase from theory at {points} values \
                 of z, in units of the rounding that they may carry",
                method.title()
            ),
            "1",
            Relation::AtMost,
            1.0,
            worst,
            Tolerance::exact("the bound on rounding is the unit"),
        ));
    }
    Ok(())
}

/// The ends of the stability intervals on the imaginary and the negative real axis.
fn limits(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let steps = lab.effort.choose(5_000, 20_000, 20_000);
    let found = lab.sweep("stability limits", &lab.config.integrators, |&method| {
        Ok((method, Limit::imaginary(method, steps)?, Limit::real(method)))
    })?;
    for (method, imaginary, real) in found {
        let (name, title) = (method.name(), method.title());
        record.find(imaginary.finding(
            format!("spectrum.{name}.imaginary-limit"),
            format!("{title}: largest stable z = ωΔt of an undamped oscillator"),
        ));
        record.find(real.finding(
            format!("spectrum.{name}.real-limit"),
            format!("{title}: largest stable |λ|Δt of a critically damped mode"),
        ));
    }
    if lab.config.integrators.contains(&Method::SymplecticEuler) {
        record.find(limit::defective_growth()?);
    }
    Ok(())
}

/// Maps of the spectral radius over the complex plane.
fn regions(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let side = lab.effort.choose(61, 91, 181);
    let maps = lab.sweep("stability regions", &lab.config.integrators, |&method| {
        Ok(Region::new(method, side).into_series(method))
    })?;
    record.series.extend(maps);
    Ok(())
}
