//! The chapter on the hierarchy.

use libration_report::page::Page;
use libration_report::record::{Record, RecordError};

use super::figures;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Hierarchy".into();
    page.answer = "None as such: each has its own law, and the sizes and the horizon decide. A late force grows \
                   exponentially, clocks of different rates part like n, jitter like √n, and rounding is last \
                   only where its unit is small."
        .into();
    page.paragraph(
        "The metric is the distance of a disturbed trajectory from the undisturbed one after the same number \
         of steps, in the norm of the energy and in units of the orbit, as the root mean square over 128 \
         starts all around it; under symplectic Euler, at the angle of 0.0316 rad a step that the source has \
         at Δt = 10 ms. Compared are equal sizes (a part of a step, or a unit roundoff) and two choices \
         that a robot might meet.",
    );
    page.paragraph(
        "The profile has, for each imperfection alone: the steps until trajectories are a tenth of the orbit apart; the rms \
         of ln E/E₀ at the end, of the energy that undisturbed steps conserve; by how much a loop with the gains (10, 2) on \
         the same spring costs more under white noise, ΔJ/J₀, where the cost J is its mean energy and J₀ that of the ideal \
         loop; and how much of the size at which this loop becomes unstable is used. Asynchrony changes no energy and \
         uses hardly any margin, and yet takes trajectories apart sooner than jitter of the same size.",
    );
    page.table(record.table("profile")?, 3);
    page.figure(figures::short(record)?.number("9.16"));
    page.figure(figures::long(record)?.number("9.17"));
    page.paragraph(
        "Predictions: with the force late the orbit grows by the spectral radius of the loop that the spring \
         is; a clock’s error turns the orbit by dθ/dΔt times the error of its time, which adds up in n steps \
         to n times one error, or √n times the rms of independent ones. What rounding does to the phase \
         depends on how parameters round, and is measured.",
    );
    page.table(record.table("divergence")?, 3);
    Ok(())
}
