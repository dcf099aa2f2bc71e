//! Tests of the shared options: accepted values and error messages.

use clap::Parser;
use libration_analyze::trajectory::FloatType;

use super::*;
use crate::args::SimulateArgs;

/// A command that simulates.
#[derive(Debug, Parser)]
struct Probe {
    #[command(flatten)]
    args: SimulateArgs,
}

/// The outcome of a command line that starts with a system, an integrator and a time step.
fn probe(system: &str, flags: &str) -> Result<(Probe, EquationSystem), String> {
    let steps = if flags.contains("--steps") { "" } else { "--steps 10" };
    parse(&format!("probe --system {system} --integrator rk4 --dt 0.01 {steps} {flags}"))
}

fn parse(line: &str) -> Result<(Probe, EquationSystem), String> {
    let probe = Probe::try_parse_from(line.split(' ').filter(|word| !word.is_empty()))
        .map_err(|error| error.to_string())?;
    let system = probe.args.system.as_ref().ok_or("there is no system")?;
    match system.resolve() {
        Ok(setting) => Ok((probe, setting)),
        Err(Failure::Usage(message)) => Err(message),
        Err(other) => panic!("not a usage error: {other:?}"),
    }
}

fn start(system: &str, flags: &str) -> (Vec<f64>, Vec<f64>) {
    let (_, setting) = probe(system, flags).unwrap();
    (setting.q, setting.v)
}

#[test]
fn a_start_is_read_or_comes_from_the_catalogue() {
    assert_eq!(start("oscillator", ""), (vec![1.0], vec![0.0]));
    assert_eq!(start("oscillator", "--q 2"), (vec![2.0], vec![0.0]));
    assert_eq!(start("oscillator", "--v -0.3"), (vec![1.0], vec![-0.3]));
    assert_eq!(start("oscillator", "--q=-1,2 --v=-.5,1e-3"), (vec![-1.0, 2.0], vec![-0.5, 1e-3]));
    assert_eq!(start("oscillator", "--q -1,2,3"), (vec![-1.0, 2.0, 3.0], vec![0.0; 3]));
    assert_eq!(start("kepler", ""), (vec![0.4, 0.0], vec![0.0, 2.0]));
    assert_eq!(start("kepler", "--v 0,1"), (vec![0.4, 0.0], vec![0.0, 1.0]));
}

#[test]
fn the_other_flags_are_read() {
    let (probe, setting) =
        probe("oscillator", "--set k=4 --set m=2 --steps 1e6 --dtype bf16").unwrap();
    assert_eq!(setting.twin.unwrap().system.parameters(), [("omega2", 2.0)]);
    let step = probe.args.step.unwrap();
    assert_eq!((step.integrator, step.dt), (Stepping::Method(libration::Method::Rk4), 0.01));
    assert_eq!(
        (probe.args.steps_of(1.0).ok(), probe.args.dtype),
        (Some(1_000_000), FloatType::Bf16)
    );
}

#[test]
fn wrong_input_is_named_with_what_is_allowed() {
    let cases: &[(&str, &str, &[&str])] = &[
        ("oscilator", "", &["'oscilator'", "--system", "'oscillator'", "kepler"]),
        ("kepler", "--q 1", &["--q `1` has 1 coordinate;", "kepler requires 2 numbers"]),
        ("kepler", "--v 1,2,3", &["--v `1,2,3` has 3 coordinates", "kepler requires 2 numbers"]),
        ("oscillator", "--q 1,2,3,4,5,6,7,8,9", &["has 9 coordinates", "1 to 8 numbers"]),
        ("pendulum", "--q 1,2", &["--q `1,2` has 2 coordinates", "pendulum requires 1 number"]),
        ("oscillator", "--q 1,2 --v 1", &["--q `1,2` has 2", "--v `1` has 1", "equal numbers"]),
        ("oscillator", "--q 1,x", &["--q", "`x` is not a number", "separated by commas"]),
        ("oscillator", "--q 1,", &["--q", "a coordinate is missing"]),
        ("oscillator", "--v nan", &["--v", "`nan` is not finite"]),
        ("oscillator", "--v -inf", &["--v", "`-inf` is not finite"]),
        ("oscillator", "--v 1;2", &["--v", "`1;2` is not a number", "e.g. 1,-0.5"]),
        ("oscillator", "--set k", &["--set", "'k'", "KEY=VALUE"]),
        ("oscillator", "--set =1", &["--set", "the key is missing"]),
        ("oscillator", "--set k=soft", &["--set", "`soft` is not a number"]),
        ("oscillator", "--set k=-3", &["`k` is -3.0", "at least 0", "--set"]),
        ("oscillator", "--set m=0", &["`m` is 0.0", "greater than 0", "--set"]),
        ("oscillator", "--set omga2=3", &["`omga2`", "`k`", "did you mean `omega2`?"]),
        ("oscillator", "--set k=1 --set k=2", &["`k` is given twice"]),
        ("oscillator", "--set k=1 --set omega2=2", &["`k`", "together with `omega2`"]),
        ("oscillator", "--steps 0", &["'0'", "--steps", "`--steps` is 0", "must be 1 to"]),
        ("oscillator", "--steps -5", &["--steps", "`--steps` is -5", "must be 1 to"]),
        ("oscillator", "--steps 1.5", &["'1.5'", "--steps", "not a whole number"]),
        ("oscillator", "--steps 1e300", &["--steps", "must be 1 to 9007199254740992"]),
        ("oscillator", "--dtype f31", &["'f31'", "--dtype", "f32", "bf16"]),
    ];
    for (system, flags, parts) in cases {
        let message = probe(system, flags).map(|_| ()).unwrap_err();
        for part in *parts {
            assert!(message.contains(part), "`{part}` is not in:\n{message}");
        }
    }
}

#[test]
fn time_steps_and_integrators_are_checked() {
    for (dt, value) in
        [("0", "0.0"), ("-1", "-1.0"), ("nan", "NaN"), ("inf", "inf"), ("-inf", "-inf")]
    {
        let line = format!("probe --system kepler --integrator rk4 --steps 1 --dt {dt}");
        let message = parse(&line).map(|_| ()).unwrap_err();
        let expected = format!("`--dt` is {value}, but it must be finite and greater than 0");
        assert!(message.contains(&expected), "{message}");
    }
    let message =
        parse("probe --system kepler --integrator rk5 --steps 1 --dt x").map(|_| ()).unwrap_err();
    for part in ["'rk5'", "--integrator", "did you mean `rk4`?", "velocity-verlet"] {
        assert!(message.contains(part), "{message}");
    }
}
