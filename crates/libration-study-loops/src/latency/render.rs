//! The chapter on latency.

use libration_report::notation::{number, seconds};
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError};

use super::figures;
use super::map::Kind;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Latency".into();
    let verlet = record.finding("latency.onset.velocity-verlet")?;
    let critical = verlet.measured * super::onset::DT;
    page.answer = format!(
        "The loop with ω² = 10 s⁻² and K = (10, 2) begins to grow when its command is {} late, as its delay margin \
         says, less half a step that the integrator hides; nothing has to be simulated to know it. A force that is \
         itself late makes an undamped orbit grow at once, by ½z²d a step.",
        seconds(critical, 4)
    );
    page.highlights.push(Highlight {
        value: format!("{} steps", number(verlet.measured, 6)),
        text: format!(
            "of 10 ms may a command be late under velocity Verlet; theory says {}",
            number(verlet.predicted.unwrap_or(f64::NAN), 6)
        ),
    });
    page.paragraph(
        "Where the force itself is late, the plant is what is left without it: something that moves freely under a \
         command. The spectral radius of that step with its latency says how the amplitude grows. It is measured \
         from the area between neighbouring states, which does not swing as the orbit does.",
    );
    page.figure(figures::short(record)?);
    page.figure(figures::long(record)?);
    page.table(record.table("late forces")?, 6);
    page.paragraph(
        "A loop with damping bears some latency. How much follows from the characteristic polynomial of the \
         shipped step, and was found again by bisection on simulated loops, with steps that split where the command \
         arrives. In the limit of small steps it is the delay margin of the continuous loop. Integrator and hold \
         take a part of it: the hidden latency.",
    );
    page.table(record.table("critical latencies")?, 8);
    page.table(record.table("hidden latency")?, 6);
    page.heading("Stable again");
    page.figure(figures::windows(record)?);
    page.table(record.table("latency windows")?, 7);
    page.heading("Maps of stability");
    for kind in Kind::ALL {
        page.figure(figures::map(record, kind)?);
    }
    page.heading("Latency that changes from step to step");
    page.paragraph(
        "With latencies that are drawn from a table, second moments follow a linear map, and the loop is stable in \
         the mean square where its spectral radius is below one. The same two latencies, equally probable, leave \
         the loop stable where they are drawn independently, and not where they stay for a while: a histogram of \
         latencies decides nothing.",
    );
    page.table(record.table("random latency")?, 8);
    Ok(())
}
