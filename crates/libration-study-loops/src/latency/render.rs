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
    let critical = verlet.measured * super::critical_latency::DT;
    page.answer = format!(
        "Critical latency of the loop with ω² = 10 s⁻² and K = (10, 2): {}. It is the delay margin \
         of the continuous loop minus the latency of the integrator, half a step, and follows \
         without simulation. A force with latency makes an undamped orbit grow at any latency, by \
         ½z²d per step for a latency of d steps.",
        seconds(critical, 4)
    );
    page.highlights.push(Highlight {
        value: format!("{} steps", number(verlet.measured, 6)),
        text: format!(
            "critical latency at steps of 10 ms with velocity Verlet; theory: {}",
            number(verlet.predicted.unwrap_or(f64::NAN), 6)
        ),
    });
    page.paragraph(
        "If the force itself has a latency, the plant is a free mass and the force is its command. The spectral \
         radius of this step with its latency is the growth of the amplitude per step. It is measured \
         from the area between neighbouring states, which does not oscillate with the orbit.",
    );
    page.figure(figures::short(record)?);
    page.figure(figures::long(record)?);
    page.table(record.table("late forces")?, 6);
    page.paragraph(
        "A loop with damping is stable up to a critical latency. It follows from the \
         characteristic polynomial of the shipped step, and bisection on simulated loops confirms \
         it; there a step is split at the arrival of a command. In the limit of small steps it is \
         the delay margin of the continuous loop. The integrator and the zero-order hold add \
         latency of their own, the hidden latency, and reduce the critical latency by it.",
    );
    page.table(record.table("critical latencies")?, 8);
    page.table(record.table("hidden latency")?, 6);
    page.heading("Windows of stability above the critical latency");
    page.figure(figures::windows(record)?);
    page.table(record.table("latency windows")?, 7);
    page.heading("Maps of stability");
    for kind in Kind::ALL {
        page.figure(figures::map(record, kind)?);
    }
    page.heading("Random latency");
    page.paragraph(
        "With latencies drawn from a table, second moments follow a linear map, and the loop is stable in \
         the mean square if the spectral radius of this map is below one. With two equally probable latencies \
         the loop is stable for independent draws, and unstable if each latency persists for some time. The histogram of \
         latencies alone therefore does not determine stability.",
    );
    page.table(record.table("random latency")?, 8);
    page.action(
        "Measure the dead time of your loop from a log: `libration identify LOG --command cmd --response q`.",
    );
    page.action(
        "Compute the critical latency of your loop: `libration advise --config loop.toml --latency 15ms`. \
         `libration advise --print-config > loop.toml` writes a file to edit.",
    );
    let radius = |hold: &str| {
        let id = format!("latency.random.velocity-verlet.hold-{hold}.radius");
        record.finding(&id).ok().map(|f| f.measured)
    };
    if let (Some(independent), Some(persistent)) = (radius("0"), radius("0.5"))
        && independent < 1.0
        && persistent > 1.0
    {
        page.action(
            "Record the sequence of latencies: their histogram does not determine stability.",
        );
    }
    Ok(())
}
