//! Configuration files: what is read, and what is said about what cannot be read.

use std::collections::BTreeSet;

use libration::Method;
use libration_lab::STUDIES;
use libration_settings::{ConfigCommand, SettingsError};
use libration_study::{Config, Effort};
use libration_study_motion::{DriftSettings, SpectrumSettings};
use serde_json::{Value, json};

pub(super) fn error(text: &str) -> SettingsError {
    STUDIES.parse(text, "mine.toml").unwrap_err()
}

/// The characters that the error points at.
pub(super) fn marked(error: &SettingsError) -> &str {
    &error.source_text()[error.span()]
}

#[test]
fn the_printed_default_is_the_default() {
    assert_eq!(STUDIES.parse(&STUDIES.text(), "default.toml").unwrap(), STUDIES.config());
}

#[test]
fn every_key_has_a_default() {
    for text in
        ["", "# nothing\n", "\u{feff}", "[system.oscillator]\n[start]\n[drift]\n[spectrum]\n"]
    {
        assert_eq!(STUDIES.parse(text, "").unwrap(), STUDIES.config(), "{text:?}");
    }
}

#[test]
fn values_are_read() {
    let text = "\u{feff}effort = 'quick'\r\nintegrators = ['leapfrog']\r\nsystem.oscillator.k = 4\r\n\
                start = { q = 0, v = -1 }\r\n[drift]\r\n\tdt = [1, 0.5]\r\n\tsteps = 1e3\r\n";
    let config = STUDIES.parse(text, "").unwrap();
    assert_eq!(config.effort, Effort::Quick);
    assert_eq!(config.integrators, [Method::Leapfrog]);
    assert_eq!((config.oscillator.m, config.oscillator.k), (1.0, 4.0));
    assert_eq!((config.start.q, config.start.v), (0.0, -1.0));
    assert_eq!(
        (config.get::<DriftSettings>().dt, config.get::<DriftSettings>().steps),
        (vec![0.5, 1.0], 1000)
    );
    assert_eq!(config.get::<SpectrumSettings>(), STUDIES.config().get::<SpectrumSettings>());
}

/// Each case: a file, the characters that it is wrong about, a part of the message.
fn assert_errors(cases: &[(&str, &str, &str)]) {
    for (text, place, message) in cases {
        let error = error(text);
        assert_eq!(marked(&error), *place, "{error}");
        assert!(error.message().contains(message), "{error}");
    }
}

#[test]
fn bad_values_are_named_with_what_is_allowed() {
    assert_errors(&[
        ("[system.oscillator]\nm = 0.0\nk = 1", "0.0", "oscillator: `m` is 0.0, but it must be"),
        ("[system.oscillator]\nk = -10", "-10", "oscillator: `k` is -10.0, but it must be"),
        ("[system.oscillator]\nk = nan", "nan", "oscillator: `k` is NaN"),
        (
            "[system.oscillator]\nk = 0",
            "0",
            "`system.oscillator.k` is 0.0, but it must be finite and",
        ),
        ("[system.oscillator]\nm = 1e-320\nk = 10", "10", "omega2 = k/m = 10.0/1e-320 is inf"),
        (
            "system.oscillator = { m = 1e200, k = 1e-200 }",
            "1e-200",
            "is 0.0, but it must be finite",
        ),
        ("[system.oscillator]\nomega2 = 0", "0", "`system.oscillator.omega2` is 0.0, but it must"),
        ("[system.oscillator]\nomega2 = 1\nk = 2", "2", "cannot be given together with `omega2`"),
        ("[system.oscillator]\nomga2 = 1", "1", "unknown parameter `omga2`"),
        ("[start]\nq = [1, 2]", "[1, 2]", "`start.q` has 2 numbers; expected one"),
        ("[start]\nv = []", "[]", "`start.v` has 0 numbers; expected one"),
        ("[spectrum]\ndt = 0", "0", "`spectrum.dt` is 0.0, but it must be finite and greater"),
        ("[spectrum]\ndt = -inf", "-inf", "`spectrum.dt` is -inf"),
        ("[drift]\ndt = [0.1, -0.2]", "-0.2", "`drift.dt` is -0.2, but it must be finite"),
        ("[drift]\ndt = []", "[]", "`drift.dt` must hold at least one time step"),
        ("[drift]\ndt = [0.1, 1e-1]", "1e-1", "time step 0.1 occurs twice in `drift.dt`"),
        ("[drift]\nsteps = 0", "0", "`drift.steps` is 0, but it must be 1 to 1000000000"),
        ("[drift]\nsteps = -5", "-5", "`drift.steps` is -5, but it must be 1 to"),
        ("[drift]\nsteps = 2e9", "2e9", "`drift.steps` is 2000000000"),
        ("[start]\nq = 0", "0", "`start.q` and `start.v` are both 0"),
        ("[start]\nv = inf", "inf", "`start.v` is inf, but it must be finite"),
        ("[start]\nq = 1e200", "1e200", "the energy at `start.q` = 1e200"),
        ("[start]\nq = 1e-200", "1e-200", "the energy at `start.q` = 1e-200"),
        (
            "[convergence]\nsystems = ['pendulum', 'keppler']",
            "'keppler'",
            "unknown system `keppler`",
        ),
        ("[convergence]\nsystems = []", "[]", "`convergence.systems` must name at least one"),
        ("[convergence]\ncoarsest = 40", "40", "must be a multiple of 16 from 16 to 4096"),
        (
            "[nonlinear]\nsystems = ['kepler', \"kepler\"]",
            "\"kepler\"",
            "the system `kepler` is named twice",
        ),
        ("[nonlinear]\nsteps = 3", "3", "`nonlinear.steps` is 3, but it must be 16 to 10000"),
        ("[nonlinear]\nturns = 10", "10", "`nonlinear.turns` is 10, but it must be 100 to"),
        ("[precision]\ndt = [0.01, 0]", "0", "`precision.dt` is 0.0, but it must be finite"),
        ("[precision]\nsteps = 0", "0", "`precision.steps` is 0, but it must be 1 to"),
        ("integrators = []", "[]", "`integrators` must name at least one"),
        ("integrators = ['rk4', \"rk4\"]", "\"rk4\"", "the integrator `rk4` is named twice"),
        ("integrators = ['rk5']", "'rk5'", "unknown integrator `rk5`"),
        ("effort = 'quik'", "'quik'", "unknown effort `quik`"),
        ("studies = ['drft']", "'drft'", "unknown study `drft`"),
    ]);
}

#[test]
fn wrong_types_name_the_key_and_the_type_that_is_needed() {
    assert_errors(&[
        ("system = 3", "3", "`system`: invalid type: integer `3`, expected a table"),
        (
            "[system.oscillator]\nk = '10'",
            "'10'",
            "`system.oscillator.k`: invalid type: string \"10\", expected a",
        ),
        (
            "[spectrum]\ndt = '2 sec'",
            "'2 sec'",
            "`spectrum.dt`: invalid type: string \"2 sec\", expected a number of seconds",
        ),
        ("[drift]\ndt = 0.1", "0.1", "`drift.dt`: invalid type: floating point `0.1`, expected a"),
        (
            "[drift]\ndt = [1, true]",
            "true",
            "`drift.dt`: invalid type: boolean `true`, expected a n",
        ),
        (
            "[drift]\nsteps = 1.5",
            "1.5",
            "`drift.steps`: invalid type: floating point `1.5`, expect",
        ),
        ("effort = 1", "1", "`effort`: invalid type: integer `1`, expected a string"),
        ("studies = 'drift'", "'drift'", "`studies`: invalid type: string \"drift\", expected a"),
    ]);
}

#[test]
fn unknown_keys_are_named_with_the_nearest() {
    let cases = [
        ("[oscillator]\nm = 1", "oscillator", "the table of the oscillator is [system.oscillator]"),
        ("[sistem]", "sistem", "did you mean `system`?"),
        ("[contoller]", "contoller", "did you mean `controller`, which `advise` reads?"),
        ("[drift]\nstep = 1", "step", "did you mean `steps`? the keys are `dt`, `steps`"),
        ("drift.DT = [1]", "DT", "did you mean `dt`?"),
        ("zzz = 1", "zzz", "the keys are `studies`, `effort`, `simd`, `integrators`, `system`"),
    ];
    for (text, place, help) in cases {
        let error = error(text);
        assert_eq!(marked(&error), place, "{error}");
        assert_eq!(error.message(), format!("unknown key `{place}`"));
        assert!(error.help().unwrap().starts_with(help), "{error}");
    }
}

#[test]
fn a_file_of_peers_is_read_before_any_work() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("peers.json");
    let told = || error(&format!("throughput.peers = '{}'", file.display())).message().to_owned();
    assert!(told().contains("peers.json` cannot be read"), "{}", told());
    std::fs::write(&file, "[]").unwrap();
    assert!(told().contains("is not what benches/peers.py writes"), "{}", told());
    let other = json!({
        "schema": "libration.peers/2", "cpu": "abacus", "versions": "", "rounds": 1, "rows": [],
    });
    std::fs::write(&file, other.to_string()).unwrap();
    assert!(told().contains("was measured on `abacus`; this is `"), "{}", told());
    std::fs::write(&file, other.to_string().replace("peers/2", "peers/9")).unwrap();
    assert!(told().contains("it must be `libration.peers/2`"), "{}", told());
    // Those of rollouts are of another kind.
    let told = error(&format!("rollout.peers = '{}'", file.display())).message().to_owned();
    assert!(told.contains("it must be `libration.rollouts/2`"), "{told}");
}

#[test]
fn names_are_suggested() {
    let help = |text: &str| error(text).help().unwrap().to_owned();
    assert!(help("integrators = ['verlet']").starts_with("did you mean `velocity-verlet`?"));
    assert!(help("integrators = ['RK-4']").starts_with("did you mean `rk4`?"));
    assert_eq!(help("effort = ''"), "the efforts are `quick`, `standard`, `thorough`");
    for study in STUDIES.studies {
        let text = format!("studies = ['{}x']", study.name());
        assert!(help(&text).starts_with(&format!("did you mean `{}`?", study.name())), "{text}");
    }
}

#[test]
fn an_error_shows_the_line_with_a_caret_under_it() {
    let shown = error("# spring\n[system.oscillator]\nm = 2.0\nk = -0.0  # N/m\n").to_string();
    let expected = "\
error: `system.oscillator.k` is -0.0, but it must be finite and greater than 0
 --> mine.toml:4:5
  |
4 | k = -0.0  # N/m
  |     ^^^^";
    assert_eq!(shown, expected);
}

#[test]
fn tabs_line_ends_and_wide_characters_do_not_shift_the_caret() {
    // Columns count characters; a tab is one of them, and is shown as four spaces.
    let shown = error("\u{feff}# ∂t\r\n[start]\r\n\tq = \"∂∂\"\t# é\r\n").to_string();
    let expected = "\
error: `start.q`: invalid type: string \"∂∂\", expected a number or a list of numbers
 --> mine.toml:3:6
  |
3 |     q = \"∂∂\"    # é
  |         ^^^^";
    assert_eq!(shown, expected);
}

#[test]
fn broken_syntax_is_shown_where_it_breaks() {
    let shown = error("effort = \"quick\n").to_string();
    let expected = "\
error: invalid basic string, expected `\"`
 --> mine.toml:1:16
  |
1 | effort = \"quick
  |                ^";
    assert_eq!(shown, expected);
    assert!(error("effort = 1\neffort = 2").message().contains("duplicate key"));
}

#[test]
fn bytes_that_are_not_text_are_shown() {
    for start in [&b""[..], b"\xEF\xBB\xBF"] {
        let bytes = [start, b"# \xC3\xA9t\xE9\n[drift]\n"].concat();
        let error = STUDIES.parse_bytes(&bytes, "latin1.toml").unwrap_err();
        assert_eq!(marked(&error), "\u{fffd}");
        assert!(error.to_string().contains("latin1.toml:1:5"), "{error}");
        assert!(error.message().contains("byte 0xE9"), "{error}");
    }
    let utf16 = STUDIES.parse_bytes(b"\xFF\xFE[\0d\0", "wide.toml").unwrap_err();
    assert!(utf16.help().unwrap().contains("UTF-16"), "{utf16}");
    assert_eq!(STUDIES.parse_bytes(b"", "").unwrap(), STUDIES.config());
}

#[test]
fn only_the_styled_error_has_colours() {
    let error = error("zzz = 1");
    assert!(!error.to_string().contains('\x1b'));
    assert!(error.render_styled().contains('\x1b'));
}

#[test]
fn the_schema_describes_every_key() {
    fn assert_described(value: &Value) {
        for (key, property) in value["properties"].as_object().into_iter().flatten() {
            assert!(property["description"].is_string(), "{key}: {property}");
            let ignored = property["description"].as_str().unwrap().ends_with("lab` ignores.");
            assert_eq!(property["default"].is_null(), ignored, "{key}: {property}");
            assert_described(property);
        }
    }
    let schema = STUDIES.schema();
    let keys: BTreeSet<&str> =
        schema["properties"].as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(keys, ConfigCommand::all_keys().collect());
    assert_described(&schema);
}

#[test]
fn studies_that_measure_the_machine_run_only_if_they_are_named() {
    let names = |config: &Config| -> Vec<&str> {
        STUDIES.chosen(config).into_iter().map(|study| study.name()).collect()
    };
    let default = names(&STUDIES.config());
    for name in ["throughput", "memory", "rollout", "storage"] {
        assert!(!default.contains(&name), "{name}");
        let studies = vec![name.to_owned()];
        assert_eq!(names(&Config { studies, ..STUDIES.config() }), [name]);
    }
    assert_eq!(default.len() + 4, STUDIES.studies.len());
}
