//! The order of every method, on linear and nonlinear systems.

mod actions;
mod asymptotic_range;
mod claims;
mod render;
mod settings;
mod source_claims;
mod splitting_order;
mod start_at_equilibrium;
mod state_orders;
mod symmetries;

pub use self::settings::ConvergenceSettings;
use self::source_claims::SOURCE_CLAIMS;
use libration::Method;
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::{Cell, Finding, RecordError, Relation, Series, Table, Tolerance};
use libration_study::{Fit, Lab, Section, SourceClaim, Study, StudyError};

use super::subject::{Errors, Halvings, Kind, Law, Problem, configured};

/// The study `convergence`.
#[derive(Clone, Copy)]
pub struct Convergence<'a> {
    own: &'a [Problem],
}

impl Convergence<'static> {
    /// Of the systems that the configuration names.
    pub const FROM_CONFIGURATION: Self = Convergence { own: &[] };
}

impl<'a> Convergence<'a> {
    /// Of systems of the user's own, whatever the configuration names.
    pub fn of(own: &'a [Problem]) -> Self {
        Convergence { own }
    }
}

impl Study for Convergence<'_> {
    fn name(&self) -> &'static str {
        "convergence"
    }

    fn question(&self) -> &'static str {
        "Does the error of each method converge with its theoretical order?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        // The source says nothing of a user's own systems.
        if self.own.is_empty() { SOURCE_CLAIMS } else { &[] }
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<ConvergenceSettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        let configured = configured(lab.config, &lab.config.get::<ConvergenceSettings>().systems)?;
        let subjects = if self.own.is_empty() { &configured[..] } else { self.own };
        orders(lab, subjects, !self.own.is_empty(), &mut record)?;
        symmetries::measure(lab, subjects, &mut record)?;
        if self.own.is_empty() {
            start_at_equilibrium::measure(lab, &mut record)?;
            splitting_order::certify(lab, &mut record)?;
            claims::judge(&mut record);
        }
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page, !self.own.is_empty())
    }
}

/// The time steps that this effort affords.
fn halvings(lab: &Lab<'_>) -> Halvings {
    let coarsest = lab.config.get::<ConvergenceSettings>().coarsest;
    // Five points make a fit, whatever the largest step.
    let finest = lab.effort.choose(1 << 14, 1 << 16, 1 << 18).max(16 * coarsest);
    Halvings { coarsest, finest }
}

/// One method on one system.
struct Case<'a> {
    subject: &'a Problem,
    method: Method,
    /// The predicted order.
    order: Option<u32>,
    /// Whether the order is that of a step on the system, and not the method’s own.
    is_derived: bool,
    /// Whether the system is the user’s own.
    is_own: bool,
}

/// The predicted order of a method: its own; where the force depends on the velocity, the one that a single step in 1024 bits has
/// on the system, since a kick is then no exact flow and splitting methods lose their order.
fn predicted(subject: &Problem, law: Law, method: Method) -> Option<u32> {
    match is_derived(law, method) {
        true => subject.derived_order(method),
        false => Some(method.order()),
    }
}

fn is_derived(law: Law, method: Method) -> bool {
    let splits = !matches!(method, Method::ExplicitEuler | Method::Rk4);
    splits && law.velocity_dependent
}

/// Fits the order of every method on every system.
fn orders(
    lab: &Lab<'_>,
    subjects: &[Problem],
    is_own: bool,
    record: &mut Record,
) -> Result<(), StudyError> {
    let laws = lab.sweep("reference orbits", subjects, |subject| Ok(subject.law()))?;
    let trials: Vec<Case<'_>> = subjects
        .iter()
        .zip(laws)
        .flat_map(|(subject, law)| {
            lab.config.integrators.iter().map(move |&method| {
                let order = predicted(subject, law, method);
                Case { subject, method, order, is_derived: is_derived(law, method), is_own }
            })
        })
        .collect();
    let found = lab.sweep("errors at ever smaller steps", &trials, |trial| {
        let errors = |kind| trial.subject.errors(kind, trial.method, halvings(lab));
        Ok([errors(Kind::Global)?, errors(Kind::Local)?])
    })?;
    let columns = [
        "system",
        "integrator",
        "global: q",
        "global: v",
        "global: q, v",
        "global: ±",
        "local: q",
        "local: v",
        "local: q, v",
        "local: ±",
    ];
    let mut table = Table::new("orders", &columns);
    for (trial, [global, local]) in trials.iter().zip(&found) {
        let mut row: Vec<Cell> = vec![trial.subject.title().into(), trial.method.title().into()];
        row.extend(trial.order(Kind::Global, global, record));
        row.extend(trial.order(Kind::Local, local, record));
        table.push(row);
    }
    record.tables.push(table);
    let per_subject = found.chunks(lab.config.integrators.len().max(1));
    for (subject, errors) in subjects.iter().zip(per_subject) {
        let all = errors.iter().flat_map(|[global, _]| &global.together).copied();
        let resolved = all.filter(|&error| error > subject.rounding());
        record.find(reference(subject, resolved.fold(f64::INFINITY, f64::min)));
        for (kind, name) in [(0, "global"), (1, "local")] {
            let errors = errors.iter().map(|both| &both[kind]);
            let methods = lab.config.integrators.iter().copied().zip(errors);
            record.series.push(series(format!("{name}-{}", subject.name()), methods));
        }
    }
    if is_own {
        state_orders::find(&trials, &found, lab.config.integrators.len(), record);
    }
    let titles = subjects.iter().map(|s| (s.name(), s.title()));
    let mut systems = Table::new("systems", &["name", "system"]);
    titles.for_each(|(name, title)| systems.push([name.into(), title.into()]));
    record.tables.push(systems);
    Ok(())
}

impl Case<'_> {
    /// Adds what was found of one kind of error; gives the cells of the table.
    fn order(&self, kind: Kind, errors: &Errors, record: &mut Record) -> [Cell; 4] {
        let (name, of) = match kind {
            Kind::Global | Kind::FromStart => ("global", "orbits over more than half a turn"),
            Kind::Local => ("local", "one step"),
        };
        let parts = [
            ("-position", "position", &errors.position),
            ("-velocity", "velocity", &errors.velocity),
            ("", "position and velocity", &errors.together),
        ];
        let mut cells = [const { None }; 4];
        for (cell, (suffix, part, errors_of)) in parts.into_iter().enumerate() {
            let Some(fit) = self.fit(errors, errors_of) else { continue };
            cells[cell] = Some(fit.exponent);
            cells[3] = Some(fit.uncertainty());
            let (subject, method) = (self.subject, self.method);
            let id =
                format!("convergence.{}.{}.{name}-order{suffix}", subject.name(), method.name());
            let text = format!(
                "{}, {}: exponent of Δt in the error of {of}, in {part}",
                method.title(),
                subject.title()
            );
            let order = self.order.map(|order| match kind {
                Kind::Global | Kind::FromStart => f64::from(order),
                // Of a single step.
                Kind::Local => f64::from(order) + 1.0,
            });
            // A derived order is that of the worst state: in others a step may be better.
            let relation = match self.is_derived && !suffix.is_empty() {
                true => Relation::AtLeast,
                false => Relation::Equal,
            };
            let points = [&errors.dt[..], errors_of];
            record.find(self.judge((id, text), order, relation, fit, points));
        }
        cells.map(Cell::from)
    }

    /// The finding about an exponent, with its name and text: judged by the order where it can be, else measured.
    fn judge(
        &self,
        (id, text): (String, String),
        order: Option<f64>,
        relation: Relation,
        fit: Fit,
        points: [&[f64]; 2],
    ) -> Finding {
        let Some(order) = order.filter(|_| self.can_judge(fit)) else {
            return Finding::measured(id, text, "1", fit.exponent);
        };
        match self.undecided(relation, order, fit, points) {
            Some(why) => Finding::measured(id, format!("{text}; {why}"), "1", fit.exponent),
            None => {
                let tolerance = self.tolerance(fit);
                Finding::related(id, text, "1", relation, order, fit.exponent, tolerance)
            }
        }
    }

    /// The exponent of errors; none where the last are rounding of the reference.
    fn fit(&self, errors: &Errors, errors_of: &[f64]) -> Option<Fit> {
        let is_resolved = errors_of.last().is_none_or(|&last| last > self.subject.rounding());
        Fit::new(&errors.dt, errors_of).filter(|_| is_resolved)
    }

    /// Whether an exponent can be judged: the errors of a system of the user’s own, or of one of its states, may settle at
    /// steps that are smaller than all that are tried.
    fn can_judge(&self, fit: Fit) -> bool {
        !self.is_own || fit.tells_orders_apart()
    }

    /// The tolerance of an order.
    fn tolerance(&self, fit: Fit) -> Tolerance {
        if self.is_own { Fit::order_tolerance() } else { fit.tolerance() }
    }
}

/// The reference must be far better than the smallest error that is taken against it.
fn reference(subject: &Problem, smallest: f64) -> Finding {
    Finding::related(
        format!("convergence.{}.reference", subject.name()),
        format!(
            "{}: what halving its pieces changes in the reference orbit, relative to its size",
            subject.title()
        ),
        "1",
        Relation::AtMost,
        0.0,
        subject.reference_error(),
        Tolerance::absolute(
            (1e-3 * smallest).min(1e-20),
            "a thousandth of the smallest error that is taken against it shifts no digit shown",
        ),
    )
}

/// The errors of all methods, padded where a method needed no smaller steps.
fn series<'a>(name: String, methods: impl Iterator<Item = (Method, &'a Errors)>) -> Series {
    let methods: Vec<_> = methods.collect();
    let longest = methods.iter().max_by_key(|(_, errors)| errors.dt.len());
    let dt = longest.map(|(_, errors)| errors.dt.clone()).unwrap_or_default();
    let padded = |values: &[f64]| {
        let mut values = values.to_vec();
        values.resize(dt.len(), f64::NAN);
        values
    };
    let columns: Vec<_> = methods
        .iter()
        .flat_map(|(method, errors)| {
            let named = |part: &str| format!("{} {part}", method.name());
            [
                (named("position"), padded(&errors.position)),
                (named("velocity"), padded(&errors.velocity)),
                (named("together"), padded(&errors.together)),
            ]
        })
        .collect();
    columns
        .into_iter()
        .fold(Series::new(name).with("dt", "s", dt), |s, (name, x)| s.with(name, "", x))
}
