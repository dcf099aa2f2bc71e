//! Tests of temperatures of thermostats.

use std::sync::atomic::AtomicBool;

use libration::catalog;
use libration::equations::StepProgram;
use libration::linear::{Matrix, solve_stein};
use libration::number::Dual;
use libration::thermostat::{LangevinMethod, LangevinStep};
use libration_analyze::temperature::{
    TemperatureBias, TemperatureError, TemperatureReport, TemperatureRequest, ThermostatReport,
    analyze_temperature,
};
use libration_settings::equations::EquationSystem;
use libration_work::{Silent, Work};

fn known(name: &str, parameters: &[(&str, f64)], q: Option<&[f64]>) -> EquationSystem {
    let system = catalog::build(name, parameters).unwrap();
    EquationSystem::of_catalogue(system, q, None).unwrap()
}

fn by_equations(text: &str) -> EquationSystem {
    let text = text.replacen("[system]", "[system]\nname = \"test\"", 1);
    EquationSystem::parse(&text, "test", &[]).unwrap()
}

/// Two masses on springs, one a hundred times as heavy, or with a stiffening spring.
fn unequal(beta: f64) -> EquationSystem {
    by_equations(&format!(
        r#"[system]
        coordinates = ["x", "y"]
        parameters = {{ beta = {beta:?} }}
        acceleration.x = "y - 2*x - beta*x^3"
        acceleration.y = "(x - 2*y)/100"
        energy = "x'^2/2 + 50*y'^2 + x^2 + y^2 - x*y + beta*x^4/4"
        start = {{ x = 1.0 }}"#
    ))
}

/// Two coordinates with a mass in common, on springs.
fn coupled() -> EquationSystem {
    by_equations(
        r#"[system]
        coordinates = ["x", "y"]
        acceleration.x = "(-x + 0.5*y)/1.75"
        acceleration.y = "(0.5*x - 2*y)/1.75"
        energy = "x'^2 + y'^2/2 + x'*y'/2 + (x^2 + y^2)/2""#,
    )
}

fn methods(names: &[&str]) -> Vec<LangevinMethod> {
    names.iter().map(|name| name.parse().unwrap()).collect()
}

fn request(system: EquationSystem, dt: f64, names: &[&str]) -> TemperatureRequest {
    let (thermostats, dt) = (methods(names), Some(dt));
    let (temperature, friction, steps, seed) = (0.3, 0.8, 320_000, 5);
    TemperatureRequest { system, temperature, friction, dt, thermostats, steps, seed }
}

/// The report of a system, whatever is measured.
fn report(system: EquationSystem) -> Result<TemperatureReport, TemperatureError> {
    analyzed(&TemperatureRequest { steps: 32, ..request(system, 0.1, &["BAOAB"]) })
}

fn analyzed(request: &TemperatureRequest) -> Result<TemperatureReport, TemperatureError> {
    analyze_temperature(&Work::new(&Silent, &AtomicBool::new(false)), request)
}

#[test]
fn measured_temperatures_of_linear_forces_are_the_predicted_ones() {
    let names = ["BAOAB", "OBABO", "ABOBA", "OABAO", "BAOA", "BABOBAB", "ABO", "gjf"];
    let [report, of_coupled] =
        [unequal(0.0), coupled()].map(|system| analyzed(&request(system, 0.7, &names)).unwrap());
    // Explicit Euler needs short steps.
    let [of_euler, of_coupled_euler] = [unequal(0.0), coupled()].map(|system| {
        let request =
            TemperatureRequest { steps: 2_560_000, ..request(system, 0.2, &["euler-maruyama"]) };
        analyzed(&request).unwrap()
    });
    assert_eq!(of_coupled.mass, [[2.0, 0.5], [0.5, 1.0]]);
    let all = [&report, &of_coupled, &of_euler, &of_coupled_euler];
    for one in all.into_iter().flat_map(|report| &report.thermostats) {
        for (kind, bias) in [("configuration", &one.configuration), ("kinetic", &one.kinetic)] {
            let (predicted, measured) = (bias.predicted_bias.unwrap(), bias.measured_bias.unwrap());
            let error = bias.standard_error.unwrap();
            assert!(error < 0.03, "{} {kind} {error}", one.thermostat);
            // Of 32 trajectories: Student's t beyond 4 in 0.04 % of all cases.
            let off = (measured - predicted).abs() / error;
            assert!(off < 4.0, "{} {kind}: {predicted} {measured} ± {error}", one.thermostat);
        }
    }
    assert_eq!(report.recommended.as_deref(), Some("BAOA"));
    // The system has one valley.
    assert!(report.thermostats.iter().all(|one| one.note.is_none()), "{report:?}");
}

#[test]
fn the_mean_over_modes_is_that_of_the_whole_step_by_steins_equation() {
    let system = unequal(0.0);
    let (dynamics, mass) = (system.equations.dynamics(), [1.0, 100.0]);
    let (n, friction) = (2, 0.8);
    for (name, dt) in
        [("BAOAB", 0.9), ("OABAO", 0.9), ("ABO", 0.9), ("gjf", 0.9), ("euler-maruyama", 0.3)]
    {
        let report = analyzed(&request(system.clone(), dt, &[name])).unwrap();
        let (method, one) = (&methods(&[name])[0], &report.thermostats[0]);
        let step = StepProgram::langevin(method, dynamics).unwrap();
        let numbers = LangevinStep::new(dt, friction, method.noises());
        let LangevinStep { decay, damping, implicit_factor, .. } = numbers;
        let zero = Dual::constant(0.0);
        let mut inputs = vec![zero; 3 * n + 4 + method.noises() * n];
        for (input, x) in inputs[3 * n..].iter_mut().zip([dt, decay, damping, implicit_factor]) {
            *input = Dual::constant(x);
        }
        let slopes = |inputs: &[Dual<f64>]| -> Vec<f64> {
            step.program().on().run(inputs).take(2 * n).map(|x| x.du).collect()
        };
        let columns: Vec<Vec<f64>> = (0..2 * n)
            .map(|j| {
                let mut inputs = inputs.clone();
                inputs[j] = Dual::variable(0.0);
                // The step takes the accelerations at its start.
                let accelerations: Vec<Dual<f64>> =
                    dynamics.accelerations().on().run(&inputs[..2 * n]).collect();
                inputs[2 * n..3 * n].copy_from_slice(&accelerations);
                slopes(&inputs)
            })
            .collect();
        let matrix = Matrix::from_fn(2 * n, 2 * n, |i, j| columns[j][i]);
        let mut noise = Matrix::zeros(2 * n, 2 * n);
        for j in 0..method.noises() * n {
            let mut inputs = inputs.clone();
            inputs[3 * n + 4 + j] = Dual::variable(0.0);
            let column = slopes(&inputs);
            let variance = method.noise_variance(numbers) / mass[j % n];
            let column = Matrix::from_fn(2 * n, 1, |i, _| column[i]);
            noise.add_scaled(variance, &(&column * &column.transposed()));
        }
        let covariance = solve_stein(&matrix, vec![noise]).remove(0);
        // ⟨v·M·v⟩/n, and ⟨q·K·q⟩/n with the springs of the system.
        let stiffness = Matrix::from_rows(&[[2.0, -1.0], [-1.0, 2.0]]).unwrap();
        let mean =
            |form: &Matrix, at: usize| form.inner(&covariance.block((at, at), (n, n))) / n as f64;
        let mass = Matrix::from_rows(&[[mass[0], 0.0], [0.0, mass[1]]]).unwrap();
        let wanted = [mean(&stiffness, 0), mean(&mass, n)].map(|mean| mean - 1.0);
        let found = [&one.configuration, &one.kinetic].map(|bias| bias.predicted_bias.unwrap());
        for (found, wanted) in found.into_iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-10, "{method}: {found} {wanted}");
        }
    }
}

#[test]
fn limits_of_the_time_step_are_those_of_the_closed_forms() {
    let system = known("oscillator", &[("omega2", 4.0)], None);
    let report = analyzed(&request(system, 0.1, &["BAOAB", "OBABO"])).unwrap();
    let [baoab, obabo] = &report.thermostats[..] else { panic!("two thermostats") };
    let near = |found: f64, wanted: f64| {
        assert!((found - wanted).abs() < 1e-9 * wanted, "{found} {wanted}")
    };
    // ω = 2: z = 2 at dt = 1, and 1 % of bias at z²/4 = 0.01 of velocities, at 1/(1 − z²/4) = 1.01 of positions.
    near(baoab.stable_dt, 1.0);
    near(baoab.configuration.accurate_dt, 1.0);
    near(baoab.kinetic.accurate_dt, 0.1);
    near(obabo.configuration.accurate_dt, (0.01_f64 / 1.01).sqrt());
    near(obabo.kinetic.accurate_dt, 1.0);
}

#[test]
fn measurements_show_what_linear_forces_do_not() {
    // A double well, with a barrier of 2.5 kT.
    let well = known("duffing", &[], None);
    let request =
        TemperatureRequest { temperature: 0.1, ..request(well, 0.7, &["ABOBA", "BAOAB"]) };
    let report = analyzed(&request).unwrap();
    let [aboba, baoab] = [0, 1].map(|i| &report.thermostats[i].configuration);
    for one in [aboba, baoab] {
        assert!(one.order.is_none() && one.predicted_bias.unwrap().abs() < 1e-12, "{one:?}");
    }
    let errors = |one: &TemperatureBias| one.measured_bias.unwrap() / one.standard_error.unwrap();
    let note = report.thermostats[1].note.as_ref().unwrap();
    assert!(note.contains("ended in another valley"), "{note}");
    // A simulation in NumPy has −40 % and +1 % ± 1 % with a friction of 1.
    assert!(errors(aboba) < -20.0 && errors(baoab).abs() < 4.0, "{report:?}");
    assert_eq!(report.recommended.as_deref(), Some("BAOAB"));
}

#[test]
fn a_start_descends_to_the_bottom_of_its_valley() {
    // Newton's method alone goes from here to the pendulum that stands up.
    let pendulum = report(known("pendulum", &[], Some(&[2.5]))).unwrap();
    assert!(pendulum.equilibrium[0].abs() < 1e-8, "{:?}", pendulum.equilibrium);
    let left = report(known("duffing", &[], Some(&[-0.1]))).unwrap();
    assert!((left.equilibrium[0] + 1.0).abs() < 1e-8, "{:?}", left.equilibrium);
    assert!((left.frequencies[0] - 2.0_f64.sqrt()).abs() < 1e-8);
}

#[test]
fn the_mass_of_an_oscillator_is_that_of_its_energy() {
    let light = report(known("oscillator", &[("m", 0.25), ("k", 4.0)], None)).unwrap();
    assert_eq!(light.mass, [[0.25]]);
    assert!((light.frequencies[0] - 4.0).abs() < 1e-12);
}

#[test]
fn systems_without_a_stationary_temperature_are_refused_with_the_reason() {
    let reason = |system: EquationSystem| report(system).unwrap_err().to_string();
    let text =
        |rest: &str| by_equations(&format!("[system]\ncoordinates = [\"x\", \"y\"]\n{rest}"));
    for (found, what) in [
        (reason(known("damped-oscillator", &[], None)), "depends on a velocity"),
        (reason(known("driven-oscillator", &[("gamma", 0.0)], None)), "depends on time"),
        (reason(known("kepler", &[], None)), "no equilibrium"),
        (reason(known("duffing", &[], Some(&[0.0]))), "is not stable"),
        (reason(known("oscillator", &[("omega2", 0.0)], None)), "has no stiffness"),
        (
            reason(by_equations(
                "[system]\ncoordinates = [\"x\"]\nacceleration.x = \"-x^3\"\nstart = { x = 1.0 }",
            )),
            "has no stiffness",
        ),
        (
            reason(text("acceleration.x = \"y - x\"\nacceleration.y = \"-y\"")),
            "forces without a potential",
        ),
        (reason(text("acceleration.x = \"-x\"\nacceleration.y = \"-y + t\"")), "depends on time"),
        (
            reason(text(
                "acceleration.x = \"-x\"\nacceleration.y = \"-y\"\nenergy = \"(x'^2 + y'^2 + x^2)/2 + y^2\"",
            )),
            "is not the energy of these accelerations",
        ),
        (
            reason(by_equations(
                "[system]\ncoordinates = [\"x\"]\nrate.i = \"-i\"\nacceleration.x = \"-x\"",
            )),
            "the state `i` of first order",
        ),
    ] {
        assert!(found.contains(what), "{found}");
    }
}

#[test]
fn wrong_numbers_are_refused_before_any_work() {
    let own = || request(unequal(0.0), 0.1, &["BAOAB"]);
    let fails = |request: TemperatureRequest| analyzed(&request).unwrap_err().to_string();
    let hot = fails(TemperatureRequest { temperature: f64::INFINITY, ..own() });
    assert!(hot.starts_with("temperature inf: expected a finite number"), "{hot}");
    let free = fails(TemperatureRequest { friction: 0.0, ..own() });
    assert!(free.contains("without friction no temperature is stationary"), "{free}");
    assert!(fails(TemperatureRequest { dt: Some(-1.0), ..own() }).starts_with("dt -1"));
    let short = fails(TemperatureRequest { dt: Some(1e-300), ..own() });
    assert!(short.starts_with("dt 1e-300: expected at least 2.0291e-7 s"), "{short}");
    assert!(fails(TemperatureRequest { steps: 3, ..own() }).contains("steps 3"));
    assert!(fails(TemperatureRequest { thermostats: vec![], ..own() }).contains("no thermostat"));
}

#[test]
fn what_cannot_be_measured_has_a_note_and_its_prediction() {
    let weak = TemperatureRequest { friction: 1e-6, ..request(unequal(0.0), 0.1, &["BAOAB"]) };
    let report = analyzed(&weak).unwrap();
    let one = &report.thermostats[0];
    assert!(one.note.as_ref().unwrap().contains("remembers its start"), "{one:?}");
    assert!(
        one.configuration.predicted_bias.is_some() && one.configuration.measured_bias.is_none()
    );
    let long = analyzed(&request(unequal(0.0), 5.0, &["BAOAB"])).unwrap();
    assert!(!long.thermostats[0].stable && long.recommended.is_none());
    assert!(long.thermostats[0].note.as_ref().unwrap().contains("not stable"));
}

#[test]
fn an_exact_temperature_has_no_order_at_any_friction() {
    for friction in [1e-9, 1.0, 1e4, 1e9] {
        let own = request(unequal(0.0), 0.5, &["BAOAB", "euler-maruyama"]);
        let report = analyzed(&TemperatureRequest { friction, ..own }).unwrap();
        let orders = |one: &ThermostatReport| [one.configuration.order, one.kinetic.order];
        let found = [0, 1].map(|i| orders(&report.thermostats[i]));
        assert_eq!(found, [[None, Some(2)], [Some(1), Some(1)]], "{friction}");
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_seed_does_not() {
    let own = request(unequal(1.0), 0.4, &["BAOAB"]);
    let first = analyzed(&own).unwrap();
    assert_eq!(first, analyzed(&own).unwrap());
    let other = analyzed(&TemperatureRequest { seed: 6, ..own }).unwrap();
    assert_ne!(first.thermostats, other.thermostats);
}
