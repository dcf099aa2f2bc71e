//! The study `nonlinear`: energy, symmetry and stability of nonlinear systems.

mod captions;
mod growth;
mod limit;
mod render;
mod settings;
mod symmetries;

pub use self::settings::NonlinearSettings;
use libration::Method;
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::{Finding, RecordError, Series, Table};
use libration_study::{Fit, Lab, Section, Study, StudyError};

use super::subject::{Change, Halvings, Law, Subject, Symmetry, configured};

/// The study `nonlinear`.
#[derive(Clone, Copy)]
pub struct Nonlinear<'a> {
    own: &'a [&'a dyn Subject],
}

impl Nonlinear<'static> {
    /// Of the systems that the configuration names.
    pub const FROM_CONFIGURATION: Self = Nonlinear { own: &[] };
}

impl<'a> Nonlinear<'a> {
    /// Of systems of the user's own, whatever the configuration names.
    pub fn of(own: &'a [&'a dyn Subject]) -> Self {
        Nonlinear { own }
    }
}

impl Study for Nonlinear<'_> {
    fn name(&self) -> &'static str {
        "nonlinear"
    }

    fn question(&self) -> &'static str {
        "Which results for the oscillator hold for nonlinear forces?"
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<NonlinearSettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        let configured = configured(lab.config, &lab.config.get::<NonlinearSettings>().systems)?;
        let configured: Vec<&dyn Subject> = configured.iter().map(AsRef::as_ref).collect();
        let subjects = if self.own.is_empty() { &configured } else { self.own };
        let cases = cases(lab, subjects)?;
        growth::measure(lab, &cases, &mut record)?;
        exponents(lab, &cases, &mut record)?;
        symmetries::measure(lab, &cases, &mut record)?;
        limit::search(lab, &cases, &mut record)?;
        let mut systems = Table::new("systems", &["name", "system"]);
        subjects.iter().for_each(|s| systems.push([s.name().into(), s.title().into()]));
        record.tables.push(systems);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// One method on one system, and what is known of both beforehand.
struct Case<'a> {
    subject: &'a dyn Subject,
    law: Law,
    closes: bool,
    method: Method,
    symplectic: bool,
    reversible: bool,
}

impl Case<'_> {
    fn id(&self, quantity: &str) -> String {
        format!("nonlinear.{}.{}.{quantity}", self.subject.name(), self.method.name())
    }

    fn text(&self, what: &str) -> String {
        format!("{}, {}: {what}", self.method.title(), self.subject.title())
    }

    /// Whether the method keeps areas of phase space on this system.
    fn is_symplectic(&self) -> bool {
        self.symplectic && !self.law.velocity_dependent
    }

    /// A fitted exponent as a finding; a measurement where nothing is promised.
    fn exponent(&self, quantity: &str, what: &str, promised: Option<f64>, fit: Fit) -> Finding {
        let (id, text) = (self.id(quantity), self.text(what));
        match promised {
            Some(order) => Finding::predicted(id, text, "1", order, fit.exponent, fit.tolerance()),
            None => Finding::measured(id, text, "1", fit.exponent),
        }
    }
}

/// Every method on every system.
fn cases<'a>(lab: &Lab<'_>, subjects: &[&'a dyn Subject]) -> Result<Vec<Case<'a>>, StudyError> {
    let known =
        lab.sweep("what theory says", subjects, |subject| Ok((subject.law(), subject.closes())))?;
    let mut cases = Vec::new();
    for (&subject, (law, closes)) in subjects.iter().zip(known) {
        for &method in &lab.config.integrators {
            let (symplectic, reversible) = Symmetry::of_method(method);
            cases.push(Case { subject, law, closes, method, symplectic, reversible });
        }
    }
    Ok(cases)
}

/// The time steps that this effort affords.
fn halvings(lab: &Lab<'_>) -> Halvings {
    Halvings { coarsest: 64, finest: lab.effort.choose(1 << 14, 1 << 16, 1 << 18) }
}

/// How the energy's swing within a turn, and its mean change in a turn, depend on the step.
fn exponents(lab: &Lab<'_>, cases: &[Case<'_>], record: &mut Record) -> Result<(), StudyError> {
    let found = lab.sweep("energy at ever smaller steps", cases, |case| {
        let changes = |change| case.subject.changes(change, case.method, halvings(lab));
        let rate = (!case.is_symplectic()).then(|| changes(Change::Rate)).transpose()?;
        Ok((changes(Change::Swing)?, rate))
    })?;
    for (case, (swing, rate)) in cases.iter().zip(found) {
        let order = f64::from(case.method.order());
        let known = !case.law.velocity_dependent;
        let even = case.method.order().is_multiple_of(2);
        // The step is ρ-reversible with Δt → −Δt: a term of the modified equation with an even
        // power of Δt changes the energy by a function that is odd under time reversal, and gives
        // back on one half of a closed orbit what it takes on the other.
        let secular = if even { order + 1.0 } else { order };
        // On a linear system RK4 keeps the shape of the energy: nothing swings, all is secular.
        let swinging = if case.law.linear && !case.symplectic { secular } else { order };
        if let Some(fit) = Fit::new(&swing.dt, &swing.size) {
            let what = "exponent of Δt in the largest energy drift within a turn";
            record.find(case.exponent("swing-order", what, known.then_some(swinging), fit));
        }
        if let Some(rate) = rate {
            if let Some(fit) = Fit::new(&rate.dt, &rate.size) {
                let what = "exponent of Δt in the mean energy change of a turn";
                let promised = (known && case.closes).then_some(secular);
                record.find(case.exponent("rate-order", what, promised, fit));
            }
            record.series.push(
                Series::new(format!("rate-{}-{}", case.subject.name(), case.method.name()))
                    .with("dt", "s", rate.dt)
                    .with("rate", "", rate.size),
            );
        }
        record.series.push(
            Series::new(format!("swing-{}-{}", case.subject.name(), case.method.name()))
                .with("dt", "s", swing.dt)
                .with("swing", "", swing.size),
        );
    }
    Ok(())
}
