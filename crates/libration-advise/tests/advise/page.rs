//! Tests of advice as a page and as JSON.

use std::sync::LazyLock;

use libration_advise as advise;
use libration_advise::Imperfection;
use libration_advise::linear::{self, LinearAdvice};

use super::requests::{advice, with_work};

pub(crate) const ASKED: &str = "
[controller.pd]
position = 10.0
velocity = 2.0
[loop]
period = 0.02
latency = 0.03
[tolerance]
cost = 0.5
[request]
horizon = 2.0
rollout = [64, 64]
";

#[test]
fn the_page_says_its_answer_first_and_marks_where_the_loop_stands() {
    let mut request = advise::parse(ASKED, "asked.toml").unwrap();
    request.map = true;
    let found = advice(&request).unwrap();
    let page = advise::page(&found);
    let first =
        page.find("<p class=\"lead\">The loop is stable with the stated imperfections").unwrap();
    assert!(first < page.find("<table>").unwrap());
    for wanted in ["edge of stability", "as stated", "libration analyze --system oscillator"] {
        assert!(page.contains(wanted), "{wanted}");
    }
}

#[test]
fn a_tolerated_cost_ends_a_budget_before_stability_does() {
    let found = advice(&advise::parse(ASKED, "asked.toml").unwrap()).unwrap();
    let json = serde_json::to_value(&found).unwrap();
    let latency = &json["loop"]["budgets"][0];
    assert_eq!(latency["kind"], "latency");
    let [tolerated, stable, used] =
        ["tolerated_up_to", "stable_up_to", "used"].map(|key| latency[key].as_f64().unwrap());
    assert!(tolerated < stable && (used - 0.03 / tolerated).abs() < 1e-12, "{latency}");
    // At that latency the cost has risen by just so much.
    let again = ASKED.replace("latency = 0.03", &format!("latency = {tolerated}"));
    let at = advice(&advise::parse(&again, "again.toml").unwrap()).unwrap();
    let rise = at.looped.unwrap().combined.cost_increase.unwrap();
    assert!((rise - 0.5).abs() < 1e-9, "{rise}");
}

/// The advice on an example that several tests look at.
static TWO_MASS_DRIVE: LazyLock<LinearAdvice> =
    LazyLock::new(|| linear_advice(&example("two_mass_drive.toml")));

pub(crate) fn linear_advice(text: &str) -> LinearAdvice {
    let request = linear::parse(text, "loop.toml").unwrap();
    with_work(|work| linear::advise(work, &request)).unwrap()
}

/// A page from the heading to the next one.
pub(crate) fn section<'a>(page: &'a str, heading: &str) -> &'a str {
    let rest = page.split(&format!("\">{heading}</h3>")).nth(1);
    rest.unwrap_or_else(|| panic!("no {heading}"))
        .split("<h3 ")
        .next()
        .unwrap()
        .split("</main>")
        .next()
        .unwrap()
}

fn example(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/loops/");
    std::fs::read_to_string(format!("{folder}{name}")).unwrap()
}

/// A loop of one state that decays without commands.
pub(crate) const DECAYING: &str = "
[system.linear]
a = [[-1.0]]
b = [[1.0]]
states = [\"level (m)\"]
inputs = [\"flow (m/s)\"]
[controller.state-feedback]
gain = [[0.5]]
[loop]
period = 0.01
";

#[test]
fn the_first_screen_shows_what_is_used_and_says_what_to_do() {
    let text = DECAYING.replace("0.5", "30.0");
    let page_of = |latency: &str| {
        let found = linear_advice(&format!("{text}latency = {latency}\n"));
        let page = linear::page(&found);
        let [first, _] = page.split_once("<h2 id=\"live\">").map_or([&*page; 2], |(a, b)| [a, b]);
        (first.to_owned(), found)
    };
    let (stable, found) = page_of("0.02");
    assert!(stable.contains("simulated cost") && stable.contains("phase margin at flow"));
    let limit = found.budgets[0].stable_up_to.unwrap();
    let part = format!("width:{:.1}%", 100.0 * 0.02 / limit);
    assert!(stable.contains(&part) && !stable.contains("class=\"over\""), "{part}: {stable}");
    assert!(stable.contains("must stay below 0.0"), "{stable}");
    let (unstable, found) = page_of("0.1");
    let latency = found.remedies.unwrap().latency.unwrap();
    // Cut off, not rounded: the shown latency makes the loop stable.
    let shown = unstable.split("a latency of at most ").nth(1).unwrap().split(' ').next().unwrap();
    let shown: f64 = shown.parse().unwrap();
    assert!(shown <= latency && shown > 0.999 * latency, "{shown} of {latency}");
    assert!(unstable.contains("class=\"over\"") && unstable.contains("--redesign"), "{unstable}");
}

#[test]
fn a_remedy_without_missed_deadlines_is_no_advice_beside_them() {
    let text = example("furuta_pendulum.toml");
    let late = text.replacen("latency = 0.01", "latency = 0.03", 1);
    assert_ne!(text, late);
    let found = linear_advice(&late);
    assert!(found.remedies.is_some() && found.deadline_misses.is_some());
    let page = linear::page(&found);
    assert!(!page.contains("<li>Take ") && page.contains("<li>Add "), "{page}");
}

#[test]
fn an_unstable_loop_has_infinite_deviations_beside_its_infinite_cost() {
    // With a gain of 30 the loop endures about (π/2)/30 s of latency.
    let text = DECAYING.replace("0.5", "30.0");
    let late = linear_advice(&format!("{text}latency = 0.1\n"));
    assert!(late.growth > 0.0);
    let page = linear::page(&late);
    let deviations = section(&page, "Deviations under noise");
    assert!(deviations.contains(">infinite<") && !deviations.contains("unknown"), "{deviations}");
    assert!(section(&page, "All imperfections together").contains(">infinite<"));
    let even = linear::page(&linear_advice(&text));
    assert!(!section(&even, "Deviations under noise").contains("infinite"));
}

#[test]
fn a_growth_rate_within_rounding_is_zero_on_the_page_and_keeps_its_digits_in_json() {
    let found = &*TWO_MASS_DRIVE;
    let json = serde_json::to_value(found).unwrap();
    let free = json["plant_modes"][0]["growth_rate"].as_f64().unwrap();
    // n ε ‖A‖ with a norm of 3004 1/s².
    assert!(free != 0.0 && free.abs() < 4.0 * f64::EPSILON * 3004.0, "{free}");
    assert_eq!(found.plant_modes[0].shown, [0.0; 2]);
    let page = linear::page(found);
    let plant = section(&page, "The plant");
    assert!(!plant.contains("10<sup>") && plant.contains(">0<"), "{plant}");
    // The other rates stay.
    assert!(plant.contains(">−0.3334<") && plant.contains(">−2500<"), "{plant}");
}

#[test]
fn modes_of_the_plant_and_of_its_lags_and_filters_have_names_of_their_own() {
    let found = linear_advice(&example("quadrotor_attitude.toml"));
    let page = linear::page(&found);
    let plant = section(&page, "The plant");
    for name in ["roll", "roll rate", "rotors", "gyroscope filter, gyroscope filter (rate)"] {
        assert_eq!(
            plant.matches(&format!("<td class=\"prose\">{name}<")).count(),
            1,
            "{name}: {plant}"
        );
    }
    // Butterworth: 30 Hz at a damping ratio of 1/√2.
    let filter = found.part_modes.last().unwrap();
    assert!((filter.frequency - 30.0 * 0.5_f64.sqrt()).abs() < 1e-9, "{filter:?}");
    let count = |mode: &linear::Mode| if mode.frequency > 0.0 { 2 } else { 1 };
    let all = found.plant_modes.iter().chain(&found.part_modes).map(count).sum::<usize>();
    assert_eq!(all, found.states.len());
}

#[test]
fn a_missing_phase_or_share_has_its_reason_below_the_table() {
    let found = &*TWO_MASS_DRIVE;
    for link in &found.chain {
        assert_eq!(link.note.is_some(), link.phase.is_none() || link.share.is_none(), "{link:?}");
    }
    let page = linear::page(found);
    let chain = section(&page, "Where does the latency come from?");
    assert!(
        chain.contains("load angle: no phase and no share, because no limit was found"),
        "{chain}"
    );
}

#[test]
fn a_loop_that_endures_all_losses_says_so_and_one_that_does_not_names_them_in_the_singular() {
    let found = linear_advice(DECAYING);
    let losses = found.budgets.iter().find(|budget| budget.kind == Imperfection::Loss).unwrap();
    assert_eq!(losses.limit_in_words(losses.stable_up_to), "any below 1");
    assert!(
        section(&linear::page(&found), "Budget of each imperfection").contains(">any below 1<")
    );
    // An integrator that grows without commands.
    let text = DECAYING.replace("[[-1.0]]", "[[5.0]]").replace("0.5", "30.0");
    let found = linear_advice(&format!("{text}loss = 0.1\n"));
    assert!(found.answer.contains("Loss of commands fails first, with"), "{}", found.answer);
}

#[test]
fn feedback_of_states_says_that_it_does_not_measure_the_outputs_of_the_plant() {
    let lqr = DECAYING.replace(
        "[controller.state-feedback]\ngain = [[0.5]]",
        "[controller.lqr]\nstates = [1]\ninputs = [1]",
    );
    assert_eq!(linear_advice(&lqr).controller, "LQR, designed");
    for own in ["c = [[2.0]]", "c = [[1.0]]\nd = [[0.1]]"] {
        let text = lqr.replace("b = ", &format!("{own}\nb = "));
        assert_eq!(
            linear_advice(&text).controller,
            "LQR, designed; it measures the states, not the outputs of the plant"
        );
    }
}
