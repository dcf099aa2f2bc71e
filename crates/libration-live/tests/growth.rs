//! Growth that is measured on steps of a system is that which theory predicts.

use libration_live::{Answer, answer};

const PENDULUM: &str = "coordinates=q\nacceleration.q=-9.81*sin(q)\nenergy=q'^2/2-9.81*cos(q)\nstart.q=1\nhorizon=20\n";
const POLE: &str = "coordinates=q\ninputs=u\nacceleration.q=9.81*sin(q)+u\nstart.q=0.1\nintegrator=rk4\nhorizon=5\ngain=30,8\n";

fn ask(kind: &str, setting: &str) -> Answer {
    let answer = answer(&format!("{kind}\n{setting}"));
    assert_eq!(answer.get_text("error"), "", "{setting}");
    answer
}

fn number(answer: &Answer, name: &str) -> f64 {
    answer.get(name)[0]
}

#[test]
fn measured_growth_of_steps_is_the_logarithm_of_their_spectral_radius() {
    for (integrator, dt) in [
        ("velocity-verlet", 0.05),
        ("velocity-verlet", 0.7),
        ("explicit-euler", 0.01),
        ("rk4", 0.1),
        ("rk4", 0.5),
        ("gauss-legendre-4", 0.1),
        ("suzuki4", 0.3),
    ] {
        let view = ask("view", &format!("{PENDULUM}integrator={integrator}\ndt={dt}\n"));
        let [predicted, measured] =
            ["growth.predicted", "growth.measured"].map(|x| number(&view, x));
        // Deviations up to 0.001 are linear to 1e-7; maxima of swings are met to within a step.
        let tolerance = 1e-4 * predicted.abs() + 1e-6;
        assert!(
            (predicted - measured).abs() < tolerance,
            "{integrator} {dt}: {predicted} {measured}"
        );
    }
}

#[test]
fn measured_growth_of_a_loop_is_that_of_its_period_matrix() {
    for (period, latency, skew, dt) in [
        (0.01, 0.0, 0.0, 0.01),
        (0.02, 0.03, 0.0, 0.005),
        (0.05, 0.1, 0.0, 0.01),
        (0.05, 0.1, 0.2, 0.01),
        (0.05, 0.13, 0.0, 0.01),
        // Two thousand steps of explicit Euler would not be those of the plant.
        (0.05, 0.07, 0.0, 0.05),
    ] {
        for integrator in ["rk4", "explicit-euler"] {
            let view = ask(
                "view",
                &format!(
                    "{POLE}integrator={integrator}\nperiod={period}\nlatency={latency}\nskew={skew}\ndt={dt}\n"
                ),
            );
            let [predicted, measured] =
                ["growth.predicted", "growth.measured"].map(|x| number(&view, x));
            let tolerance = 1e-4 * predicted.abs() + 1e-6;
            assert!(
                (predicted - measured).abs() < tolerance,
                "{integrator} {period} {latency}: {predicted} {measured}"
            );
        }
    }
}

#[test]
fn mean_squares_under_jitter_grow_as_predicted_to_within_their_standard_error() {
    for (jitter, latency) in [(0.1, 0.05), (0.2, 0.08), (0.3, 0.02)] {
        let view = ask(
            "view",
            &format!("{POLE}period=0.05\ndt=0.01\nlatency={latency}\njitter={jitter}\n"),
        );
        let [predicted, measured, error] =
            ["growth.predicted", "growth.measured", "growth.error"].map(|x| number(&view, x));
        assert!(error > 0.0 && error < 0.3, "{error}");
        // Four standard errors of eight groups, and 1 %: the logarithm of a mean over few loops is below that of the mean.
        let tolerance = 4.0 * error + 0.01 * predicted.abs();
        assert!(
            (predicted - measured).abs() < tolerance,
            "{jitter}: {predicted} {measured} {error}"
        );
    }
}

#[test]
fn largest_stable_steps_are_those_of_textbooks() {
    let omega = 9.81_f64.sqrt();
    for (integrator, expected) in [
        ("explicit-euler", 0.0),
        ("symplectic-euler", 2.0),
        ("velocity-verlet", 2.0),
        // The region of stability of RK4 ends at 2√2 on the imaginary axis.
        ("rk4", 8.0_f64.sqrt()),
        ("implicit-midpoint", f64::INFINITY),
    ] {
        let limits = ask("limits", &format!("{PENDULUM}integrator={integrator}\ndt=0.1\n"));
        let product = omega * number(&limits, "dt.stable");
        // A spectral radius of 1 + 1e-9 counts as 1: z⁶/144 short of 2√2 it is a derivative of 1.6.
        assert!(
            product == expected || (product - expected).abs() < 1e-8,
            "{integrator}: {product}"
        );
    }
}

#[test]
fn a_loop_is_stable_up_to_the_latency_that_its_limits_tell() {
    let limits = ask("limits", &format!("{POLE}period=0.05\ndt=0.01\n"));
    let limit = number(&limits, "latency.to");
    assert_eq!(limits.get("latency.from"), [0.0]);
    let measured = |latency: f64| {
        number(
            &ask("view", &format!("{POLE}period=0.05\ndt=0.01\nlatency={latency}\n")),
            "growth.measured",
        )
    };
    assert!(measured(0.99 * limit) < -1e-3 && measured(1.01 * limit) > 1e-3, "{limit}");
}

#[test]
fn a_loop_that_is_stable_again_beyond_a_latency_has_a_window_there() {
    let loop_at = |latency: f64| format!("{POLE}period=0.3\ndt=0.01\nlatency={latency}\n");
    let limits = ask("limits", &loop_at(0.0));
    let windows: Vec<[f64; 2]> = limits
        .get("latency.from")
        .iter()
        .zip(limits.get("latency.to"))
        .map(|(from, to)| [*from, *to])
        .collect();
    assert!(!windows.is_empty() && windows[0][0] > 0.0, "{windows:?}");
    for latency in [0.5 * windows[0][0], 0.5 * (windows[0][0] + windows[0][1])] {
        let growth = number(&ask("view", &loop_at(latency)), "growth.measured");
        assert_eq!(growth < 0.0, latency > windows[0][0], "{latency}: {growth}");
    }
}

#[test]
fn the_largest_change_of_the_energy_is_predicted_from_shorter_steps() {
    let view = ask("view", &format!("{PENDULUM}integrator=velocity-verlet\ndt=0.05\n"));
    let [predicted, measured] = ["energy.predicted", "energy.largest"].map(|x| number(&view, x));
    // The next term of the error is of the square of ωΔt/2: 0.006.
    assert!((predicted / measured - 1.0).abs() < 0.006, "{predicted} {measured}");
}

#[test]
fn a_map_is_zero_where_the_largest_stable_step_is() {
    let setting = format!("{PENDULUM}integrator=velocity-verlet\ndt=0.05\n")
        .replace("9.81", "g")
        .replace("start.q", "parameter.g=9.81\nstart.q");
    for g in [1.0, 30.0_f64] {
        let limit = 2.0 / g.sqrt();
        let row = ask(
            &format!("map dt {:?},{:?} parameter.g {g:?}", 0.999 * limit, 1.001 * limit),
            &setting,
        );
        let rates = row.get("growth");
        assert!(rates[0].abs() < 1e-9 && rates[1] > 0.01, "{g}: {rates:?}");
        let turned = ask(&format!("map parameter.g {g:?} dt {:?}", 1.001 * limit), &setting);
        assert_eq!(turned.get("growth")[0], rates[1]);
    }
}

#[test]
fn what_cannot_be_shown_is_refused_with_a_reason() {
    for (setting, reason) in [
        ("coordinates=q\nacceleration.q=-r*q\n", "acceleration.q: unknown name `r`"),
        ("", "coordinates: "),
        ("coordinates=q\nacceleration.q=-q\ngain=1,1\n", "the system has no input"),
        ("coordinates=q\ninputs=u\nacceleration.q=-q+u\ngain=1\n", "gain = 1 × 1; expected 1 × 2"),
        ("coordinates=q\ninputs=u\nacceleration.q=1+u\ngain=1,1\n", "no equilibrium found"),
        (
            "coordinates=q\ninputs=u\nacceleration.q=-q+u\ngain=1,1\nlatency=1\n",
            "latency = 1 s; expected at most 64 periods",
        ),
        ("coordinates=q\nacceleration.q=-q\nstart.p=1\n", "unknown key `start.p`"),
    ] {
        for kind in ["view", "limits"] {
            let answer = answer(&format!("{kind}\n{setting}"));
            assert!(
                answer.get_text("error").starts_with(reason),
                "{kind} {setting}: {}",
                answer.get_text("error")
            );
        }
    }
    assert_eq!(
        answer("look\ncoordinates=q\nacceleration.q=-q\n").get_text("error"),
        "unknown key `look`"
    );
}

#[test]
fn latencies_of_a_loop_whose_motion_in_a_period_is_beyond_floats_are_unknown_and_not_unstable() {
    let fast = POLE.replace("9.81*sin(q)", "1e6*q");
    let limits = ask("limits", &format!("{fast}period=1\ndt=0.01\n"));
    assert!(limits.get("latency.from").len() == 1 && number(&limits, "latency.from").is_nan());
    assert!(number(&limits, "latency.to").is_nan());
}
