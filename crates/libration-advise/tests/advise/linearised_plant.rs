//! Loops around systems of the catalogue that are linearised at an equilibrium.

use libration_advise::linear;

use super::requests::with_work;

const LOOP: &str = "
[controller.lqr]
states = [10, 1]
inputs = [0.1]
[loop]
period = 0.01
latency = 0.02
";

fn advice(system: &str) -> linear::LinearAdvice {
    let request = linear::parse(&format!("{system}{LOOP}"), "loop.toml").unwrap();
    with_work(|work| linear::advise(work, &request)).unwrap()
}

#[test]
fn an_inverted_pendulum_of_the_catalogue_is_its_matrices_and_its_operating_point_is_stated() {
    let found =
        advice("[system.linear]\nof = \"pendulum\"\nparameters = { omega2 = 14 }\nat = 3.0\n");
    let by_hand = advice("[system.linear]\na = [[0, 1], [14, 0]]\nb = [[0], [1]]\n");
    // The cosine at the double next to π is −1 to rounding.
    let costs = [&found, &by_hand].map(|advice| advice.cost.unwrap());
    assert!((costs[0] / costs[1] - 1.0).abs() < 1e-12, "{costs:?}");
    let point = found.operating_point.as_ref().unwrap();
    assert!(
        (point.states[0].value - core::f64::consts::PI).abs() < 1e-15 && point.residual < 4e-15
    );
    let stated = "The plant is the system pendulum linearised at q = 3.141593 rad under acceleration = 0 rad/s²";
    assert!(found.answer.contains(stated), "{}", found.answer);
    assert!(linear::page(&found).contains("linearised at q = 3.141593 rad"));
    assert!(by_hand.operating_point.is_none() && !by_hand.answer.contains("linearised"));
}

#[test]
fn keys_of_an_operating_point_require_a_system() {
    let refused = |system: &str| {
        linear::parse(&format!("[system.linear]\n{system}{LOOP}"), "loop.toml")
            .unwrap_err()
            .to_string()
    };
    let error = refused("a = [[0, 1], [14, 0]]\nb = [[0], [1]]\nat = 3.0\n");
    assert!(error.contains("it is no key of a plant by `a`"), "{error}");
    let error = refused("of = \"pendulum\"\nb = [[0], [1]]\n");
    assert!(error.contains("it is no key of a plant by `of`"), "{error}");
    let error = refused("of = \"pendulum\"\nat = [1, 2]\n");
    assert!(error.contains("pendulum"), "{error}");
}
