//! The chapter on rollouts.

use libration_report::notation::number;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError};

use super::{figures, summary};
use crate::changed;
use crate::reported::EXAMPLES;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Rollouts".into();
    answer(record, page);
    page.paragraph(
        "A rollout is what environments saw, did and were paid over a horizon: 17 bytes for each transition of the \
         source’s oscillator. Here its loop is closed by a linear policy. What it is measured against is a fill: \
         a loop that writes as much memory in the same way and computes nothing. Rates are medians of rounds in which \
         all take turns.",
    );
    page.figure(figures::summary(record)?.number("9.11"));
    page.table(record.table(summary::NAME)?, 3);
    page.figure(figures::scaling(record)?.number("9.9"));
    page.heading("What limits a rollout");
    page.paragraph(
        "The source reports that rollouts become bound by memory as they grow. In its own table transitions become \
         cheaper with the number of environments, which a limit of memory does not do: the cost of a step, which a \
         loop in Python pays whatever it does, is shared by more of them. So a step costs a + b·N. The four times of \
         the table lie on no such line either.",
    );
    page.figure(figures::steps(record)?);
    page.table(record.table("steps of table 9.11")?, 3);
    page.paragraph(
        "Here regimes are read off the curves: where more environments or steps reach twice the rate, what is paid once \
         outweighs the rest; beyond, rates within a factor of 1.3 make one plateau, which is bound by stores where the \
         rate comes to three quarters of a fill.",
    );
    page.table(record.table("regimes")?, 3);
    page.heading("Layouts, and ways to write");
    page.paragraph(
        "What the source calls a structure of arrays is an array of structures: position and velocity of an environment \
         lie side by side. Where no cache holds the rollout, stores past the caches save reading each line before it \
         is overwritten; where one does, they may go the longer way. Both are told in millions of transitions a second, and as \
         shares of a fill that writes in the same way.",
    );
    page.table(record.table("layouts")?, 3);
    let missing = record.table("not timed")?;
    if !missing.rows.is_empty() {
        page.paragraph("What was not timed:");
        page.table(missing, 3);
    }
    page.paragraph(
        "Tensors that were never written cost a fault for every page. A rollout that is filled again and again pays \
         that once.",
    );
    page.table(record.table("fresh and used tensors")?, 3);
    page.paragraph("Generalised advantages and returns read what a rollout wrote, from its last step to the first.");
    page.table(record.table("advantages")?, 3);
    if let Ok(peers) = record.table("peers") {
        page.heading("Peers");
        page.paragraph(
            "The same transitions in NumPy with outputs that are there already, in numba on as many threads, in a loop \
             in C on one core, and PufferLib’s CartPole beside a pendulum that swings up; by `benches/rollouts.py`, \
             each in turn and in the fastest of its ways.",
        );
        page.table(peers, 3);
    }
    page.heading("Bits");
    page.paragraph(
        "Environments with random starts, a time limit, late observations and actions, uneven clocks, noise and another \
         spring in each episode, under a policy that explores. Of each a hash is made of all that it saw, did and was \
         paid. What environment 7 does is the same among 77 and among 3000.",
    );
    page.table(changed::table(record)?, 4);
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
            format!(" One core writes {} % as fast as a fill.", number(100.0 * share, 2))
        });
        sentences.push(format!(
            "{}: one core makes {rate} transitions a second{}.{}",
            example.title(),
            all.unwrap_or_default(),
            share.unwrap_or_default()
        ));
        page.highlights.push(Highlight {
            value: rate,
            text: format!("transitions a second on one core, {}", example.title()),
        });
    }
    let kept = record.findings.iter().filter(|f| f.id.starts_with("rollout.kept."));
    let (all, held) = kept.fold((0, 0), |(all, held), f| (all + 1, held + usize::from(f.agrees())));
    sentences.push(format!(
        "Its bits depend on the environment’s number, the seed and the policy: {held} of {all} other changes leave all of them."
    ));
    page.answer = sentences.join(" ");
}
