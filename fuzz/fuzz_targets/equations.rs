//! No bytes make the reader of equations panic, or what follows from equations.

#![no_main]

use libfuzzer_sys::fuzz_target;
use libration_settings::equations::EquationSystem;
use libration_settings::linear_loop::linearised_equations;

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    match EquationSystem::parse(&text, "fuzz.toml", &[]) {
        Ok(system) => {
            let start = system.start();
            let rates = system.equations.dynamics().accelerations().on::<f64>().run(&start).count();
            assert_eq!(rates, system.equations.degrees().len());
            let _ = linearised_equations(&system);
        }
        Err(error) => assert!(!error.render_styled().is_empty()),
    }
});
