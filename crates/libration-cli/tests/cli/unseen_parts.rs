//! Verdicts of `libration analyze` on what is easily left out: short events, starts at rest, clocks of an ensemble, random steps, starts of
//! loops that are no equilibria, and trajectories of a thermostat that become infinite.

use std::fs;

use assert_cmd::Command;

/// The text as one line and the exit code.
fn answer(words: &str) -> (String, i32) {
    let output = Command::cargo_bin("libration")
        .unwrap()
        .args(["-q", "analyze"])
        .args(words.split_whitespace())
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    (text.split_whitespace().collect::<Vec<_>>().join(" "), output.status.code().unwrap())
}

#[track_caller]
fn check(words: &str, parts: &[&str], code: i32) {
    let (text, found) = answer(words);
    for part in parts {
        assert!(text.contains(part), "{words}: `{part}` is not in\n{text}");
    }
    assert_eq!(found, code, "{words}\n{text}");
}

#[test]
fn errors_in_short_events_of_long_motions_are_seen() {
    // The largest errors after all steps, by DOP853 with a tolerance of 1e-13 or Kepler's equation: 60.8 % of x' in a bounce that takes a
    // thousandth of the motion; 1.23 % of v0 at a perihelion; 2.43 % of y in the jumps of a relaxation oscillator.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bounce.toml");
    let text = "[system]\nname = \"bounce\"\ncoordinates = [\"x\"]\nacceleration.x = \"-9.81 + 1e-16/x^7\"\nstart = { x = 1 }\n";
    fs::write(&path, text).unwrap();
    let bounce = format!("--system {} --integrator rk4 --dt 2e-5 --steps 200000", path.display());
    check(&bounce, &["does not resolve the motion over 200000 steps", "reaches at least 60."], 1);
    let kepler = "--system kepler --q 0.1,0 --v 0,4.36 --integrator rk4 --dt 0.0016 --steps 60000";
    check(kepler, &["does not resolve", "reaches at least 1.2"], 1);
    // Fewer steps are all compared, and the sentence has no restriction.
    check(
        "--system kepler --q 1,0 --v 0,1 --integrator rk4 --dt 0.01 --steps 2000",
        &["resolves the motion over 2000 steps (20 s): the largest error is"],
        0,
    );
    check(
        "--system kepler --q 1,0 --v 0,1 --integrator rk4 --dt 0.01 --steps 4000",
        &["resolves the motion over 4000 steps (40 s): the largest error after", "of them is"],
        0,
    );
}

#[test]
fn a_start_at_rest_has_the_verdict_of_the_step_and_no_motion() {
    let rests = "the system rests at its start";
    // RK4 multiplies by 1 + z + z²/2 + z³/6 + z⁴/24: at z = 30 by 38,731 where the exact step has e³⁰, and at z = −30 by 29,671 where it has e⁻³⁰.
    check("--system duffing --q 0 --integrator rk4 --dt 30", &["is unstable", rests], 1);
    check(
        "--system pendulum --q 0 --integrator rk4 --dt 0.8",
        &["is stable on pendulum", rests],
        0,
    );
    check(
        "--system pendulum --q 0 --integrator rk4 --dt 1",
        &["is unstable on pendulum", rests],
        1,
    );
    // Deviations from rest under random steps count by their second moments.
    let random =
        "--system pendulum --q 0 --integrator velocity-verlet --dt 0.6 --jitter gaussian:0.3";
    check(random, &["is unstable on pendulum", "second moments grow by"], 1);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rest.toml");
    for (rate, said, code) in
        [("-25*x - 0.2*x'", "is stable on rest", 0), ("-250*x", "is unstable", 1)]
    {
        let text = format!(
            "[system]\nname = \"rest\"\ncoordinates = [\"x\"]\nacceleration.x = \"{rate}\"\n"
        );
        fs::write(&path, text).unwrap();
        let words = format!("--system {} --integrator rk4 --dt 0.5", path.display());
        check(&words, &[said, rests], code);
    }
}

#[test]
fn a_step_that_some_clocks_of_an_ensemble_make_unstable_is_unstable() {
    // Verlet is stable up to 2/√10 = 0.6325 s; a clock at four standard deviations has 1.4 times 0.632 s.
    let verlet = "--system oscillator --integrator velocity-verlet --skew gaussian:0.1 --dt";
    check(&format!("{verlet} 0.632"), &["is unstable", "steps of a clock that are 40 % longer"], 1);
    check(&format!("{verlet} 0.46"), &["is unstable", "steps of a clock that are 40 % longer"], 1);
    check(&format!("{verlet} 0.45"), &["is stable"], 0);
    // Nine clocks are not all of them, and the verdict says so.
    check(&format!("{verlet} 0.45 --json"), &["clocks between and beyond nine of the ensemble"], 0);
    // The ends of a uniform law with a standard deviation of 0.2 are ±0.3464, and 0.6325 s/1.3464 is 0.4698 s.
    let uniform = "--system oscillator --integrator velocity-verlet --skew uniform:0.2 --dt";
    check(&format!("{uniform} 0.471"), &["is unstable", "34.6 % longer"], 1);
    check(&format!("{uniform} 0.469"), &["is stable"], 0);
    let held = "--system oscillator --integrator exact --dt 0.1 --feedback 10,2 --latency 0.105";
    check(held, &["The loop is stable"], 0);
    check(&format!("{held} --skew gaussian:0.3"), &["The loop is unstable: steps of a clock"], 1);
}

#[test]
fn nonlinear_motions_in_random_steps_are_unknown_or_as_bad_as_in_stated_ones() {
    let diverges = ["diverges: a state is not finite after step 4"];
    check("--system duffing --q 2 --integrator rk4 --dt 1.5 --jitter uniform:0.01", &diverges, 1);
    let pendulum = "--system pendulum --q 0.5 --integrator rk4 --dt 0.02 --steps 500";
    check(pendulum, &["resolves the motion over 500 steps"], 0);
    for law in ["--jitter gaussian:0.1", "--skew gaussian:0.1"] {
        let unknown = ["resolves the motion is not known", "not with jitter or skew"];
        check(&format!("{pendulum} {law}"), &unknown, 1);
    }
}

#[test]
fn a_loop_around_a_nonlinear_system_is_judged_at_an_equilibrium_alone() {
    let unknown = ["Whether the loop is stable is not known", "the start is no equilibrium"];
    let duffing = "--system duffing --set alpha=1 --set beta=-1 --integrator rk4 --dt 0.01 --feedback=-0.2,0.1";
    // Its energy of 0.209 J/kg is above the barrier of 0.16 J/kg, and the motion leaves.
    check(&format!("{duffing} --q 0.5 --v 0.5"), &unknown, 1);
    check(&format!("{duffing} --q 0"), &["The loop is stable"], 0);
    let pendulum = "--system pendulum --integrator rk4 --dt 0.01 --feedback 5,0.56 --latency";
    check(&format!("{pendulum} 0.104 --q 2"), &unknown, 1);
    check(&format!("{pendulum} 0.104 --q 0"), &["The loop is unstable"], 1);
    check(&format!("{pendulum} 0.05 --q 0"), &["The loop is stable"], 0);
}

#[test]
fn a_thermostat_whose_trajectories_become_infinite_is_not_stable() {
    let unknown = ["is not known: measured trajectories of each stable method became infinite"];
    let hot = "--temperature 10 --friction 1 --dt 0.6 --steps 3200";
    check(&format!("--system duffing --q 1 {hot}"), &unknown, 1);
    check("--force -q0-q0^3 --temperature 5 --friction 1 --dt 1.5 --steps 3200", &unknown, 1);
    check(
        "--system oscillator --temperature 1 --friction 1 --dt 0.3 --steps 3200",
        &["is stable"],
        0,
    );
}
