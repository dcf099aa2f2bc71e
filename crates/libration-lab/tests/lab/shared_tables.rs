//! Tables that `lab` shares with other commands, and durations.

use libration_lab::{STUDIES, SystemStudies};
use libration_settings::equations::EquationSystem;
use libration_study_motion::Problem;
use serde_json::json;

use super::config::{error, marked};

#[test]
fn omega2_is_the_oscillator_of_a_mass_of_one() {
    let spring = |text: &str| {
        let spring = STUDIES.parse(&format!("[system.oscillator]\n{text}"), "").unwrap().oscillator;
        (spring.m, spring.k)
    };
    assert_eq!(spring("omega2 = 4"), (1.0, 4.0));
    assert_eq!(spring("m = 2\nk = 5"), (2.0, 5.0));
}

#[test]
fn a_start_is_a_number_or_a_list_of_one() {
    let of = |text: &str| STUDIES.parse(&format!("[start]\n{text}"), "").unwrap().start;
    assert_eq!(of("q = 0.5\nv = -1"), of("q = [0.5]\nv = [-1]"));
    assert_eq!((of("q = [0.5]").q, of("q = [0.5]").v), (0.5, 0.0));
}

#[test]
fn other_systems_are_errors_that_say_how_to_study_them() {
    for (text, place) in [
        ("[system.pendulum]\nomega2 = 9.8", "pendulum"),
        ("[system.equations]\nof = 'mine.toml'", "equations"),
        ("[system.linear]\na = [[0.0]]", "linear"),
    ] {
        let error = error(text);
        assert_eq!(marked(&error), place, "{error}");
        assert!(error.message().contains(&format!("[system.{place}] is given; expected")));
        assert!(error.help().unwrap().contains("`libration lab --system FILE`"), "{error}");
    }
    let two = error("[system.pendulum]\n[system.oscillator]");
    assert!(two.message().contains("must be one table"), "{two}");
}

#[test]
fn time_steps_take_units() {
    let with_units = "spectrum.dt = '100Hz'\nerror.dt = '2 ms'\ndrift.dt = ['1ms', 0.1]\nprecision.dt = ['1kHz']\n";
    let seconds =
        "spectrum.dt = 0.01\nerror.dt = 0.002\ndrift.dt = [0.001, 0.1]\nprecision.dt = [0.001]\n";
    assert_eq!(STUDIES.parse(with_units, "").unwrap(), STUDIES.parse(seconds, "").unwrap());
}

#[test]
fn tables_of_other_commands_change_nothing() {
    let text = "seed = 7\ndt = 'never'\n[controller.pd]\n[loop]\nlatency = 1\n[tolerance]\n[request]\n[chunk]\n\
                [task.regulate]\n[delays]\n[noise]\n[policy.none]\n";
    assert_eq!(STUDIES.parse(text, "").unwrap(), STUDIES.config());
}

#[test]
fn the_configuration_in_results_is_that_of_the_run() {
    let text = "[system.oscillator]\nm = 2\nk = 3\n[start]\nq = [0.25]\nv = [-1]\n";
    let config = STUDIES.parse(text, "").unwrap();
    let json = serde_json::to_value(&config).unwrap();
    assert_eq!(json["system"], json!({ "oscillator": { "k": 3.0, "m": 2.0 } }));
    assert_eq!(json["start"], json!({ "q": 0.25, "v": -1.0 }));
    assert_eq!(STUDIES.parse_json(&json).unwrap(), config);
}

#[test]
fn tables_of_other_commands_have_no_effect_on_a_system_by_equations() {
    let text = "[system]\nname = 'ball'\ncoordinates = ['x']\nacceleration.x = '-x'\nstart = { x = 1.0 }\n";
    let system = EquationSystem::parse(text, "ball.toml", &[]).unwrap();
    let problem = Problem::of_equations(&system);
    let studies = SystemStudies::new(&system, &problem);
    for (key, reason) in [
        ("controller", "`advise` reads it"),
        ("chunk", "`rollout` reads it"),
        ("system.oscillator", "`ball` takes its place"),
    ] {
        let found = studies.reason_without_effect(key).unwrap();
        assert!(found.contains(reason), "{key}: {found}");
    }
    assert_eq!(studies.reason_without_effect("effort"), None);
}
