//! Settings of data sets.

use libration_env::dataset::parse;

#[test]
fn one_number_is_an_interval_of_no_length() {
    let of = |start: &str| parse(&format!("[start]\n{start}"), "set.toml");
    let interval = of("q = [0.5, 0.5]\nv = [-1.0, -1.0]").unwrap();
    assert_eq!(of("q = [0.5]\nv = -1").unwrap(), interval);
    assert_ne!(of("q = [0.5, 0.6]\nv = -1").unwrap(), interval);
    let error = of("q = [1, 2, 3]").unwrap_err().to_string();
    assert!(error.contains("`start.q` has 3 numbers; expected one, or the two ends"), "{error}");
}

#[test]
fn a_latency_is_whole_steps_of_the_integrator_whatever_its_unit_and_a_float_type_has_two_names() {
    let of = |text: &str| parse(&format!("dt = \"10ms\"\n{text}"), "set.toml");
    let seconds = of("dtype = 'f64'\n[delays]\naction = [0.03, 0.03]\nobservation = [0.0, 0.07]");
    let units = of("dtype = 'float64'\n[delays]\naction = '30ms'\nobservation = [0, '7e4us']");
    // 0.07 and 0.03 are no multiples of 0.01 in doubles.
    assert_eq!(units.unwrap(), seconds.unwrap());
    let fault = |text: &str| of(text).unwrap_err().to_string();
    let found = fault("[delays]\naction = 0.0300001");
    assert!(found.contains("3.00001 steps of 0.01 s, but it must be whole steps"), "{found}");
    assert!(fault("[delays]\naction = nan").contains("it must be finite"));
    assert!(fault("[delays]\naction = '40.97s'").contains("at most 4096"));
    for former in ["float = 'f64'", "environments = 2", "limit = 3", "[chunk]\nenvironments = 2"] {
        assert!(fault(former).contains("did you mean"), "{former}");
    }
}
