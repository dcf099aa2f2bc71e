//! Limits of gains beside closed forms.

use libration_probe::{GainReport, ServoIntegrator, ServosDescription, gains};

pub(crate) fn report(text: &str, dt: f64, substeps: u32, integrator: &str) -> GainReport {
    let description: ServosDescription = serde_json::from_str(text).unwrap();
    let integrator = ServoIntegrator::from_name(integrator).unwrap();
    gains(&description.servos().unwrap(), dt, substeps, integrator, vec![])
}

pub(crate) fn close(found: f64, wanted: f64, tolerance: f64) {
    assert!((found / wanted - 1.0).abs() <= tolerance, "{found:e} {wanted:e}");
}

#[test]
fn the_largest_kp_of_a_joint_is_that_of_its_characteristic_polynomial() {
    // One joint of inertia 2 with kv = 3, steps of 10 ms.
    let (m, kv, h) = (2.0, 3.0, 0.01);
    let text = r#"{"mass": [2], "kp": [100], "kv": [3]}"#;
    // Explicit damper: z = −1 at h²kp/m + 2hkv/m = 4. Implicit damper: at h²kp/m = 4 + 2hkv/m.
    let explicit = (4.0 - 2.0 * h * kv / m) * m / (h * h);
    let implicit = (4.0 + 2.0 * h * kv / m) * m / (h * h);
    for (integrator, wanted) in [
        ("symplectic-euler", explicit),
        ("euler", explicit),
        ("implicitfast", implicit),
        ("implicit", implicit),
    ] {
        let found = report(text, h, 1, integrator);
        // The growth that counts as none, 10⁻⁷.
        close(found.joints[0].largest_kp, wanted, 1e-6);
        close(found.largest_factor * 100.0, wanted, 1e-6);
    }
    // The damping of a joint is implicit in MuJoCo's Euler, that of a servo is not.
    let of_joint = report(r#"{"mass": [2], "kp": [100], "damping": [3]}"#, h, 1, "Euler");
    close(of_joint.joints[0].largest_kp, implicit, 1e-6);
    for unlimited in ["backward-euler", "implicit-midpoint", "damping-stiffness-implicit"] {
        assert_eq!(report(text, h, 1, unlimited).largest_factor, f64::INFINITY, "{unlimited}");
    }
    assert_eq!(report(r#"{"mass": [2], "kp": [100]}"#, h, 1, "explicit-euler").largest_factor, 0.0);
}

#[test]
fn the_heaviest_coupling_limits_equal_servos() {
    // kp < 4 λ_min(M)/h² − 2 kv/h of explicit dampers, as a rigid body has it.
    let (kv, h) = (0.4, 0.005);
    let text = r#"{"mass": [[2, 0.9], [0.9, 0.5]], "kp": [50, 50], "kv": [0.4, 0.4]}"#;
    let least = (2.5 - (1.5_f64 * 1.5 + 4.0 * 0.81).sqrt()) / 2.0;
    let wanted = 4.0 * least / (h * h) - 2.0 * kv / h;
    close(report(text, h, 1, "symplectic-euler").largest_factor * 50.0, wanted, 1e-6);
}

#[test]
fn the_fewest_substeps_are_those_of_the_limit() {
    // ωh = 2 without damping: kp = 10⁶, m = 1 needs h < 2 ms, so 3 substeps of 5 ms.
    let found = report(r#"{"mass": [1], "kp": [1e6]}"#, 0.005, 1, "symplectic-euler");
    assert_eq!((found.holds, found.fewest_substeps), (false, Some(3)));
    assert!(report(r#"{"mass": [1], "kp": [1e6]}"#, 0.005, 3, "symplectic-euler").holds);
    let others = found.answer.split_once("They hold with").unwrap().1;
    assert!(others.contains("backward-euler") && !others.contains("rk4"), "{others}");
    close(found.joints[0].turn, 5.0, 1e-12);
    close(found.joints[0].largest_turn, 2.0, 1e-6);
}

#[test]
fn servos_that_are_wrong_are_refused_with_the_name_of_the_field() {
    for (text, part) in [
        (
            r#"{"mass": [[1, 2], [2, 1]], "kp": [1, 1]}"#,
            "is not positive definite: its least eigenvalue is -1.0000",
        ),
        (
            r#"{"mass": [[1, 2], [0, 1]], "kp": [1, 1]}"#,
            "is not symmetric: 2 and 0 for `joint 1` and `joint 2`",
        ),
        (
            r#"{"mass": [1, 0], "kp": [1, 1]}"#,
            "`mass` is 0 for `joint 2`; expected numbers above 0",
        ),
        (r#"{"mass": [1, 1], "kp": [1]}"#, "`kp` has 1 number;"),
        (r#"{"mass": [], "kp": []}"#, "1 to 50 joints"),
        (r#"{"mass": [1], "kp": [1], "joints": ["a", "b"]}"#, "`joints` has 2 names"),
        (r#"{"mass": [1, 1], "kp": [1, 1], "joints": ["a", "a"]}"#, "have the name `a`"),
        (r#"{"mass": [1, 1], "kp": [1, 1], "joints": ["a", "a'"]}"#, "have the name `a'`"),
    ] {
        let description: ServosDescription = serde_json::from_str(text).unwrap();
        let error = description.servos().unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn a_motion_that_grows_in_continuous_time_is_no_fault_of_the_step() {
    // s² = −k/m = 4.
    let found = report(r#"{"mass": [1], "kp": [-4]}"#, 0.001, 1, "rk4");
    close(found.growth_in_continuous_time.unwrap(), 2.0, 1e-12);
    assert!(
        found.answer.starts_with("The motion is unstable in continuous time"),
        "{}",
        found.answer
    );
    let free = report(r#"{"mass": [1, 2], "kp": [0, 5]}"#, 0.001, 1, "symplectic-euler");
    assert_eq!((free.growth_in_continuous_time, free.holds), (None, true));
}

#[test]
fn gains_that_are_too_small_beside_a_negative_stiffness_hold_within_a_window() {
    // kp > 5 of the stiffness, and h²(kp − 5)/m + 2hkv/m < 4.
    let found = report(
        r#"{"mass": [1], "kp": [3], "kv": [0.5], "stiffness": [-5]}"#,
        0.01,
        1,
        "symplectic-euler",
    );
    close(found.least_factor * 3.0, 5.0, 1e-6);
    close(found.largest_factor * 3.0, 5.0 + (4.0 - 2.0 * 0.01 * 0.5) / 1e-4, 1e-6);
    assert!(found.answer.contains("gains of position hold from 1.6667 to"), "{}", found.answer);
}

#[test]
fn the_first_screen_has_the_verdict_the_limits_and_commands_with_other_options() {
    let servos = r#"{"mass": [0.02, 0.01], "kp": [400, 300], "kv": [2, 1]}"#;
    let mut held = report(servos, 0.005, 1, "implicitfast");
    assert!(held.answer.contains("with damping-implicit (implicitfast) and"), "{}", held.answer);
    held.repeat_command = "libration gains --dt 0.005".into();
    let page = libration_probe::gains_page(&held);
    for part in [
        "<h1>The gains hold</h1>",
        "largest kp of joint 2; given 300",
        "kp 300 of 2000",
        "Keep kp of joint 2 below 2000",
    ] {
        assert!(page.contains(part), "{part}");
    }
    let mut broken = report(&servos.replace("400", "40000"), 0.005, 1, "implicitfast");
    broken.repeat_command = "libration gains --dt 0.005 --integrator implicitfast".into();
    let page = libration_probe::gains_page(&broken);
    assert!(page.contains("<h1>The gains do not hold</h1>"));
    let action = page.split_once("Take at least 4 substeps").unwrap().1;
    assert!(
        action.contains("--substeps</span> 4") && action.contains("damping-stiffness-implicit")
    );
}

#[test]
fn numbers_of_any_size_have_a_few_digits() {
    let stiff = report(r#"{"mass": [1], "kp": [1e9]}"#, 0.01, 1, "symplectic-euler");
    // Below 4/h² of 10⁹: a limit is not rounded up.
    let part = "the largest gains of position are 3.9999·10⁻⁵ times the given ones";
    assert!(stiff.answer.contains(part), "{}", stiff.answer);
    let endless = report(r#"{"mass": [1], "kp": [1e300]}"#, 0.01, 1, "symplectic-euler");
    assert!(
        endless.answer.contains("a mode grows by a factor 10²⁹⁶ per step"),
        "{}",
        endless.answer
    );
    // 4/h².
    assert!(endless.answer.contains("gain must stay below 40\u{202f}000"), "{}", endless.answer);
    let held: Vec<&str> =
        endless.integrators.iter().filter(|row| row.holds).map(|row| row.name).collect();
    assert!(!held.contains(&"explicit-euler") && held.contains(&"implicit-midpoint"), "{held:?}");
    assert!(endless.answer.len() < 800, "{}", endless.answer);
    // Without a frequency there is no largest one.
    for text in [r#"{"mass": [1], "kp": [0]}"#, r#"{"mass": [1], "kp": [0], "kv": [3]}"#] {
        let free = report(text, 0.01, 1, "symplectic-euler");
        assert!(free.joints[0].largest_turn.is_nan());
        let page = libration_probe::gains_page(&free);
        assert!(
            !page.contains("NaN") && page.contains("1 joint ·") && page.contains("1 substep of")
        );
        assert!(serde_json::to_value(&free).unwrap()["joints"][0]["largest_turn"].is_null());
    }
}

#[test]
fn both_factors_of_a_real_pair_are_shown_and_the_larger_one_is_that_of_the_answer() {
    for (kp, dt) in [(400.0, 0.1), (400.0, 0.02), (5000.0, 0.01), (90.0, 0.5), (1e4, 0.005)] {
        let text = format!(r#"{{"mass": [0.02], "kp": [{kp}]}}"#);
        let found = report(&text, dt, 1, "symplectic-euler");
        // z² − (2 − a) z + 1 = 0 with a = kp dt²/M.
        let half = 1.0 - kp * dt * dt / 0.04;
        let mode = &found.modes[0];
        if half.abs() <= 1.0 {
            assert_eq!(mode.radii.len(), 1, "{:?}", mode.radii);
            continue;
        }
        let largest = half.abs() + (half * half - 1.0).sqrt();
        close(mode.radii[0], largest, 1e-9);
        close(mode.radii[1], 1.0 / largest, 1e-9);
        close(mode.radius, found.spectral_radius, 1e-9);
        // It takes damping away.
        assert!(mode.numerical_damping.unwrap() < 0.0);
    }
    let coupled = r#"{"mass": [[2, 0.9], [0.9, 0.5]], "kp": [5000, 5e4], "kv": [3, 1]}"#;
    let found = report(coupled, 0.02, 1, "symplectic-euler");
    let largest = found.modes.iter().map(|mode| mode.radius).fold(0.0, f64::max);
    close(largest, found.spectral_radius, 1e-9);
}

#[test]
fn the_largest_kv_is_that_of_its_characteristic_polynomial() {
    let (m, h) = (2.0, 0.01);
    for kp in [0.0, 100.0, 3e4] {
        let text = format!(r#"{{"mass": [2], "kp": [{kp}], "kv": [3]}}"#);
        // z = −1 at h²kp/m + 2hkv/m = 4: without kp at kv = 2m/h.
        let wanted = (4.0 - h * h * kp / m) * m / (2.0 * h);
        for integrator in ["symplectic-euler", "euler"] {
            close(report(&text, h, 1, integrator).joints[0].largest_kv, wanted, 1e-6);
        }
        let implicit = report(&text, h, 1, "implicitfast");
        assert_eq!(implicit.joints[0].largest_kv, f64::INFINITY);
    }
    // A gain that is not there has a limit, too, and one beyond it is the reason.
    let none = report(r#"{"mass": [2], "kp": [100]}"#, h, 1, "symplectic-euler");
    close(none.joints[0].largest_kv, (4.0 - h * h * 50.0) * m / (2.0 * h), 1e-6);
    let beyond = report(r#"{"mass": [2], "kp": [0], "kv": [500]}"#, h, 1, "symplectic-euler");
    assert!(!beyond.holds && beyond.joints[0].largest_kp == 0.0);
    assert!(!beyond.answer.contains("no larger gain"), "{}", beyond.answer);
    assert!(
        beyond.answer.contains("of velocity of joint 1 must stay below 400;"),
        "{}",
        beyond.answer
    );
}

#[test]
fn a_step_that_a_spring_of_a_joint_makes_unstable_is_not_blamed_on_a_servo() {
    for (stiffness, damping) in
        [("1e6", "0"), ("5e4", "30"), ("0", "500"), ("4.1e4", "0"), ("1e9", "1")]
    {
        let text = format!(
            r#"{{"mass": [1, 1], "kp": [10, 10], "stiffness": [0, {stiffness}], "damping": [0, {damping}]}}"#
        );
        let found = report(&text, 0.01, 1, "symplectic-euler");
        assert!(found.unstable_without_servos && !found.holds);
        let answer = &found.answer;
        assert!(answer.starts_with("The step is unstable without any servo"), "{answer}");
    }
    let of_servo = report(r#"{"mass": [1], "kp": [1e6], "stiffness": [10]}"#, 0.01, 1, "rk4");
    assert!(!of_servo.unstable_without_servos && of_servo.answer.contains("do not hold"));
}

#[test]
fn held_torques_have_the_limits_of_a_constant_force_over_all_substeps() {
    // n substeps of kick and drift under a constant force: q' = q + dt v + c dt² F/m, v' = v + dt F/m with c = (n + 1)/(2n).
    let (m, kv, dt) = (0.02_f64, 0.8_f64, 0.005_f64);
    for n in [1_u32, 2, 4, 10] {
        let text = format!(r#"{{"mass": [{m}], "kp": [1], "kv": [{kv}], "torque": "held"}}"#);
        let found = report(&text, dt, n, "symplectic-euler");
        let c = (f64::from(n) + 1.0) / (2.0 * f64::from(n));
        let d = kv * dt / m;
        // det < 1 and 1 + trace + det > 0 of [[1 − ac, dt (1 − dc)], [−a/dt, 1 − d]], a = kp dt²/m.
        let of_determinant = if n == 1 { f64::INFINITY } else { d / (1.0 - c) };
        let of_trace = if c > 0.5 { (4.0 - 2.0 * d) / (2.0 * c - 1.0) } else { f64::INFINITY };
        let wanted = of_determinant.min(of_trace) * m / (dt * dt);
        close(found.joints[0].largest_kp, wanted, 1e-6);
        assert!(
            found.answer.contains("torques computed once per step and held"),
            "{}",
            found.answer
        );
        let anew = report(&text.replace("held", "each-substep"), dt, n, "symplectic-euler");
        let h = dt / f64::from(n);
        close(anew.joints[0].largest_kp, (4.0 - 2.0 * h * kv / m) * m / (h * h), 1e-6);
        if n > 1 {
            assert!(anew.answer.contains("computed anew in each substep"), "{}", anew.answer);
        }
    }
}

#[test]
fn a_verdict_of_a_servo_model_says_what_it_does_not_have() {
    for text in [r#"{"mass": [1], "kp": [10]}"#, r#"{"mass": [1], "kp": [1e9]}"#] {
        let found = report(text, 0.01, 1, "symplectic-euler");
        assert_eq!(found.verdict.is_good(), found.holds);
        assert!(found.verdict.not_examined[0].contains("contacts"));
        assert_eq!(
            serde_json::to_value(&found).unwrap()["verdict"]["not_examined"][0],
            found.verdict.not_examined[0]
        );
    }
}
