//! Loops with periods, plants and horizons at the ends of what numbers hold.

use super::loop_verdicts::{json, output, plant, words};

/// The plant grows by `e⁵⁰ = 5.185·10²¹` in a period, and `f64` has 16 digits.
#[test]
fn a_plant_that_outgrows_the_digits_of_a_float_has_an_unknown_loop_and_no_limits() {
    let folder = tempfile::tempdir().unwrap();
    let growing = plant(&folder, "growing.toml", "a = [[1.0]]\nb = [[1.0]]\n");
    let doubling = "a = [[1e20]]\nb = [[1.0]]\nsampling-period = 0.1\n";
    let doubling = plant(&folder, "doubling.toml", doubling);
    for (command, factor) in [
        (format!("advise --plant {growing} --lqr 1/1 --period 50"), "5.185e21"),
        (format!("analyze --plant {growing} --lqr 1/1 --period 50"), "5.185e21"),
        (format!("advise --plant {doubling} --lqr 1/1"), "1e20"),
    ] {
        let text = words(&output(&command, 1)).join(" ");
        assert!(text.starts_with("It is unknown whether the loop is stable"), "{text}");
        assert!(text.contains(&format!("the plant alone grows by the factor {factor}")), "{text}");
        assert!(!text.contains("stable up to"), "{text}");
    }
    // Growth that no command takes away is known.
    let text = output(&format!("advise --plant {growing} --gain 0 --period 50"), 1);
    assert!(text.starts_with("The loop is unstable"), "{text}");
}

/// A mode of factor −1 per period has no plant in continuous time, and no limit asks for one.
#[test]
fn a_sampled_plant_with_an_alternating_mode_has_limits() {
    let folder = tempfile::tempdir().unwrap();
    let text = "a = [[0.5, 0], [0, -1.0]]\nb = [[1], [1]]\nsampling-period = 0.1\n";
    let path = plant(&folder, "alternating.toml", text);
    let found = json(&format!("advise --plant {path} --lqr 1,1/1"), 0);
    assert_eq!(found["verdict"]["outcome"], "stable");
    // NumPy: the spectral radius is 0.4375, and with a latency of a period 1.3315.
    let latency = &found["budgets"][0];
    assert_eq!(latency["kind"], "latency");
    assert_eq!(latency["stable_up_to"], 0.0, "{latency}");
}

#[test]
fn a_loop_is_simulated_for_a_period_or_more_and_says_for_how_long() {
    let loop_of = "advise --system oscillator --set omega2=1e-20 --feedback 1e-20,1e-10";
    let text = words(&output(&format!("{loop_of} --period 1e9"), 0)).join(" ");
    assert!(text.contains(" over 1000000000 s."), "{text}");
    assert!(text.contains("for 1000000000 s instead of the 10 s of the request"), "{text}");
}
