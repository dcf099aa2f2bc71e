//! No text, however strange, makes the parser of configurations panic or point outside the text.

use libration_lab::STUDIES;
use libration_settings::SettingsError;
use libration_study::Config;
use libration_study_motion::DriftSettings;
use proptest::prelude::*;

/// What holds of every outcome.
fn check(outcome: Result<Config, SettingsError>) -> Result<(), TestCaseError> {
    match outcome {
        Ok(config) => prop_assert_eq!(STUDIES.check(&config), Ok(())),
        Err(error) => {
            // Fails if the span is outside the text or splits a character.
            prop_assert!(error.source_text().get(error.span()).is_some());
            prop_assert!(!error.message().is_empty());
            prop_assert!(error.to_string().contains("name.toml:"), "{}", error);
            prop_assert!(!error.render_styled().is_empty());
        }
    }
    Ok(())
}

/// A piece of a configuration file, or of nonsense.
fn piece() -> impl Strategy<Value = String> {
    let known = "studies|effort|integrators|system|oscillator|omega2|start|drift|convergence|nonlinear|systems|dt|steps|m|k|q|v|rk4";
    prop_oneof![
        known,
        "[\\[\\]{}=.,\"'#\t \r\n\u{feff}]{1,3}",
        any::<f64>().prop_map(|x| x.to_string()),
        any::<i64>().prop_map(|x| x.to_string()),
        Just("nan".to_owned()),
        Just("'''".to_owned()),
        Just("1979-05-27".to_owned()),
        "\\PC{0,4}",
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

    #[test]
    fn arbitrary_text(text in any::<String>()) {
        check(STUDIES.parse(&text, "name.toml"))?;
    }

    #[test]
    fn arbitrary_bytes(bytes in any::<Vec<u8>>()) {
        check(STUDIES.parse_bytes(&bytes, "name.toml"))?;
    }

    #[test]
    fn arbitrary_pieces(pieces in prop::collection::vec(piece(), 0..12)) {
        check(STUDIES.parse(&pieces.concat(), "name.toml"))?;
    }

    #[test]
    fn the_default_with_a_part_replaced(
        at in any::<prop::sample::Index>(),
        length in 0_usize..20,
        piece in piece(),
    ) {
        let default = STUDIES.text();
        let start = at.index(default.len() + 1);
        let end = (start + length).min(default.len());
        let text = format!("{}{piece}{}", &default[..start], &default[end..]);
        check(STUDIES.parse(&text, "name.toml"))?;
        check(STUDIES.parse(&text.replace('\n', "\r\n"), "name.toml"))?;
    }

    #[test]
    fn every_configuration_that_is_allowed_is_read(
        m in 1e-6..1e6, k in 1e-6..1e6, dt in 1e-9..1e3, steps in 1_u64..=1_000_000_000,
    ) {
        let text = format!(
            "system.oscillator = {{ m = {m:?}, k = {k:?} }}\ndrift = {{ dt = [{dt:?}], steps = {steps} }}"
        );
        let config = STUDIES.parse(&text, "").map_err(|e| TestCaseError::fail(e.to_string()))?;
        prop_assert_eq!((config.oscillator.m, config.oscillator.k), (m, k));
        prop_assert_eq!((config.get::<DriftSettings>().dt, config.get::<DriftSettings>().steps), (vec![dt], steps));
    }
}
