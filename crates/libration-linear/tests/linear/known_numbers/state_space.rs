//! The model `StateSpace` of the Modelica Association's Reference-FMUs: `ẋ = Ax + Bu`, `y = Cx + Du`.
//!
//! By default all four matrices are the identity of size 3, `u = (1, 2, 3)` and `x(0) = 0`. The published outputs are those of the
//! explicit Euler method with 1 ms, the step of the model; the exact ones are `y = u eᵗ`.

use libration_linear::{Discretisation, Matrix};

const INPUT: [f64; 3] = [1.0, 2.0, 3.0];

/// The outputs at 1 to 10 s. Source: `StateSpace/StateSpace_out.csv` of <https://github.com/modelica/Reference-FMUs>, commit 69e0ef7.
#[rustfmt::skip]
#[allow(clippy::unreadable_literal)]
const PUBLISHED: [[f64; 3]; 10] = [
    [2.7169239322358925, 5.433847864471785, 8.150771796707678],
    [7.381675653556159, 14.763351307112318, 22.145026960668407],
    [20.055451243149793, 40.11090248629959, 60.16635372944905],
    [54.489135454303685, 108.97827090860737, 163.4674063629103],
    [148.04283616264095, 296.0856723252819, 444.12850848792027],
    [402.2211245663556, 804.4422491327113, 1206.6633736990636],
    [1092.8041993851652, 2185.6083987703305, 3278.4125981554794],
    [2969.0658825574433, 5938.131765114887, 8907.197647672285],
    [8066.726152705384, 16133.452305410769, 24200.1784581161],
    [21916.681339078466, 43833.36267815693, 65750.0440172352],
];

/// The outputs after each of ten steps of a second.
fn outputs(step: &Discretisation) -> Vec<[f64; 3]> {
    let mut x = [0.0; 3];
    let second = |x: [f64; 3]| {
        let entry = |i: usize| -> f64 {
            (0..3).map(|j| step.phi[(i, j)] * x[j] + step.gamma[(i, j)] * INPUT[j]).sum()
        };
        [entry(0), entry(1), entry(2)]
    };
    let mut outputs = Vec::new();
    for _ in 0..10 {
        x = second(x);
        outputs.push([0, 1, 2].map(|i| x[i] + INPUT[i]));
    }
    outputs
}

fn largest_deviation(found: &[[f64; 3]], expected: impl Fn(usize, usize) -> f64) -> f64 {
    let all = (0..10).flat_map(|k| (0..3).map(move |i| (k, i)));
    all.map(|(k, i)| (found[k][i] / expected(k, i) - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn a_thousand_steps_of_euler_per_second_are_the_published_trajectory() {
    let one = Matrix::identity(3);
    let euler = Discretisation { phi: one.scaled(1.001), gamma: one.scaled(0.001) };
    let second = (1..1000).fold(euler.clone(), |step, _| step.then(&euler));
    let deviation = largest_deviation(&outputs(&second), |k, i| PUBLISHED[k][i]);
    // 10,000 steps round by 1.1e-16 each, here and in the published numbers.
    assert!(deviation < 2.2e-12, "{deviation:e}");
}

#[test]
fn the_exact_step_is_the_exponential_and_leaves_the_error_of_euler() {
    let one = Matrix::identity(3);
    let exact = outputs(&Discretisation::exact(&one, &one, 1.0));
    let deviation = largest_deviation(&exact, |k, i| INPUT[i] * (k as f64 + 1.0).exp());
    // Ten steps round by some 1e-16 each.
    assert!(deviation < 1e-14, "{deviation:e}");
    // (1 + h)^(t/h) is e^t (1 − h t/2 + …); the next terms are below 2e-5 at t = 10.
    for (k, published) in PUBLISHED.iter().enumerate() {
        let error = 1.0 - published[0] / exact[k][0];
        assert!((error - 0.0005 * (k as f64 + 1.0)).abs() < 2e-5, "{error}");
    }
}
