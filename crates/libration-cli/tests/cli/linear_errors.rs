//! Wrong requests for loops around linear plants.

use predicates::prelude::*;

use super::advise::{json, libration};
use super::linear::{OSCILLATOR, example, written};

#[test]
fn plants_and_controllers_that_do_not_fit_are_usage_errors_that_name_the_key() {
    let folder = tempfile::tempdir().unwrap();
    let loops = [
        (
            "a = [[0, 1], [-10, 0]]",
            "a = [[0, 1], [-10]]",
            "row 2 of `a` has 1 numbers, row 1 has 2",
        ),
        ("a = [[0, 1], [-10, 0]]", "a = [[0, 1]]", "`A` is 1 × 2; expected a square matrix"),
        (
            "a = [[0, 1], [-10, 0]]",
            "a = [[0, 1], [nan, 0]]",
            "row 2, column 1; expected a finite number",
        ),
        ("b = [[0], [1]]", "b = [[0]]", "`B` is 1 × 1; expected 2 rows"),
        ("b = [[0], [1]]", "", "`a` is given, so `b` is required"),
        ("b = [[0], [1]]", "b = [[0], [1]]\nstates = [\"q\"]", "1 names of states for 2 states"),
        (
            "b = [[0], [1]]",
            "b = [[0], [1]]\ndamping = [[4]]",
            "`damping` is given, but it is no key of a plant by `a`",
        ),
        ("b = [[0], [1]]", "b = [[0], [1]]\nmass = [[1]]", "but `a` and `mass` are given"),
        ("gain = [[10, 2]]", "gain = [[10]]", "`gain` is 1 × 1; expected 1 × 2"),
        (
            "[controller.state-feedback]\ngain = [[10, 2]]",
            "[controller.state-space]\nmeasures = \"state\"\nd = [[-10, -2]]",
            "unknown value `state` of `measures`",
        ),
        ("period = 0.01", "period = 0", "`period` is 0.0; expected 1e-9 to 1e9 (s)"),
        ("period = 0.01", "period = 1e300", "`period` is 1e300; expected 1e-9 to 1e9 (s)"),
        ("b = [[0], [1]]", "b = [[0], [1]]\nstates = [\"q\", \" \"]", "name of the states is \"\""),
        (
            "b = [[0], [1]]",
            "b = [[0], [1]]\nstates = [\"q\", \"v\\nw\"]",
            "expected text on one line",
        ),
        (
            "period = 0.01",
            "period = 0.01\nlatency = [0, 1]",
            "`latency` has 2 values; expected one",
        ),
        (
            "period = 0.01",
            "period = 0.01\nlatency = \"5 msec\"",
            "the latency is \"5 msec\"; expected a number of seconds, one with a unit such as \"2ms\", or \"preset:NAME\"",
        ),
        ("period = 0.01", "period = 0.01\noverrun = \"skip\"", "but no job overruns"),
        (
            "period = 0.01",
            "period = 0.01\nclock = \"measured\"",
            "nothing in the controller depends on the length of a period",
        ),
        (
            "period = 0.01",
            "period = 0.01\nmeasurement-noise = [0, -1]",
            "`measurement-noise` is -1.0; expected a finite variance of at least 0",
        ),
        (
            "period = 0.01",
            "period = 0.01\nmeasurement-noise = [[1, 0.5], [0.5, 1]]",
            "has entries beside its diagonal",
        ),
        (
            "[controller.state-feedback]",
            "[controller.lqr]\nstates = [1, 1]\ninputs = [1]\n[controller.state-feedback]",
            "more than one is given; expected exactly one table",
        ),
        ("period = 0.01", "period = 0.01\nloss = 1", "`loss` is 1.0; expected a probability"),
        ("period = 0.01", "period = 0.01\nlatensy = 1", "unknown key `latensy`"),
        (
            "period = 0.01",
            "period = 0.01\nlatency = 10",
            "10 is 10 s, 1000 periods; did you mean 10ms?",
        ),
        ("[controller.state-feedback]\ngain = [[10, 2]]", "", "there is no controller"),
        (
            "[controller.state-feedback]\ngain = [[10, 2]]",
            "[controller.lqr]\nstates = [1, 1]\ninputs = [0]",
            "`input weights` has the eigenvalue",
        ),
        (
            "[controller.state-feedback]",
            "[[part]]\ninput = \"u2\"\nlag = 1\n[controller.state-feedback]",
            "unknown input `u2`",
        ),
        (
            "[controller.state-feedback]",
            "[[part]]\ninput = \"u1\"\ndifference = true\n[controller.state-feedback]",
            "`difference` stands before the input `u1`; expected an output",
        ),
        (
            "[controller.state-feedback]",
            "[[part]]\noutput = \"x1\"\nmoving-average = 0\n[controller.state-feedback]",
            "averages 0 samples; expected 1 to 100",
        ),
        (
            "[controller.state-feedback]",
            "[[part]]\noutput = \"x1\"\nmoving-average = 2\nlag = 1\n[controller.state-feedback]",
            "exactly one of `lag`, `butterworth2`, `moving-average` and `difference = true`",
        ),
        (
            "[controller.state-feedback]\ngain = [[10, 2]]",
            "[controller.cascade]\nevery = 2\ninner = { gain = [[1]] }\nouter = { gain = [[1, 0]] }",
            "`gain` is 1 × 1; expected 1 × 3: inputs × outputs and references",
        ),
        (
            "[controller.state-feedback]\ngain = [[10, 2]]",
            "[controller.cascade]\nevery = 101\ninner = { gain = [[1, 1, 1]] }\nouter = { gain = [[1, 0]] }",
            "`every` is 101; expected 1 to 100 periods",
        ),
        (
            "[controller.state-feedback]\ngain = [[10, 2]]",
            "[controller.cascade]\nevery = 2\ninner = { gain = [[1, 1, 1]] }\nouter = { pid = [] }",
            "has no references",
        ),
        (
            "[controller.state-feedback]\ngain = [[10, 2]]",
            "[controller.cascade]\nevery = 2\ninner = { gain = [[1, 1, 1]] }\nouter = { pid = [{ output = \"x1\", input = \"u1\", reference = \"r\", proportional = 1 }] }",
            "expected only a `reference`",
        ),
        (
            "[controller.state-feedback]",
            "[[part]]\ninput = \"u1\"\nlag = -1\n[controller.state-feedback]",
            "time constant of -1; expected a finite number above 0",
        ),
    ];
    for (from, to, wanted) in loops {
        let text = OSCILLATOR.replace(from, to);
        assert_ne!(text, OSCILLATOR, "{from}");
        let path = written(&folder, "wrong.toml", &text);
        libration(&["advise", "--config", path.to_str().unwrap()])
            .code(2)
            .stdout("")
            .stderr(predicate::str::contains(wanted));
    }
    let plant = written(&folder, "p.csv", "A, 0, one\n");
    let plant = plant.to_str().unwrap();
    let words = ["advise", "--plant", plant, "--lqr", "1/1"];
    libration(&words).code(2).stderr(predicate::str::contains("line 1: `one` is no number"));
    let masses = written(&folder, "masses.csv", "M, 1\nD, 0.5\nK, 4\nB, 1\n");
    libration(&["advise", "--plant", masses.to_str().unwrap(), "--lqr", "1,1/1"])
        .code(2)
        .stderr(predicate::str::contains("expected `damping`, or `C` and `D`"));
    let request = example("two_mass_drive.toml");
    libration(&["advise", "--plant", &request, "--lqr", "1/1"]).code(2).stderr(
        predicate::str::contains(
            "it is a request with the table [system.linear]; expected --config",
        ),
    );
    let own = written(&folder, "own.toml", "a = [[0, 1], [0, -1]]\nb = [[0], [1]]\n");
    libration(&["advise", "--plant", own.to_str().unwrap(), "--lqr", "1/1"])
        .code(2)
        .stderr(predicate::str::contains("--lqr: `states` has 1 numbers; expected 2"));
    let oscillator = ["advise", "--system", "oscillator", "--feedback", "10,2"];
    for (rest, wanted) in [
        (
            &["--output-latency", "0.1"][..],
            "--output-latency is given, but there is no loop around a linear plant",
        ),
        (&["--redesign"], "--redesign is given, but there is no loop around a linear plant"),
        (&["--plant", plant], "cannot be used with"),
    ] {
        libration(&[&oscillator, rest].concat()).code(2).stderr(predicate::str::contains(wanted));
    }
    libration(&["advise", "--plant", plant, "--horizon", "3"])
        .code(2)
        .stderr(predicate::str::contains("cannot be used with"));
    libration(&["advise", "--plant", plant])
        .code(2)
        .stderr(predicate::str::contains("`one` is no number"));
}

#[test]
fn motions_out_of_reach_and_motions_that_nothing_damps_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let text = "\
[system.linear]
a = [[0, 1, 0], [-10, 0, 0], [0, 0, 3]]
b = [[0], [1], [0]]
states = [\"swing\", \"rate\", \"runaway\"]
[controller.lqr]
states = [1, 1, 1]
inputs = [1]
";
    let path = written(&folder, "out.toml", text);
    libration(&["advise", "--config", path.to_str().unwrap()]).code(2).stderr(
        predicate::str::contains("no input reaches the mode of runaway (growth rate 3.0000 1/s)"),
    );
    let text = OSCILLATOR.replace("[[10, 2]]", "[[10, -2]]");
    let path = written(&folder, "grows.toml", &text);
    libration(&["advise", "--config", path.to_str().unwrap()]).code(1).stdout(
        predicate::str::contains("a motion grows by the factor")
            .and(predicate::str::contains("x2, x1")),
    );
}

#[test]
fn a_plant_that_mixes_fast_and_slow_motions_in_its_entries_gets_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let told = |a: &str| {
        let text = format!(
            "[system.linear]\na = {a}\nb = [[1], [1]]\n[controller.state-feedback]\ngain = [[0, 0]]\n"
        );
        let path = written(&folder, "stiff.toml", &text);
        json(&["advise", "--config", path.to_str().unwrap()])["warnings"].to_string()
    };
    // Rates of 1.5 and 3·10⁹ per second, mixed and apart.
    let mixed = "[[-1000000001.0, 999999999.5], [1999999999.0, -2000000000.5]]";
    assert!(told(mixed).contains("the plant is stiff: rounding changes"));
    assert!(!told("[[-1.5, 0], [0, -3e9]]").contains("stiff"));
}
