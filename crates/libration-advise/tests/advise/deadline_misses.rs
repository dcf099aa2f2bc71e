//! Loops that miss deadlines against `tools/deadline_miss_reference.py`, which simulates jobs one by one.

use libration::linear::{
    LoopTiming, MissConstraint, MissingCommand, OverrunStrategy, PeriodOutcome, RandomOverruns,
};
use libration_advise::linear::{self, LinearAdvice};
use serde_json::Value;

use super::linear_reference::{number, read_loop};
use super::requests::with_work;

fn strategy(case: &Value) -> OverrunStrategy {
    match case["strategy"].as_str().unwrap() {
        "kill" => OverrunStrategy::Kill,
        "skip" => OverrunStrategy::Skip,
        _ => OverrunStrategy::Queue,
    }
}

fn count(value: &Value) -> u32 {
    u32::try_from(value.as_u64().unwrap()).unwrap()
}

fn cases() -> Vec<Value> {
    let text = include_str!("../reference/deadline_misses.json");
    let reference: Value = serde_json::from_str(text).unwrap();
    reference["cases"].as_array().unwrap().clone()
}

fn timing(case: &Value) -> LoopTiming {
    let missing = match case["missing"].as_str().unwrap() {
        "zero" => MissingCommand::Zero,
        _ => MissingCommand::Hold,
    };
    LoopTiming { missing, ..super::linear_reference::read_timing(case) }
}

#[test]
fn worst_growth_is_that_of_all_short_sequences_or_of_a_longer_one() {
    let cases = cases();
    assert_eq!(cases.len(), 45);
    let mut same = 0;
    for (i, case) in cases.iter().enumerate() {
        let (linear, timing) = (read_loop(case), timing(case));
        let constraint = MissConstraint::new(count(&case["misses"]), count(&case["window"]));
        let found =
            linear.miss_bounds(&timing, strategy(case), constraint.unwrap(), 0.02, false).unwrap();
        let [lower, upper] = ["lower", "upper"].map(|key| number(&case[key]));
        // Eigenvalues of products of up to 8 matrices of condition 10⁴.
        assert!(found.lower > lower * (1.0 - 1e-9), "{i}: {found:?} {lower}");
        assert!(found.lower < upper * (1.0 + 1e-9), "{i}: {found:?} {upper}");
        assert!(found.upper > lower && found.upper >= found.lower, "{i}: {found:?} {lower}");
        if found.sequence.len() <= 8 {
            same += 1;
            assert!((found.lower / lower - 1.0).abs() < 1e-9, "{i}: {found:?} {lower}");
        }
        let missed = found.sequence.iter().filter(|x| **x != PeriodOutcome::Met).count();
        let most = found.sequence.len() * count(&case["misses"]) as usize;
        assert!(missed * count(&case["window"]) as usize <= most, "{i}: {:?}", found.sequence);
    }
    assert!(same >= 30, "{same}");
}

#[test]
fn second_moments_with_random_overruns_grow_as_those_of_the_jump_system() {
    let mut compared = 0;
    for (i, case) in cases().iter().enumerate().filter(|(_, case)| !case["growth"].is_null()) {
        let probability = number(&case["probability"]);
        let overruns = RandomOverruns { strategy: strategy(case), probability };
        let (linear, timing) = (read_loop(case), timing(case));
        let (found, wanted) =
            (linear.overrun_growth(&timing, overruns).unwrap(), number(&case["growth"]));
        assert!((found - wanted).abs() < 1e-8, "{i}: {found} {wanted}");
        assert_eq!(linear.decays_with_overruns(&timing, overruns).unwrap(), wanted < 0.0, "{i}");
        compared += 1;
    }
    assert_eq!(compared, 15);
}

/// An inverted pendulum whose commands act at the end of a period.
const PENDULUM: &str = "
[system.linear]
a = [[0, 1], [9, 0]]
b = [[0], [1]]
states = [\"angle\", \"rate\"]
[controller.state-feedback]
gain = [[14, 4.5]]
[loop]
period = 0.1
latency = 0.1
";

fn advised(keys: &str) -> LinearAdvice {
    let request = linear::parse(&format!("{PENDULUM}{keys}"), "pendulum.toml").unwrap();
    with_work(|work| linear::advise(work, &request)).unwrap()
}

#[test]
fn advice_has_the_worst_sequence_the_most_stable_misses_and_no_more_than_is_stated() {
    let none = advised("");
    assert!(none.deadline_misses.is_none() && none.holds());
    // All cycles of up to 16 periods in NumPy: with 2 of 5 motions fall to 0.92521276297 per period, with 3 of 5 they grow by
    // 1.01087297799.
    let stable = advised("deadline-misses = \"2 of 5\"");
    assert!(stable.holds(), "{}", stable.answer);
    let words = "With at most 2 of any 5 deadlines missed (kill, hold) it is stable";
    assert!(stable.answer.contains(words), "{}", stable.answer);
    let worst = stable.deadline_misses.unwrap().worst_case.unwrap();
    assert!((worst.stated.lower - 0.925_212_762_97).abs() < 1e-10, "{:?}", worst.stated);
    let unstable = advised("deadline-misses = \"3 of 5\"");
    assert!(!unstable.holds() && unstable.growth < 0.0);
    let words = "With at most 3 of any 5 deadlines missed (kill, hold) the loop is unstable";
    assert!(unstable.answer.starts_with(words), "{}", unstable.answer);
    let worst = unstable.deadline_misses.unwrap().worst_case.unwrap();
    assert!((worst.stated.lower - 1.010_872_977_99).abs() < 1e-10, "{:?}", worst.stated);
    assert_eq!(worst.stated.sequence_text(), "3 × missed, 4 × met, 3 × missed, 5 × met");
    assert_eq!((worst.stable_up_to, worst.tried.len()), (Some(2), 4));
    let page = linear::page(&advised("deadline-misses = \"2 consecutive\"\noverrun = \"queue\""));
    assert!(page.contains("2 of 3 (stated)") && page.contains("Which missed deadlines"));
}

#[test]
fn random_overruns_have_a_limit_at_which_the_loop_is_unstable() {
    for strategy in ["kill", "skip", "queue"] {
        let keys = |p: f64| format!("overrun = \"{strategy}\"\noverrun-probability = {p}");
        let random = advised(&keys(0.01)).deadline_misses.unwrap().random.unwrap();
        assert!(random.growth < 0.0 && random.cost.is_some(), "{random:?}");
        let limit = random.stable_up_to.unwrap();
        let [below, above] = [0.99, 1.01].map(|share| advised(&keys(share * limit)));
        assert!(below.holds() && !above.holds(), "{strategy} {limit}");
        let cost = |advice: LinearAdvice| advice.deadline_misses.unwrap().random.unwrap().cost;
        assert!(cost(below) > Some(2.0 * random.cost.unwrap()) && cost(above).is_none());
    }
}

#[test]
fn missed_deadlines_that_cannot_be_are_refused_with_what_is_allowed() {
    for (keys, wanted) in [
        ("deadline-misses = \"5 of 5\"", "`deadline-misses` is \"5 of 5\"; expected `m of K`"),
        ("deadline-misses = \"two of 5\"", "expected `m of K` with m below K"),
        ("deadline-misses = \"2 in 5\"", "or \"2 consecutive\""),
        ("deadline-misses = \"20 of 40\"", "at most 1000 choices of m deadlines of K"),
        ("overrun = \"skipp\"", "did you mean `skip`?"),
        ("overrun-probability = 1", "`overrun-probability` is 1.0; expected a probability"),
        ("overrun-probability = nan", "expected a probability of at least 0 and below 1"),
        ("overrun-probability = 0.1\nloss = 0.1", "`loss` is given too"),
    ] {
        let error = linear::parse(&format!("{PENDULUM}{keys}"), "wrong.toml").unwrap_err();
        assert!(error.to_string().contains(wanted), "{error}");
    }
}
