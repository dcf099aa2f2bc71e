//! The chapter on rollouts.

use libration_report::notation::number;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError};

use super::{figures, summary};
use crate::bit_comparison;
use crate::source_rollouts::EXAMPLES;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Rollouts".into();
    answer(record, page);
    page.paragraph(
        "A rollout has the observations, actions and rewards of environments over a horizon: 17 bytes per transition of the \
         oscillator of the source. Its actions come from a linear policy. The reference is a fill: \
         a loop that writes the same memory in the same way without computing. Rates are medians of rounds in which \
         the measurements alternate.",
    );
    page.figure(figures::summary(record)?.number("9.11"));
    page.table(record.table(summary::NAME)?, 3);
    page.figure(figures::scaling(record)?.number("9.9"));
    page.heading("Limits of a rollout");
    page.paragraph(
        "The source reports that large rollouts are limited by memory. In its table, however, the time per transition falls \
         with the number of environments. That indicates a fixed cost per step, as of a Python loop, which more environments \
         share: a step then takes a + b·N. The four times of the table do not lie on such a line \
         either.",
    );
    page.figure(figures::steps(record)?);
    page.table(record.table("steps of table 9.11")?, 3);
    page.paragraph(
        "The regimes follow from the measured curves. If more environments or steps reach twice the rate, fixed costs \
         dominate. Beyond that, rates within a factor of 1.3 form a plateau; it is limited by stores if the \
         rate is at least three quarters of a fill.",
    );
    page.table(record.table("regimes")?, 3);
    page.heading("Layouts and stores");
    page.paragraph(
        "The structure of arrays of the source is in fact an array of structures: position and \
         velocity of an environment are adjacent. If the rollout exceeds the caches, non-temporal \
         stores, past the caches, avoid the read of each line before it is overwritten; if it \
         fits, they may be slower. Rates are in millions of transitions per second and relative to \
         a fill that writes in the same way.",
    );
    page.table(record.table("layouts")?, 3);
    let missing = record.table("not timed")?;
    if !missing.rows.is_empty() {
        page.paragraph("Not measured:");
        page.table(missing, 3);
    }
    page.paragraph(
        "New tensors cause a page fault for every page. Reused tensors cause page faults only in \
         the first rollout.",
    );
    page.table(record.table("fresh and used tensors")?, 3);
    page.paragraph(
        "Generalised advantage estimation (GAE) and returns read a rollout from its last step to \
         the first.",
    );
    page.table(record.table("advantages")?, 3);
    if let Ok(peers) = record.table("peers") {
        page.heading("Peers");
        page.paragraph(
            "The same transitions in NumPy with preallocated outputs, in numba on the same number of threads, in a loop \
             in C on one core, and CartPole of PufferLib compared with a pendulum swing-up. `benches/rollouts.py` \
             measures them alternately, each in its fastest variant.",
        );
        page.table(peers, 3);
    }
    page.heading("Bits");
    page.paragraph(
        "The environments have random starts, a time limit, latencies of observations and actions, jitter and skew, noise and \
         a random spring in each episode, with a random policy. A hash covers all observations, actions and rewards of an \
         environment. Environment 7 has the same hash among 77 and among 3000.",
    );
    page.table(bit_comparison::table(record)?, 4);
    page.action(
        "Measure your number of environments and your horizon: `libration bench --rollouts --case 4096x1024`.",
    );
    page.action("Reuse the tensors of a rollout: new ones cause a page fault for every page.");
    Ok(())
}

/// The rate of the source's example, its share of a fill, and what the bits depend on.
fn answer(record: &Record, page: &mut Page) {
    let [example, _] = EXAMPLES;
    let value = |id: String| record.finding(&id).ok().map(|f| f.measured);
    let mut sentences = Vec::new();
    if let Some(rate) = value(format!("rollout.rate.{}", example.name())) {
        let rate = format!("{}·10⁶", number(rate / 1e6, 3));
        let all = value(format!("rollout.rate.{}.threads", example.name()));
        let all = all.map(|all| format!(", all cores {}·10⁶", number(all / 1e6, 3)));
        let share = value(format!("rollout.{}", example.name()));
        let share = share.map(|share| {
            format!(
                " One core reaches {} % of the rate at which a loop fills the same memory.",
                number(100.0 * share, 2)
            )
        });
        sentences.push(format!(
            "{}: {rate} transitions per second on one core{}.{}",
            example.title(),
            all.unwrap_or_default(),
            share.unwrap_or_default()
        ));
        page.highlights.push(Highlight {
            value: rate,
            text: format!("transitions per second on one core, {}", example.title()),
        });
    }
    let kept = record.findings.iter().filter(|f| f.id.starts_with("rollout.kept."));
    let (all, held) = kept.fold((0, 0), |(all, held), f| (all + 1, held + usize::from(f.agrees())));
    sentences.push(format!(
        "The bits depend on the number of the environment, the seed and the policy: {held} of {all} other changes preserve all bits."
    ));
    page.answer = sentences.join(" ");
}
