//! The systems chosen at run time.

use libration::catalog::{self, Actuation, Allowed, ENTRIES};
use libration::{AnySystem, CatalogError, Model, State, with_system};

fn build(name: &str, parameters: &[(&str, f64)]) -> Result<AnySystem, CatalogError> {
    AnySystem::build(name, parameters)
}

fn defaults(name: &str) -> AnySystem {
    build(name, &[]).unwrap()
}

#[test]
fn every_entry_builds_from_its_defaults_and_has_a_start() {
    fn start<const D: usize>(system: AnySystem, _: impl Model<D>) -> Vec<f64> {
        let start: State<f64, D> = system.entry().start().unwrap();
        start.coordinates().collect()
    }
    for entry in ENTRIES {
        let system = defaults(entry.name);
        assert_eq!(system.name(), entry.name);
        assert!(entry.parameters.iter().all(|p| p.allowed.admits(p.default)), "{}", entry.name);
        for dimension in entry.dimensions.clone() {
            let coordinates = with_system!(
                system,
                dimension,
                |model, D| start::<D>(system, model),
                panic!("{} is missing in dimension {dimension}", entry.name)
            );
            assert_eq!(coordinates.len(), 2 * dimension);
        }
    }
}

#[test]
fn the_parameters_of_a_system_rebuild_it() {
    for entry in ENTRIES {
        // Values other than the defaults.
        let given: Vec<_> = entry
            .parameters
            .iter()
            .filter(|p| p.name != "m" && p.name != "k")
            .map(|p| (p.name, 1.0625 * p.default))
            .collect();
        let system = build(entry.name, &given).unwrap();
        assert_eq!(system.parameters(), given);
        assert_eq!(build(entry.name, &system.parameters()).unwrap(), system);
    }
}

#[test]
fn the_default_oscillator_is_the_reports() {
    assert_eq!(defaults("oscillator").parameters(), [("omega2", 10.0)]);
    let start: State<f64, 3> = catalog::find("oscillator").unwrap().start().unwrap();
    assert_eq!(start, State { q: [1.0; 3], v: [0.0; 3] });
}

#[test]
fn the_default_kepler_orbit_starts_at_perihelion() {
    let AnySystem::Kepler(kepler) = defaults("kepler") else { panic!("not Kepler") };
    let start: State<f64, 2> = catalog::find("kepler").unwrap().start().unwrap();
    assert_eq!(start, kepler.perihelion(0.6));
}

#[test]
fn mass_and_stiffness_make_omega2() {
    for name in ["oscillator", "damped-oscillator", "driven-oscillator"] {
        let omega2 = |given: &[(&str, f64)]| build(name, given).map(|s| s.parameters()[0].1);
        assert_eq!(omega2(&[("m", 4.0), ("k", 0.0)]).unwrap(), 0.0);
        assert_eq!(omega2(&[("k", 3.0)]).unwrap(), 3.0);
        assert_eq!(omega2(&[("k", 3.0), ("m", 2.0)]).unwrap(), 1.5);
        assert_eq!(omega2(&[("omega2", 7.0)]).unwrap(), 7.0);
        for other in ["m", "k"] {
            for given in [[("omega2", 7.0), (other, 1.0)], [(other, 1.0), ("omega2", 7.0)]] {
                let error = omega2(&given).unwrap_err();
                assert!(matches!(error, CatalogError::Conflict { .. }), "{error}");
                assert!(error.to_string().contains(&format!("`{other}`")), "{error}");
            }
        }
        // The default stiffness is that of the report's mass of 1 kg, and of no other.
        let error = omega2(&[("m", 4.0)]).unwrap_err();
        assert!(matches!(error, CatalogError::NoStiffness { .. }), "{error}");
        for (m, k) in [(1e-200, 1e200), (1e200, 1e-200)] {
            let error = omega2(&[("m", m), ("k", k)]).unwrap_err();
            assert!(matches!(error, CatalogError::Quotient { .. }), "{error}");
        }
    }
}

#[test]
fn commands_are_forces_where_mass_or_stiffness_is_given() {
    let of = |given: &[(&str, f64)]| catalog::build("damped-oscillator", given).unwrap();
    let (system, actuation) = of(&[("m", 0.3), ("k", 0.7), ("gamma", 0.1)]);
    assert_eq!(actuation, Actuation::Force { mass: 0.3, stiffness: 0.7 });
    let parameters = actuation.parameters(system);
    assert_eq!(parameters, [("m", 0.3), ("k", 0.7), ("gamma", 0.1)]);
    assert_eq!(of(&parameters), (system, actuation), "to the last bit");
    assert_eq!(of(&[("k", 3.0)]).1, Actuation::Force { mass: 1.0, stiffness: 3.0 });
    for given in [&[("omega2", 2.0)][..], &[]] {
        assert_eq!(of(given).1, Actuation::Acceleration);
    }
}

#[test]
fn values_that_are_not_allowed_are_named() {
    let bad = |allowed| match allowed {
        Allowed::Positive => vec![0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY],
        Allowed::NonNegative => vec![-1.0, f64::NAN, f64::INFINITY],
        Allowed::Finite => vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY],
    };
    for entry in ENTRIES {
        for parameter in entry.parameters {
            for value in bad(parameter.allowed) {
                let error = build(entry.name, &[(parameter.name, value)]).unwrap_err();
                assert!(matches!(error, CatalogError::Value { .. }), "{error}");
                let text = error.to_string();
                for part in [parameter.name, &format!("{value:?}"), &parameter.allowed.to_string()]
                {
                    assert!(text.contains(part), "`{text}` does not mention `{part}`");
                }
            }
        }
    }
}

#[test]
fn errors_say_what_there_is() {
    let unknown = build("penduluum", &[]).unwrap_err();
    assert_eq!(
        unknown.to_string(),
        "unknown system `penduluum`; the systems are `oscillator`, `damped-oscillator`, \
         `driven-oscillator`, `pendulum`, `duffing`, `kepler`, `henon-heiles`"
    );
    assert_eq!(
        build("duffing", &[("gamma", 1.0)]).unwrap_err().to_string(),
        "duffing: unknown parameter `gamma`; its parameters are `alpha`, `beta`"
    );
    assert_eq!(
        build("kepler", &[("mu", 1.0), ("mu", 1.0)]).unwrap_err().to_string(),
        "kepler: parameter `mu` is given twice"
    );
    assert_eq!(
        build("oscillator", &[("k", -3.0)]).unwrap_err().to_string(),
        "oscillator: `k` is -3.0, but it must be finite and at least 0"
    );
    assert_eq!(
        build("oscillator", &[("omega2", 1.0), ("k", 3.0)]).unwrap_err().to_string(),
        "oscillator: `k` cannot be given together with `omega2`, since omega2 = k/m"
    );
    assert_eq!(
        build("oscillator", &[("k", 1e300), ("m", 1e-300)]).unwrap_err().to_string(),
        "oscillator: omega2 = k/m = 1e300/1e-300 is inf, but it must be finite and greater than 0"
    );
    let dimension = |name: &str, d| defaults(name).entry().wrong_dimension(d).to_string();
    assert_eq!(dimension("oscillator", 9), "oscillator: the dimension is 9, but it must be 1 to 8");
    assert_eq!(dimension("kepler", 3), "kepler: the dimension is 3, but it must be 2");
}

#[test]
fn a_system_exists_in_its_dimensions_only() {
    fn dimension<const D: usize>(_: impl Model<D>) -> usize {
        D
    }
    for entry in ENTRIES {
        let system = defaults(entry.name);
        for d in 0..=10 {
            let found = with_system!(system, d, |model, D| Some(dimension::<D>(model)), None);
            assert_eq!(found, entry.dimensions.contains(&d).then_some(d), "{}", entry.name);
        }
    }
}

#[test]
fn linear_and_conservative_systems() {
    let which = |property: fn(AnySystem) -> bool| -> Vec<&str> {
        ENTRIES.iter().map(|e| e.name).filter(|name| property(defaults(name))).collect()
    };
    assert_eq!(which(AnySystem::is_linear), ["oscillator", "damped-oscillator"]);
    assert_eq!(
        which(AnySystem::conserves_energy),
        ["oscillator", "pendulum", "duffing", "kepler", "henon-heiles"]
    );
    let undamped = build("damped-oscillator", &[("gamma", 0.0)]).unwrap();
    assert!(undamped.conserves_energy());
    let driven = build("driven-oscillator", &[("gamma", 0.0)]).unwrap();
    assert!(!driven.conserves_energy());
}
