//! Random expressions, and systems of them.

use libration::equations::{Definitions, Equations};
use proptest::prelude::*;

/// The system of these accelerations and rates, with the parameters `k` and `one`.
pub(crate) fn equations(
    accelerations: Vec<(String, String)>,
    rates: Vec<(String, String)>,
) -> Equations {
    let coordinates = accelerations.iter().map(|(name, _)| name.clone()).collect();
    let parameters = vec![("k".to_owned(), 1.3), ("one".to_owned(), 1.0)];
    let definitions =
        Definitions { coordinates, accelerations, rates, parameters, ..Definitions::default() };
    Equations::new(&definitions).unwrap_or_else(|error| panic!("{error}"))
}

/// Expressions of two coordinates, a state of first order, parameters and time.
pub(crate) fn expression() -> impl Strategy<Value = String> {
    of_functions(
        &[
            "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log",
            "sqrt", "abs", "sign",
        ],
        true,
    )
}

/// Expressions that have derivatives wherever they are finite.
pub(crate) fn smooth_expression() -> impl Strategy<Value = String> {
    let functions = ["sin", "cos", "tan", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt"];
    of_functions(&functions, false)
}

fn of_functions(
    functions: &[&'static str],
    has_kinks: bool,
) -> impl Strategy<Value = String> + use<> {
    let functions = functions.to_vec();
    let leaf = prop_oneof![
        Just("x".to_owned()),
        Just("y".to_owned()),
        Just("x'".to_owned()),
        Just("y'".to_owned()),
        Just("s".to_owned()),
        Just("k".to_owned()),
        Just("one".to_owned()),
        Just("t".to_owned()),
        (-4.0..4.0_f64).prop_map(|c| format!("({c:.3})")),
        (1..9_i32).prop_map(|c| c.to_string()),
    ];
    leaf.prop_recursive(5, 40, 4, move |inner| {
        let (a, b) = (inner.clone(), inner.clone());
        let (c, d) = (inner.clone(), inner.clone());
        let function = prop::sample::select(functions.clone());
        let pairs = if has_kinks { vec!["atan2", "min", "max"] } else { vec!["atan2"] };
        let pair = prop::sample::select(pairs);
        let kink = u32::from(has_kinks);
        let operator = prop::sample::select(vec!["+", "-", "*", "/"]);
        let comparison = prop::sample::select(vec!["<", "<=", ">", ">="]);
        prop_oneof![
            4 => (a.clone(), operator, b.clone()).prop_map(|(a, o, b)| format!("({a} {o} {b})")),
            1 => a.clone().prop_map(|a| format!("(-{a})")),
            1 => (a.clone(), 2..5).prop_map(|(a, n)| format!("({a})^{n}")),
            2 => (function, a.clone()).prop_map(|(f, a)| format!("{f}({a})")),
            1 => (pair, a.clone(), b.clone()).prop_map(|(f, a, b)| format!("{f}({a}, {b})")),
            kink => (a, comparison, b, c, d)
                .prop_map(|(a, o, b, c, d)| format!("if({a} {o} {b}, {c}, {d})")),
        ]
    })
}
