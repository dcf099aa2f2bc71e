//! Operating points of systems by equations in answers of `analyze`.

use super::linear::written;

/// The answer on one line, since lines break where they are full.
fn answer(equations: &str, more: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("[system]\nname = \"own\"\n{equations}\n");
    let path = written(&folder, "own.toml", &text);
    let option = if more.is_empty() { "--plant" } else { "--system" };
    let words = [&["analyze", option, path.to_str().unwrap()], more].concat();
    let mut command = assert_cmd::Command::cargo_bin("libration").unwrap();
    let done = command.args(&words).output().unwrap();
    let text = String::from_utf8(done.stdout).unwrap();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

const RK4: [&str; 6] = ["--integrator", "rk4", "--dt", "0.01", "--steps", "100"];

#[test]
fn modes_are_said_with_the_place_and_the_continuum_of_their_equilibrium() {
    let body = "rate.a = \"-b*c\"\nrate.b = \"a*c\"\nrate.c = \"-a*b/3\"\n\
                start = { a = 0.01, b = 1, c = 0.01 }";
    let text = answer(body, &[]);
    for part in [
        "linearised at a = 0, b = 0.99",
        "0.0141 away from the start",
        // b/√3.
        "is unstable: a mode grows at 0.577",
        "Equilibria form a continuum of 1 dimension there.",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!text.contains("e-3") && !text.contains("e30"), "{text}");
}

#[test]
fn a_linearisation_of_zero_has_no_rates_and_no_stable_steps() {
    let text = answer("rate.x = \"-x^3\"\nstart = { x = 1 }", &[]);
    assert!(text.contains("The stability of the plant"), "{text}");
    assert!(text.contains("is unknown: the linearisation is zero to rounding"), "{text}");
    assert!(!text.contains("decays at") && !text.contains("up to"), "{text}");
}

#[test]
fn stable_steps_along_the_motion_stand_beside_those_at_the_equilibrium() {
    let pair = "rate.a = \"-1000*a*b\"\nrate.b = \"1000*a*b\"\nstart = { a = 1, b = 0.001 }";
    let text = answer(pair, &RK4);
    // 2.785294/1001.
    assert!(text.contains("along the motion stable up to 0.002782 s"), "{text}");
    assert!(text.contains("; dt exceeds it"), "{text}");
    assert!(text.contains("linearised at a = 1.001, b = 0"), "{text}");
}

#[test]
fn a_gyroscopic_plant_without_growth_is_not_said_to_grow() {
    let turning = "coordinates = [\"x\", \"y\"]\nacceleration.x = \"-10*x + y'\"\n\
                   acceleration.y = \"-10*y - x'\"\nstart = { x = 1 }";
    let text = answer(turning, &[]);
    assert!(!text.contains("grows:") && !text.contains("as a mode of the plant grows"), "{text}");
    let never = text.split("never stable: ").nth(1).unwrap_or_default();
    assert!(never.contains("symplectic-euler") && never.contains("velocity-verlet"), "{text}");
}

#[test]
fn a_mass_on_a_stiff_spring_in_the_plane_has_an_equilibrium() {
    for stiffness in ["400", "1e6"] {
        let spring = |own: &str| format!("-{stiffness}*{own}*(1 - 1/sqrt(x^2 + y^2))");
        let equations = format!(
            "coordinates = [\"x\", \"y\"]\nacceleration.x = \"{}\"\nacceleration.y = \"{} - 9.81\"\n\
             start = {{ x = 1, y = 0 }}",
            spring("x"),
            spring("y")
        );
        let text = answer(&equations, &[]);
        assert!(text.contains("linearised at x = 0, y = "), "{text}");
    }
}
