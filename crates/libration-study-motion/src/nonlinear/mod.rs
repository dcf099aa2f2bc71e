//! The study `nonlinear`: energy, symmetry and stability of nonlinear systems.

mod actions;
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
use libration_report::record::{Finding, RecordError, Relation, Series, Table, Tolerance};
use libration_study::{Fit, Lab, Section, Study, StudyError};

use super::subject::{Change, Halvings, Law, Problem, Symmetry, configured};

/// The study `nonlinear`.
#[derive(Clone, Copy)]
pub struct Nonlinear<'a> {
    own: &'a [Problem],
}

impl Nonlinear<'static> {
    /// Of the systems that the configuration names.
    pub const FROM_CONFIGURATION: Self = Nonlinear { own: &[] };
}

impl<'a> Nonlinear<'a> {
    /// Of systems of the user's own, whatever the configuration names.
    pub fn of(own: &'a [Problem]) -> Self {
        Nonlinear { own }
    }
}

impl Study for Nonlinear<'_> {
    fn name(&self) -> &'static str {
        "nonlinear"
    }

    fn question(&self) -> &'static str {
        match self.own {
            [] => "Which results for the oscillator hold for nonlinear forces?",
            _ => {
                "How far does each integrator let the energy drift, and up to which time step does it keep the orbit?"
            }
        }
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<NonlinearSettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        let configured = configured(lab.config, &lab.config.get::<NonlinearSettings>().systems)?;
        let subjects = if self.own.is_empty() { &configured[..] } else { self.own };
        let cases = cases(lab, subjects, !self.own.is_empty())?;
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
        render::render(record, page, !self.own.is_empty())
    }
}

/// One method on one system, and what is known of both beforehand.
struct Case<'a> {
    subject: &'a Problem,
    law: Law,
    closes: bool,
    method: Method,
    symplectic: bool,
    reversible: bool,
    /// The order of the method on the system; none if its step has no error.
    order: Option<u32>,
    /// Whether the system is the user’s own.
    is_own: bool,
    /// Whether the orbit stays where it is.
    is_bounded: bool,
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

    /// Whether theory promises a mean change of the energy in a turn: positional forces and a closed orbit.
    fn has_rate(&self) -> bool {
        !self.law.velocity_dependent && self.closes
    }

    /// A fitted exponent as a finding; a measurement where nothing is promised.
    fn exponent(&self, quantity: &str, what: &str, promised: Option<f64>, fit: Fit) -> Finding {
        let (id, text) = (self.id(quantity), self.text(what));
        let tolerance = self.tolerance(fit);
        match promised.filter(|_| self.can_judge(fit)) {
            Some(order) => Finding::predicted(id, text, "1", order, fit.exponent, tolerance),
            None => Finding::measured(id, text, "1", fit.exponent),
        }
    }

    /// A fitted exponent that theory bounds from below; a measurement where nothing is promised.
    fn at_least(&self, quantity: &str, what: &str, promised: Option<f64>, fit: Fit) -> Finding {
        let Some(order) = promised.filter(|_| self.can_judge(fit)) else {
            return self.exponent(quantity, what, None, fit);
        };
        let (id, text) = (self.id(quantity), self.text(what));
        let tolerance = self.tolerance(fit);
        Finding::related(id, text, "1", Relation::AtLeast, order, fit.exponent, tolerance)
    }

    /// Whether an exponent can be judged: on a system of the user’s own it may settle at steps that are smaller than all that are
    /// tried.
    fn can_judge(&self, fit: Fit) -> bool {
        !self.is_own || fit.tells_orders_apart()
    }

    /// The tolerance of a fitted exponent.
    fn tolerance(&self, fit: Fit) -> Tolerance {
        if self.is_own { Fit::order_tolerance() } else { fit.tolerance() }
    }
}

/// Every method on every system.
fn cases<'a>(
    lab: &Lab<'_>,
    subjects: &'a [Problem],
    is_own: bool,
) -> Result<Vec<Case<'a>>, StudyError> {
    let known = lab.sweep("what theory says", subjects, |subject| {
        // Orbits of the catalogue stay.
        let is_bounded = !is_own || subject.is_bounded();
        Ok((subject.law(), subject.closes(), is_bounded))
    })?;
    let mut cases = Vec::new();
    for (subject, (law, closes, is_bounded)) in subjects.iter().zip(known) {
        for &method in &lab.config.integrators {
            let (symplectic, reversible) = Symmetry::of_method(method);
            // A kick that depends on the velocity is no exact flow: the order is that of a step on the system.
            let order = match law.velocity_dependent {
                true => subject.derived_order(method),
                false => Some(method.order()),
            };
            cases.push(Case {
                subject,
                law,
                closes,
                method,
                symplectic,
                reversible,
                order,
                is_own,
                is_bounded,
            });
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
        // Of a system of the user’s own only where theory promises a rate: it takes the longest of all.
        let is_wanted = !case.is_own || case.has_rate();
        let rate = (!case.is_symplectic() && is_wanted).then(|| changes(Change::Rate));
        let rate = rate.transpose()?;
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
            // Of any system theory bounds the order from below: where forces are nearly linear the leading term is small.
            record.find(match known && !case.is_own {
                true => case.exponent("swing-order", what, Some(swinging), fit),
                false => case.at_least("swing-order", what, case.order.map(f64::from), fit),
            });
        }
        if let Some(rate) = rate {
            if let Some(fit) = Fit::new(&rate.dt, &rate.size) {
                let what = "exponent of Δt in the mean energy change of a turn";
                let promised = case.has_rate().then_some(secular);
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
