//! Tests of advice as a page and as JSON.

use libration_advise as advise;

use super::requests::advice;

const ASKED: &str = "
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
