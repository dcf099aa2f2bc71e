//! The page of the study `stability` of a system of equations.

use libration::Method;
use libration_report::Record;
use libration_report::figure::{Axis, Dash, Figure, Mark, Panel, Role};
use libration_report::notation::{list, seconds};
use libration_report::page::{Highlight, Page};
use libration_report::record::RecordError;

use crate::method_color::method_color;

/// The name of an empty table that says that the equations have kinks or jumps.
pub(super) const KINKS: &str = "kinks";

/// The name of an empty table that says that a mode of the system itself grows.
pub(super) const GROWS: &str = "growing mode";

/// Fills the page.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Stability".into();
    let limit = |method: Method| {
        let limit = record.finding(&format!("stability.{}.limit", method.name())).ok()?;
        // Where a limit is predicted, the measured one agrees with it.
        let alone = if limit.predicted.is_none() { " (measured alone)" } else { "" };
        Some((method.title(), seconds(limit.measured, 3) + alone))
    };
    let limits: Vec<(&str, String)> = Method::ALL.into_iter().filter_map(limit).collect();
    let words: Vec<String> = limits.iter().map(|(title, dt)| format!("{title} {dt}")).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    page.answer = match words.as_slice() {
        [] if record.table(GROWS).is_ok() => "The system is unstable at its equilibrium: a mode grows, whatever the step, so that stability \
                limits no step."
            .to_owned(),
        [] => "No integrator has a largest stable step at the equilibrium: its modes grow in all steps."
            .to_owned(),
        words => format!("Largest stable steps at the equilibrium: {}.", list(words)),
    };
    if let Some((title, dt)) = limits.last() {
        page.highlights.push(Highlight {
            value: dt.clone(),
            text: format!("largest stable step of {title} at the equilibrium"),
        });
    }
    page.paragraph(
        "Newton’s method searches an equilibrium from the start and from zero; this one is nearer to the start. Inputs are zero, and \
         derivatives are exact.",
    );
    page.table(record.table("equilibrium")?, 6);
    if record.table(KINKS).is_ok() {
        page.note(
            "The equations have kinks or jumps. Modes and stable steps are those of the derivatives at the equilibrium, which say \
             nothing of motion beyond a kink.",
        );
    }
    page.heading("Modes");
    page.table(record.table("modes")?, 5);
    page.heading("Steps");
    page.paragraph(
        "Predictions follow from the eigenvalues of the linear equations and the polynomials of a step. Measurements are of the \
         derivative of the step on the equations themselves, at the equilibrium.",
    );
    page.table(record.table("steps")?, 6);
    page.figure(radii(record)?);
    let advise = "`libration advise --system FILE --tolerance trajectory=1e-3 --horizon 10`";
    page.action(match limits.is_empty() {
        true => {
            format!("Choose the time step by its error, since stability gives no limit: {advise}.")
        }
        false => format!("Choose a time step below the largest stable one by its error: {advise}."),
    });
    page.action(
        "Drag the time step and see the motion change: `libration serve --system FILE --open`.",
    );
    Ok(())
}

fn radii(record: &Record) -> Result<Figure, RecordError> {
    let series = record.series("radius")?;
    let dt = series.column("dt")?;
    let axis = Axis::linear("spectral radius").range(0.0, 2.0);
    let mut panel = Panel::new(Axis::log("time step Δt").unit("s"), axis)
        .mark(Mark::horizontal(1.0).role(Role::Neutral).dash(Dash::Solid).width(0.8));
    for method in Method::ALL {
        let Ok(radius) = series.column(method.name()) else { continue };
        let shown: Vec<f64> = radius.iter().map(|&r| if r <= 2.0 { r } else { f64::NAN }).collect();
        panel = panel.mark(Mark::line(dt, shown).role(method_color(method)).label(method.title()));
    }
    Ok(Figure::new("system-stability", "Spectral radius of a step against its length")
        .caption("Above 1 a mode grows from step to step.")
        .description(
            "The spectral radius of a step at the equilibrium against Δt, one line a method.",
        )
        .panel(panel))
}
