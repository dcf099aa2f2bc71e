//! Pages beside their verdicts.

use libration_advise as advise;
use libration_advise::Doubt;
use libration_advise::linear::{self, LinearAdvice};
use libration_report::verdict::{Outcome, Verdict};

use super::page::{ASKED, DECAYING, linear_advice, section};
use super::requests::advice;

/// An undamped oscillator, `q'' = −10 q + u`, whose position the command follows.
const OSCILLATING: &str = "
[system.linear]
a = [[0.0, 1.0], [-10.0, 0.0]]
b = [[0.0], [1.0]]
states = [\"q\", \"v\"]
inputs = [\"u\"]
[controller.state-feedback]
gain = [[2.0, 0.0]]
[loop]
period = 0.01
";

#[test]
fn a_loop_in_a_stability_window_has_the_growth_of_its_own_latency_in_table_and_json() {
    let found = linear_advice(&format!("{OSCILLATING}latency = 1.3\n"));
    assert_eq!(found.verdict.outcome, Outcome::Stable, "{}", found.answer);
    // s² + 10 + 2 exp(−s τ) = 0 by fixed-point steps, which shrink by τ/|s|, about 0.4. A held command is late by half a period more.
    let (mut re, mut im, late) = (0.0_f64, 3.0_f64, 1.3 + 0.005);
    for _ in 0..60 {
        let size = 2.0 * (-re * late).exp();
        let square = [-10.0 - size * (im * late).cos(), size * (im * late).sin()];
        let angle = square[1].atan2(square[0]).rem_euclid(core::f64::consts::TAU) / 2.0;
        let root = square[0].hypot(square[1]).sqrt();
        (re, im) = (root * angle.cos(), root * angle.sin());
    }
    let wanted = 2.0 * re * 0.01;
    // Beside its delay a hold lowers the gain by (ωT)²/24, about 4·10⁻⁵.
    assert!((found.growth / wanted - 1.0).abs() < 1e-3, "{} {wanted}", found.growth);
    let page = linear::page(&found);
    let combined = section(&page, "All imperfections together");
    assert!(combined.contains(">−0.00438") && combined.contains(">not searched<"), "{combined}");
    assert!(page.contains("<h1>The loop is stable, but only in a stability window</h1>"));
    // A tolerance of the cost relates to a loop without imperfections, which has none here.
    let tolerant = format!("{OSCILLATING}latency = 1.3\n[tolerance]\ncost = 0.5\n");
    let not_examined = linear_advice(&tolerant).verdict.not_examined.join(", ");
    assert!(not_examined.contains("the tolerance of the cost"), "{not_examined}");
    // The engine of a page refuses such a latency.
    assert!(!page.contains(LIVE) && page.contains("expected at most 64 periods, 0.64 s"));
    // Without the latency the loop is unstable, and the table says of which loop it is.
    let page = linear::page(&linear_advice(OSCILLATING));
    let combined = section(&page, "The loop without imperfections");
    assert!(combined.contains("growth of second") && !combined.contains("cost"), "{combined}");
    assert!(page.contains(LIVE) && !page.contains("All imperfections together"));
}

/// The begin of a live section.
const LIVE: &str = "<section id=\"live\"";

#[test]
fn a_page_with_an_unknown_verdict_has_no_live_section_which_has_a_verdict_of_its_own() {
    let mut found = linear_advice(&format!("{DECAYING}latency = 0.02\n"));
    assert!(linear::page(&found).contains(LIVE));
    found.doubt(Doubt::ChangingLatency);
    let page = linear::page(&found);
    assert!(!page.contains(LIVE) && page.contains("This page has no live section"), "{page}");
    let lead = "<p class=\"lead\">Whether the loop is stable is unknown: the latencies change";
    assert!(page.contains(lead) && found.verdict.outcome == Outcome::Unknown);
    // No clock decides about a loop that is unstable without imperfections.
    let mut unstable = linear_advice(OSCILLATING);
    unstable.doubt(Doubt::OtherClock);
    assert_eq!(unstable.verdict.outcome, Outcome::Unstable);
}

#[test]
fn a_common_factor_without_a_limit_is_at_least_the_largest_that_was_tried() {
    let found = linear_advice(&format!("{DECAYING}latency = 0.02\n"));
    assert_eq!((found.margin, found.margin_tried_up_to), (None, Some(16.0)));
    let factor = |found: &LinearAdvice| {
        let page = linear::page(found);
        let row = page.split("largest common factor of all imperfections").nth(1).unwrap();
        row.split("</tr>").next().unwrap().to_owned()
    };
    assert!(factor(&found).contains(">at least 16<"), "{}", factor(&found));
    let unstable = linear_advice(&format!("{}latency = 0.1\n", DECAYING.replace("0.5", "30.0")));
    assert!(factor(&unstable).contains(">none: the loop is unstable<"), "{}", factor(&unstable));
}

#[test]
fn the_title_of_advice_on_integrators_is_its_verdict() {
    let mut found = advice(&advise::parse(ASKED, "asked.toml").unwrap()).unwrap();
    found.looped = None;
    for (outcome, title) in [
        (Outcome::Within, "s keeps the tolerance</h1>"),
        (Outcome::Exceeds, "<h1>No integrator keeps the tolerance</h1>"),
        (Outcome::Unknown, "<h1>Whether an integrator keeps the tolerance is unknown</h1>"),
    ] {
        found.verdict = Verdict::new(outcome, "");
        let page = advise::page(&found);
        assert!(page.contains(title), "{title}");
        assert_eq!(page.contains(LIVE), outcome != Outcome::Unknown, "{title}");
    }
}
