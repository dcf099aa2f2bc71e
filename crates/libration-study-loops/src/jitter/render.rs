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
        "Each step of a symplectic method preserves an ellipse, which depends on the length of the step. Random lengths \
         change the energy: ln E performs a random walk, with mean 2γn and standard deviation 2√(γn) after n \
         steps. The Lyapunov exponent γ comes from the transfer operator on directions. For weak jitter it is \
         ½a²σ², with the coupling a = z²/2 for symplectic Euler and z³/4 for velocity Verlet. The standard deviation \
         becomes visible long before the mean.",
    );
    page.figure(figures::energies(record)?);
    page.table(record.table("energy under jitter")?, 3);
    page.note(
        "Steps of RK4 and exact steps are functions of one matrix, so they commute and have no such instability: jitter \
         does not change their energy loss.",
    );
    page.heading("Phase");
    page.paragraph(
        "A longer step rotates further. Relative to nominal time the phase performs a random walk of zσ√n; relative to the \
         elapsed time only the effect of the ellipses remains.",
    );
    page.figure(figures::phases(record)?);
    page.table(record.table("phases under jitter")?, 3);
    page.heading("Second moments");
    page.paragraph(
        "The matrix E[M⊗M] maps second moments from step to step exactly; its entries are moments of the distribution of \
         the steps. Second moments grow faster than a typical run, by 4γ per step, since a few trajectories dominate them.",
    );
    page.table(record.table("second moments")?, 4);
    page.heading("Spectrum of the clock");
    page.paragraph(
        "Only the spectrum S of the step times at twice the angle θ of a step matters: γ = ½a²S(2θ). Clock errors \
         that alternate, or oscillate with half the period of the oscillator, cause much faster growth than white ones with \
         the same σ.",
    );
    page.figure(figures::memory(record)?);
    page.figure(figures::resonance(record)?);
    page.heading("Worst order of steps");
    page.paragraph(
        "Stability with each of two step lengths does not imply stability with a mixture of both. The search covers all orders of \
         up to twelve steps; the norm of all products is an upper bound for any order.",
    );
    page.figure(figures::switching(record)?);
    page.heading("Maps");
    page.figure(maps::maps(record)?);
    actions(record, page);
    host::render(record, page)
}

/// How to measure jitter, and what to include in the budget of a loop.
fn actions(record: &Record, page: &mut Page) {
    let found = |id: &str| record.finding(id).ok().map(|f| f.measured);
    page.action(
        "Measure the jitter of a loop on your machine: `libration measure-jitter --rate 500`.",
    );
    if let Some(times) = found("jitter.resonance.beside-white").filter(|times| *times > 1.0) {
        page.action(format!(
            "Search a log for periodic clock errors with `libration clock LOG`. In resonance they act {} times as strongly as white ones.",
            number(times, 2)
        ));
    }
    if found("jitter.switching.worst").is_some_and(|worst| worst > 0.0) {
        page.action(
            "Include missed ticks in the budget of your loop: `libration advise --config loop.toml --loss 0.01`.",
        );
    }
}

fn summary(record: &Record, page: &mut Page) {
    let found = |id: &str| record.finding(id).ok().map(|f| f.measured);
    let grown = found("jitter.velocity-verlet.dt-0.3.rms-0.1.mean");
    let still = found("jitter.velocity-verlet.dt-0.001.rms-0.1.bounded");
    if let Some((grown, still)) = grown.zip(still) {
        page.answer = format!(
            "With jitter the energy of a symplectic method performs a random walk that turns into exponential growth: with 10 % \
             Gaussian jitter ln E of velocity Verlet grows by {} at Δt = 0.3 s, and stays within {} at 1 ms. The energy is \
             bounded while the number of steps is small compared with 1/γ.",
            number(grown, 3),
            number(still, 2)
        );
        page.headline =
            "Jitter increases the energy of symplectic methods; the rate is small at small time steps.".into();
        if grown.exp().is_finite() {
            page.highlights.push(Highlight {
                value: format!("{}×", number(grown.exp(), 2)),
                text: "initial energy at the end, velocity Verlet with 10 % jitter at Δt = 0.3 s"
                    .into(),
            });
        }
    }
    if let Some(times) = found("jitter.resonance.beside-white") {
        page.highlights.push(Highlight {
            value: format!("{}×", number(times, 2)),
            text: "faster growth with clock errors at twice the angle of a step".into(),
        });
    }
    if let Some(worst) = found("jitter.switching.worst") {
        page.highlights.push(Highlight {
            value: format!("{} %", number(100.0 * worst.exp_m1(), 3)),
            text:
                "growth per step of a damped loop that misses some ticks, though stable with all and with none missed"
                    .into(),
        });
    }
}
