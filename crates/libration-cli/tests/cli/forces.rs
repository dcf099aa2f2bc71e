//! Commands as forces on a mass that is given, and as accelerations where none is.

use predicates::prelude::*;
use serde_json::{Value, json};

use super::advise;
use super::rollout::{contents, settings, write};

/// A joint with an inertia of 0.05, as good as without a spring, under a PD loop: gains as forces.
const JOINT: &str = "--system oscillator --set m=0.05 --set k=0 --q 0 --feedback 400,20";
/// The same loop, with gains per mass.
const PER_MASS: &str = "--system oscillator --set omega2=0 --q 0 --feedback 8000,400";

/// The latency up to which it is stable at a period of 2 ms: where the spectral radius of its loop with split steps, by
/// `numpy.linalg.eigvals`, passes 1.
const STABLE_UP_TO: f64 = 0.0029822497912501615;

fn answer(words: &str) -> Value {
    advise::json(&words.split_whitespace().collect::<Vec<_>>())
}

#[test]
fn gains_are_forces_where_a_mass_is_given_and_accelerations_where_none_is() {
    for (system, command, units) in
        [(JOINT, "force", ["N/m", "N·s/m"]), (PER_MASS, "acceleration", ["s⁻²", "s⁻¹"])]
    {
        let advice = answer(&format!("advise -q {system} --period 0.002 --latency 0.001"));
        let looped = &advice["loop"];
        let limit = looped["budgets"][0]["stable_up_to"].as_f64().unwrap();
        // A bisection of eigenvalues that are good to 1e-13.
        assert!((limit / STABLE_UP_TO - 1.0).abs() < 1e-11, "{limit}");
        assert_eq!(looped["command"], command);
        assert_eq!(looped["gain_units"], json!(units));
        let controller = looped["controller"].as_str().unwrap();
        assert!(units.iter().all(|unit| controller.contains(unit)), "{controller}");

        let step = answer(&format!("analyze {system} --integrator exact --dt 0.002"));
        assert_eq!(step["feedback_units"], json!(units));
        assert_eq!(step["command"], command);
        let split = step["critical_latency_split_steps"].as_f64().unwrap() * 0.002;
        assert!((split / STABLE_UP_TO - 1.0).abs() < 1e-11, "{split}");
    }
}

#[test]
fn the_continuous_margin_of_a_free_mass_is_that_of_the_double_integrator() {
    // ω_c² = (K_d² + √(K_d⁴ + 4K_p²))/2 is where |K_p + iωK_d| = ω², and the margin is atan(K_d·ω_c/K_p)/ω_c.
    let (kp, kd) = (8000.0_f64, 400.0_f64);
    let crossing = (0.5 * (kd * kd + (kd.powi(4) + 4.0 * kp * kp).sqrt())).sqrt();
    let wanted = (kd * crossing / kp).atan() / crossing;
    let step = answer(&format!("analyze {JOINT} --integrator velocity-verlet --dt 0.002"));
    let margin = step["delay_margin_seconds"].as_f64().unwrap();
    assert!((margin / wanted - 1.0).abs() < 1e-12, "{margin} {wanted}");
    assert_eq!(step["bounded"], Value::Bool(false), "without the loop it drifts");
    assert_eq!(step["update_matrix"], json!([[1.0, 0.002], [0.0, 1.0]]));
}

#[test]
fn trajectories_of_forces_are_those_of_accelerations() {
    let last = |system: &str| {
        let words =
            "simulate --integrator rk4 --dt 0.002 --steps 100 --save-every 100 --format json";
        let told = advise::libration(
            &format!("{words} {}", system.replace("--q 0", "--q 1"))
                .split_whitespace()
                .collect::<Vec<_>>(),
        );
        serde_json::from_slice::<Value>(&told.success().get_output().stdout).unwrap()
    };
    let (forces, accelerations) = (last(JOINT), last(PER_MASS));
    // 400/0.05 and 20/0.05 are 8000 and 400 in floats, too.
    assert_eq!(forces["rows"], accelerations["rows"]);
    assert_eq!(forces["feedback_units"], json!(["N/m", "N·s/m"]));
    assert_eq!(forces["parameters"], json!({ "m": 0.05, "k": 0.0 }));
}

#[test]
fn actions_of_a_data_set_are_forces_where_a_mass_is_given() {
    let text = |system: &str, weights: &str| {
        format!(
            "num_envs = 4\nsteps = 20\nsubsteps = 2\n[system.oscillator]\n{system}\n[noise]\njitter = 0.1\n\
             [task.regulate]\nposition = 1.0\nvelocity = 0.1\neffort = 0.0\nbound = 10.0\n\
             [policy.linear]\nweights = {weights}\nbias = 0.0\n"
        )
    };
    let of = |text: String| {
        let dir = settings(&text);
        write(&dir, "data", "--format npy").success();
        contents(&dir.path().join("data"))
    };
    let forces = of(text("m = 0.5\nk = 5.0", "[-5.0, -1.0]"));
    let accelerations = of(text("omega2 = 10.0", "[-10.0, -2.0]"));
    let numbers = |bytes: &[u8]| -> Vec<f32> {
        let (_, numbers) = bytes.split_at(bytes.len() - 4 * 80);
        numbers.chunks(4).map(|x| f32::from_le_bytes(x.try_into().unwrap())).collect()
    };
    for ((name, of_forces), (_, of_accelerations)) in forces.iter().zip(&accelerations) {
        if name.starts_with("action") {
            let halves: Vec<f32> =
                numbers(of_accelerations).into_iter().map(|action| 0.5 * action).collect();
            assert_eq!(numbers(of_forces), halves, "of half a kilogram");
            assert!(halves.iter().any(|action| *action != 0.0));
        } else if name.starts_with("manifest") {
            let manifest = String::from_utf8_lossy(of_forces);
            assert!(manifest.contains(r#""oscillator":{"k":5.0,"m":0.5}"#), "{manifest}");
        } else {
            assert_eq!(of_forces, of_accelerations, "{name}");
        }
    }
}

#[test]
fn a_mass_without_a_stiffness_is_refused_in_every_command() {
    let system = "--system oscillator --set m=0.05";
    for words in [
        format!("advise {system}"),
        format!("analyze {system} --integrator rk4 --dt 0.1"),
        format!("simulate {system} --integrator rk4 --dt 0.1 --steps 1"),
    ] {
        advise::libration(&words.split_whitespace().collect::<Vec<_>>())
            .code(2)
            .stderr(predicate::str::contains("`m` is given without `k`"));
    }
    let dir = settings("[system.oscillator]\nm = 0.05\n");
    write(&dir, "data", "").code(2).stderr(predicate::str::contains("`m` is given without `k`"));
    advise::libration(&["advise", "--config", dir.path().join("set.toml").to_str().unwrap()])
        .code(2)
        .stderr(predicate::str::contains("`m` is given without `k`"));
}
