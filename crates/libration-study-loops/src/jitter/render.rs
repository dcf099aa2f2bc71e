//! The chapter on jitter.

use libration_report::notation::number;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError};

use super::{figures, host, maps};

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Uneven clocks".into();
    summary(record, page);
    page.paragraph(
        "Each step of a symplectic method keeps an ellipse, and one of another length keeps another. To change at \
         random between them pumps: ln E takes a random walk, with mean 2γn and standard deviation 2√(γn) after n \
         steps. γ, the Lyapunov exponent, comes from the transfer operator on directions; for weak jitter it is \
         ½a²σ², with the coupling a that is z²/2 of symplectic Euler and z³/4 of velocity Verlet. Long before the mean \
         shows, the deviation does.",
    );
    page.figure(figures::energies(record)?);
    page.table(record.table("energy under jitter")?, 3);
    page.note(
        "Steps that are functions of one matrix commute and have no such instability: RK4 and exact steps lose nothing \
         to jitter but what they would lose anyway.",
    );
    page.heading("Phase");
    page.paragraph(
        "A step that is longer turns further. Against nominal time the phase takes a random walk of zσ√n; against the \
         time that has passed there is left only what the ellipses do.",
    );
    page.figure(figures::phases(record)?);
    page.table(record.table("phases under jitter")?, 3);
    page.heading("Second moments");
    page.paragraph(
        "Second moments are carried from step to step by E[M⊗M], which is exact: its entries are moments of the law of \
         the steps. They grow faster than the typical run, by 4γ a step, since a few trajectories carry them.",
    );
    page.table(record.table("second moments")?, 4);
    page.heading("The spectrum of the clock");
    page.paragraph(
        "Of the spectrum S of the step times only what has twice the angle θ of a step counts: γ = ½a²S(2θ). A clock \
         whose errors alternate, or swing with half the period of the oscillation, is worse by far than a white one of \
         the same σ.",
    );
    page.figure(figures::memory(record)?);
    page.figure(figures::resonance(record)?);
    page.heading("The worst order of steps");
    page.paragraph(
        "Stability at each of two step lengths does not mean stability under both. The search goes through all orders of \
         up to twelve steps; the norm of all products bounds any order from above.",
    );
    page.figure(figures::switching(record)?);
    page.heading("Maps");
    page.figure(maps::maps(record)?);
    host::render(record, page)
}

fn summary(record: &Record, page: &mut Page) {
    let found = |id: &str| record.finding(id).ok().map(|f| f.measured);
    let grown = found("jitter.velocity-verlet.dt-0.3.rms-0.1.mean");
    let still = found("jitter.velocity-verlet.dt-0.001.rms-0.1.bounded");
    if let Some((grown, still)) = grown.zip(still) {
        page.answer = format!(
            "It lets the energy of a symplectic method take a random walk that turns into exponential growth: under 10 % \
             of Gaussian jitter ln E of velocity Verlet grows by {} at Δt = 0.3 s, and stays within {} at 1 ms. Energy is \
             bounded as long as the number of steps is small beside 1/γ.",
            number(grown, 3),
            number(still, 2)
        );
        page.headline =
            "Jitter pumps energy into symplectic methods, slowly at small steps.".into();
        if grown.exp().is_finite() {
            page.highlights.push(Highlight {
                value: format!("{}×", number(grown.exp(), 2)),
                text: "the energy it began with, of velocity Verlet under jitter of 10 % at Δt = 0.3 s"
                    .into(),
            });
        }
    }
    if let Some(times) = found("jitter.resonance.beside-white") {
        page.highlights.push(Highlight {
            value: format!("{}×", number(times, 2)),
            text: "faster growth where the clock swings at twice the angle of a step".into(),
        });
    }
    if let Some(worst) = found("jitter.switching.worst") {
        page.highlights.push(Highlight {
            value: format!("{} %", number(100.0 * worst.exp_m1(), 3)),
            text:
                "growth a step of a damped loop that misses ticks, though stable with and without"
                    .into(),
        });
    }
}
