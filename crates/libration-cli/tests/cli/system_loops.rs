//! `simulate --system FILE` with a controller, through the binary.

use std::fs;

use predicates::str::contains;

use super::advise::libration;
use super::linear::written;
use super::system_lab::example;

/// The rows of a run, without the header.
fn rows(words: &[&str]) -> Vec<Vec<f64>> {
    let out =
        libration(&[&["simulate", "-q"], words].concat()).success().get_output().stdout.clone();
    let text = String::from_utf8(out).unwrap();
    let numbers = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect();
    text.lines().skip(1).map(numbers).collect()
}

#[test]
fn a_tilted_cart_pole_with_latency_moves_as_in_an_independent_program() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(example("cart_pole.toml")).unwrap();
    let tilted = text.replace("start = { theta = 0.1 }", "start = { theta = 0.6 }");
    let file = written(&folder, "tilted.toml", &tilted);
    let file = file.to_str().unwrap();
    let looped = ["--gain=-3,-40,-4,-10", "--period", "0.02", "--latency", "0.03"];
    let found =
        rows(&[&["--system", file, "--steps", "100", "--save-every", "50"], &looped[..]].concat());
    // Thirty lines of Python with SciPy's DOP853 from event to event, with a relative tolerance of 1e-13: states, then the command.
    let wanted = [
        [1.6031911492939075, -0.2627798147870174, -0.33699044005005063, 0.417830794357215],
        [0.6813671187186917, 0.03188112670899153, -0.9760858071859736, 0.11578009888552103],
    ];
    let commands = [-3.218283436991546, 0.533616826920642];
    // Six steps of order four in each half of a period: 1.5e-10; ten: 2e-11, as (6/10)⁴ predicts.
    let off = |found: &[Vec<f64>]| {
        let states = found[1..]
            .iter()
            .zip(wanted)
            .flat_map(|(row, wanted)| (0..4).map(move |i| (row[2 + i] - wanted[i]).abs()));
        states.fold(0.0, f64::max)
    };
    assert!(off(&found) < 3e-10, "{found:?}");
    assert!((found[1][10] - commands[0]).abs() < 1e-8 && (found[2][10] - commands[1]).abs() < 1e-8);
    let finer = ["--integrator", "rk4", "--dt", "0.001"];
    let words =
        [&["--system", file, "--steps", "100", "--save-every", "50"], &looped[..], &finer].concat();
    assert!(off(&rows(&words)) < 3e-11, "{:?}", rows(&words));
}

#[test]
fn a_linear_system_by_its_equations_moves_as_its_plant_with_every_imperfection() {
    let folder = tempfile::tempdir().unwrap();
    let motor = "[system]\nname = \"motor\"\ncoordinates = [\"angle\"]\ninputs = [\"u\"]\n\
        acceleration.angle = \"5*current - 2*angle' - 3*angle\"\nrate.current = \"u - 4*current - angle'\"\n\
        start = { angle = 0.3, current = 0.1 }\n";
    let file = written(&folder, "motor.toml", motor);
    let file = file.to_str().unwrap();
    let looped = [
        "--lqr=1,1,1/1",
        "--period",
        "0.05",
        "--latency",
        "0.07",
        "--output-latency",
        "0.02",
        "--jitter",
        "uniform:0.2",
        "--loss",
        "0.3",
        "--disturbance",
        "u=0.2",
        "--reference",
        "angle=0.1",
        "--steps",
        "80",
        "--save-every",
        "40",
        "--seed",
        "5",
    ];
    let exact = rows(&[&["--plant", file, "--x0", "0.3,0,0.1"], &looped[..]].concat());
    let steps = ["--integrator", "rk4", "--dt", "0.001"];
    let found = rows(&[&["--system", file], &looped[..], &steps].concat());
    // 4 ms of order four: the cost by Simpson's rule has the largest error.
    for (a, b) in exact.iter().flatten().zip(found.iter().flatten()) {
        assert!((a - b).abs() < 1e-10 * a.abs().max(1.0), "{exact:?}\n{found:?}");
    }
    let many = ["--num-trajectories", "20", "--threads", "2"];
    let all = rows(&[&["--system", file], &looped[..], &steps, &many].concat());
    // Without a spread all start alike, and the first of many is the single one.
    let first = all.iter().filter(|row| row[0] == 0.0);
    assert!(first.map(|row| &row[1..]).eq(found.iter().map(|row| &row[..])));
}

#[test]
fn loops_that_cannot_be_are_refused_by_name() {
    let cart = example("cart_pole.toml");
    let refused = |words: &[&str], why: &str| {
        let common = ["simulate", "--steps", "5"];
        libration(&[&common, words].concat()).code(2).stderr(contains(why));
    };
    let lqr = ["--system", &cart, "--lqr", "1,10,0,1/0.1"];
    refused(&[&lqr[..], &["--q", "1"]].concat(), "--q cannot be combined");
    let twice = [&lqr[..], &["--set", "pole=1", "--set", "pole=2"]].concat();
    refused(&twice, "--set pole=2: the parameter is given twice");
    refused(&[&lqr[..], &["--dtype", "f32"]].concat(), "--dtype cannot be combined");
    refused(&[&lqr[..], &["--skew", "uniform:0.1"]].concat(), "--skew");
    refused(&[&lqr[..], &["--integrator", "exact", "--dt", "0.01"]].concat(), "--plant FILE");
    refused(&[&lqr[..], &["--integrator", "rk4", "--dt", "1e-12"]].concat(), "1e-12");
    refused(&[&lqr[..], &["--integrator", "rk4"]].concat(), "--dt");
    refused(&["--system", &cart, "--lqr", "1,1/1"], "--lqr");
    refused(
        &["--system", "pendulum", "--lqr", "1,1/1"],
        "--lqr is given, but there is no loop around a plant",
    );
    let unlooped = ["--system", &cart, "--integrator", "rk4", "--dt", "0.01"];
    refused(
        &[&unlooped[..], &["--period", "0.1"]].concat(),
        "--period is given, but there is no loop",
    );
    refused(&[&unlooped[..], &["--loss", "0.1"]].concat(), "--loss is given, but there is no loop");
}
