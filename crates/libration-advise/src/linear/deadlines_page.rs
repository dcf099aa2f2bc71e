//! The section of a page about missed deadlines.

use libration_report::page::Page;
use libration_report::record::{Cell, Table};

use super::{LinearAdvice, RandomMisses, WorstCase};
use crate::first_screen::cut;

/// Appends the section; nothing if the request states no missed deadlines.
pub(super) fn deadlines(page: &mut Page, advice: &LinearAdvice) {
    let Some(misses) = &advice.deadline_misses else { return };
    page.heading("Which missed deadlines does the loop endure?");
    let job = match misses.overrun {
        "kill" => "A job that overruns its period is killed",
        "skip" => "A job that overruns its period goes on, and the next begins when it is finished",
        _ => "A job that overruns its period goes on, and the latest job waits for it",
    };
    let acts = match misses.missing {
        "zero" => "zero acts",
        _ => "the command that acts already stays",
    };
    page.paragraph(format!(
        "{job}. Where a period sends no commands, {acts}. With the stated latencies and skew."
    ));
    if let Some(worst) = &misses.worst_case {
        worst_case(page, worst);
    }
    if let Some(random) = &misses.random {
        random_overruns(page, random, advice.ideal_cost);
    }
}

fn worst_case(page: &mut Page, WorstCase { stated, tried, .. }: &WorstCase) {
    page.paragraph(format!(
        "The growth per period is that of the worst of all sequences with so many misses in any {} consecutive deadlines, without jitter \
         and losses: it is between the bounds. Below 1 all motions decay in every sequence. The lower bound is the growth of the \
         sequence in the last column, over and over.",
        stated.window
    ));
    let columns = ["most misses", "verdict", "growth at least", "growth at most", "worst sequence"];
    let mut table = Table::new("deadline-misses", &columns);
    for row in tried {
        let mark = if row.misses == stated.misses { " (stated)" } else { "" };
        table.push([
            format!("{} of {}{mark}", row.misses, row.window).into(),
            row.verdict.into(),
            Cell::rounded(row.lower, 6),
            Cell::rounded(row.upper, 6),
            row.sequence_text().into(),
        ]);
    }
    page.table(&table, 6);
}

fn random_overruns(page: &mut Page, random: &RandomMisses, ideal_cost: f64) {
    let mut table = Table::new("random-overruns", &["quantity", "value", "method"]);
    let how = "exact: second moments of the jump system";
    let limit = random.stable_up_to.map_or_else(|| Cell::absent("above 63/64"), |x| cut(x).into());
    let cost = random.cost.map_or_else(|| Cell::absent("infinite"), |x| Cell::rounded(x, 6));
    for (what, value, how) in [
        ("probability that a job overruns", Cell::rounded(random.probability, 4), "stated"),
        ("growth of second moments per period", Cell::rounded(random.growth.exp_m1(), 4), how),
        ("stable up to the probability", limit, "64ths, then bisection"),
        ("cost", cost, how),
        ("cost of the ideal loop", Cell::rounded(ideal_cost, 6), "exact: Lyapunov equation"),
    ] {
        table.push([what.into(), value, how.into()]);
    }
    page.table(&table, 4);
}
