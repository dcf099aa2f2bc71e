//! The chapter on adaptive steps.

use libration_report::figure::{Axis, Figure, Mark, Panel, Role};
use libration_report::notation::number;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError};

use super::orbit_run::Steps;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Adaptive steps".into();
    let eccentricities = eccentricities(record);
    let Some(&most) = eccentricities.last() else { return Ok(()) };
    let of = |steps: &str, quantity: &str| {
        record.finding(&format!("adaptive.{most}.{steps}.{quantity}")).ok().map(|f| f.measured)
    };
    if let (Some(naive), Some(integrating)) = (of("naive", "largest"), of("integrating", "bounded"))
    {
        page.answer = format!(
            "On an orbit of eccentricity {most} the largest relative error of the energy is {} if steps follow the state before them, and {} if \
             they follow a density that is integrated, with no more steps.",
            number(naive, 2),
            number(integrating, 2)
        );
        page.headline = "Adaptive steps keep the energy if a step back undoes a step.".into();
        page.highlights.push(Highlight {
            value: number(naive / integrating, 2),
            text: "times smaller is the largest energy error of reversible steps".into(),
        });
    }
    page.paragraph(
        "A step has the length of the local time scale: the reciprocal of the frequency at which forces change in space. Naive steps take it \
         at their beginning, symmetric ones as the mean of both ends, which is an equation for one number. Integrating steps follow a \
         density with an equation of motion of its own (Hairer and Söderlind, 2005), without an equation to solve. All take steps of \
         leapfrog.",
    );
    page.figure(energies(record, &eccentricities)?);
    page.table(record.table("energies")?, 3);
    page.heading("There and back");
    page.paragraph(
        "A motion is turned around and runs back. Reversible steps return to the start up to rounding, which grows with the phase error. On \
         a grid of fixed spacing sums are exact, and the motion returns to the last bit.",
    );
    page.table(record.table("returns")?, 3);
    page.action(
        "Let steps follow an integrated density on eccentric orbits: \
         `libration simulate --system FILE --integrator leapfrog --dt 0.01 --steps 1e4 --adaptive integrating`.",
    );
    if let (Some(fixed), Some(integrating)) = (of("fixed", "largest"), of("integrating", "bounded"))
        && fixed > integrating
    {
        page.action(format!(
            "Do not use fixed steps at eccentricity {most}: their energy error is {} times as large.",
            number(fixed / integrating, 2)
        ));
    }
    Ok(())
}

/// The eccentricities of the record, in its order.
fn eccentricities(record: &Record) -> Vec<f64> {
    let mut found: Vec<f64> = Vec::new();
    for series in &record.series {
        let e = series.name.strip_prefix("energy-").and_then(|rest| rest.split('-').next());
        if let Some(e) = e.and_then(|e| e.parse().ok())
            && found.last() != Some(&e)
        {
            found.push(e);
        }
    }
    found
}

/// The largest energy errors of periods.
fn energies(record: &Record, eccentricities: &[f64]) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("adaptive-energy", "Largest relative energy error of a period")
        .caption(
            "Fixed steps fail at the pericentre, naive steps drift, and reversible steps stay where they \
             begin.",
        )
        .description("Log-log: energy error of each period for four kinds of steps.")
        .columns(eccentricities.len().min(2))
        .aspect(1.15);
    for e in eccentricities {
        let mut panel = Panel::new(Axis::log("period"), Axis::log("relative energy error"))
            .title(format!("e = {e}"));
        for (steps, role) in
            Steps::ALL.into_iter().zip([Role::Neutral, Role::Bad, Role::Accent(0), Role::Good])
        {
            let series = record.series(&format!("energy-{e}-{}", steps.name()))?;
            panel = panel.mark(
                Mark::line(series.column("period")?, series.column("largest")?)
                    .role(role)
                    .label(steps.name()),
            );
        }
        figure = figure.panel(panel);
    }
    Ok(figure)
}
