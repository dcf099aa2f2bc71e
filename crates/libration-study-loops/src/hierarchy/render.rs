//! The chapter on the hierarchy.

use libration_report::notation::count;
use libration_report::page::Page;
use libration_report::record::{Record, RecordError};

use super::figures;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Hierarchy".into();
    page.answer = "No imperfection is always the largest: the order depends on the sizes and on \
                   the horizon. The distance from the undisturbed orbit grows exponentially with \
                   the number of steps n under latency of the force, as n with different clock \
                   rates and as √n with jitter. Rounding has the least effect only if the unit \
                   roundoff is small."
        .into();
    page.paragraph(
        "The metric is the distance of a disturbed trajectory from the undisturbed one after the same number \
         of steps, in the energy norm relative to the size of the orbit, as the root mean square over 128 \
         starts around the orbit. The integrator is symplectic Euler at 0.0316 rad per step, as in the source \
         at Δt = 10 ms. The sizes of the imperfections are equal (a part of a step, or a unit roundoff), or typical \
         of a robot (two sets).",
    );
    page.paragraph(
        "The profile has, for each imperfection alone: the steps until the distance is a tenth of the orbit; the rms \
         of ln E/E₀ at the end, for the energy that undisturbed steps conserve; the relative increase ΔJ/J₀ of the cost of a loop with the gains (10, 2) on \
         the same spring under white noise, where J is its mean energy and J₀ that of the ideal \
         loop; and the size as a share of the size at which this loop becomes unstable. Asynchrony changes no energy and \
         uses little of the margin, but trajectories separate earlier than with jitter of the same size.",
    );
    page.table(record.table("profile")?, 3);
    page.figure(figures::short(record)?.number("9.16"));
    page.figure(figures::long(record)?.number("9.17"));
    page.paragraph(
        "Predictions: with a latency of the force the orbit grows by the spectral radius of the \
         loop that consists of the spring. A clock error rotates the orbit by dθ/dΔt times the \
         time error, which after n steps is n times one error, or √n times the rms of independent \
         errors. The effect of rounding on the phase depends on the rounding of the parameters; it \
         is measured only.",
    );
    page.table(record.table("divergence")?, 3);
    actions(record, page);
    Ok(())
}

/// The imperfections by their part of an identifier.
const IMPERFECTIONS: [(&str, &str); 4] = [
    ("latency", "latency"),
    ("jitter", "jitter"),
    ("asynchrony", "the differences of clock rates"),
    ("precision", "rounding"),
];

/// The imperfection to reduce first, and the budget of the reader's loop.
fn actions(record: &Record, page: &mut Page) {
    page.action(
        "Rank the imperfections of your loop by their share of its budget: `libration advise --config loop.toml --verbose`.",
    );
    // The distance after the longest run.
    let distance = |name: &str| {
        let prefix = format!("hierarchy.robot.{name}.");
        let runs = record.findings.iter().filter_map(|f| {
            let steps: u64 = f.id.strip_prefix(&prefix)?.parse().ok()?;
            Some((steps, f.measured))
        });
        runs.max_by_key(|(steps, _)| *steps)
    };
    let found = IMPERFECTIONS.iter().filter_map(|(name, words)| Some((words, distance(name)?)));
    if let Some((words, (steps, _))) = found.max_by(|a, b| a.1.1.total_cmp(&b.1.1)) {
        page.action(format!(
            "Reduce {words} first in a loop with the typical sizes of a robot: it displaces orbits most after {} steps.",
            count(steps)
        ));
    }
}
