//! The language of expressions.

use libration_equations::{Definitions, EquationError, Equations};

/// A system with the acceleration `text` of the coordinate `x`, a state `i` with the rate `-i`, an input `u` and parameters `a`, `b`.
fn equations(text: &str) -> Result<Equations, EquationError> {
    let own = |name: &str, text: &str| (name.to_owned(), text.to_owned());
    Equations::new(&Definitions {
        coordinates: vec!["x".into(), "y".into()],
        accelerations: vec![own("x", text), own("y", "x'' * 2")],
        rates: vec![own("i", "-i")],
        parts: vec![own("sum", "a + b")],
        parameters: vec![("a".into(), 3.0), ("b".into(), 0.25)],
        inputs: vec!["u".into()],
        ..Definitions::default()
    })
}

/// The value at x = 2, x' = 5, i = 7, u = 11.
fn value(text: &str) -> f64 {
    let equations = equations(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    let timed = equations.degrees().len() == 4;
    let inputs: &[f64] = match timed {
        false => &[2.0, 0.0, 0.0, 5.0, 0.0, 7.0, 11.0],
        true => &[2.0, 0.0, 0.0, 13.0, 5.0, 0.0, 7.0, 1.0, 11.0],
    };
    equations.dynamics().accelerations().on::<f64>().run(inputs).next().unwrap_or(f64::NAN)
}

#[test]
fn operators_have_the_usual_order() {
    for (text, wanted) in [
        ("1 - 2 - 3", -4.0),
        ("8 / 4 / 2", 1.0),
        ("2 + 3 * 4", 14.0),
        ("(2 + 3) * 4", 20.0),
        ("-2^2", -4.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("2 * -3", -6.0),
        ("3 - -2", 5.0),
        ("--3", 3.0),
        ("+-+3", -3.0),
        ("x^3", 8.0),
        ("x^-2", 0.25),
        ("x^0", 1.0),
        ("x^-2147483648", 0.0),
        ("x^2147483648", f64::INFINITY),
        // One rounding, not that of a reciprocal and that of a product.
        ("x' / (u * 0.7)", 5.0 / (11.0 * 0.7)),
        ("u / 0.3", 11.0 / 0.3),
        ("(x * 2)^0.5", 2.0),
        ("log(exp(x)^1.5)", 3.0),
        ("if(x < 2, 1, 3)", 3.0),
        ("if(x <= 2, 1, 3)", 1.0),
        ("if(x > 1, x', u)", 5.0),
        ("if(2 >= x, min(x, u), 3)", 2.0),
        ("max(x, -x) + abs(-x) + sign(-x)", 3.0),
        ("atan2(0, -1) - pi", 0.0),
        ("tan(0) + asin(0) + acos(1) + atan(0) + sinh(0) + cosh(0) + tanh(0)", 1.0),
        ("1e3 + .5 + 2.", 1002.5),
        ("1E-2 * 1e+2", 1.0),
        ("\t( x\n + 1 ) ", 3.0),
    ] {
        assert_eq!(value(text), wanted, "{text}");
    }
}

#[test]
fn names_are_states_derivatives_parts_parameters_inputs_time_and_pi() {
    for (text, wanted) in [
        ("x + 10*x'", 52.0),
        ("i + 10*i'", -63.0),
        ("y' + x", 2.0),
        ("sum * 4", 13.0),
        ("u - a", 8.0),
        ("t + x", 15.0),
        ("sin(pi / 2) * sqrt(x + 2)", 2.0),
    ] {
        assert_eq!(value(text), wanted, "{text}");
    }
}

#[test]
fn errors_name_the_place_and_what_is_allowed() {
    for (text, place, parts) in [
        ("1 + ", 4..4, &["found the end", "a number, a name"][..]),
        ("", 0..0, &["found the end"]),
        ("1 + * 2", 4..5, &["found `*`"]),
        ("x y", 2..3, &["found `y`", "an operator or the end"]),
        ("(x + 1", 6..6, &["found the end", "`)`"]),
        ("x + 1)", 5..6, &["found `)`"]),
        ("sin x", 4..5, &["found `x`"]),
        ("sin(x, 1)", 0..9, &["`sin` has 2 arguments; expected 1"]),
        ("max(x)", 0..6, &["`max` has 1 arguments; expected 2"]),
        ("if(x, 1, 2)", 4..5, &["found `,`", "a comparison"]),
        ("if(x < 1, 2)", 11..12, &["found `)`", "`,`"]),
        ("sine(x)", 0..4, &["unknown function `sine`", "`sin`"]),
        ("1e999", 0..5, &["`1e999` is too large"]),
        ("x'''", 0..4, &["3 primes", "at most 2"]),
        ("2 * z", 4..5, &["unknown name `z`"]),
        ("x + é", 4..6, &["found `é`"]),
        ("y''", 0..3, &["depends on itself"]),
        (".", 0..1, &["found `.`"]),
    ] {
        let error = equations(text).unwrap_err();
        assert_eq!(error.span, Some(place), "{text}: {error}");
        for part in parts {
            assert!(error.to_string().contains(part), "{text}: {error}");
        }
    }
}

#[test]
fn long_and_deep_expressions_are_refused_and_long_sums_are_not() {
    let deep = |levels: usize| format!("{}x{}", "(".repeat(levels), ")".repeat(levels));
    assert_eq!(value(&deep(99)), 2.0);
    let powers = vec!["x"; 1000].join("^");
    for text in [deep(101), deep(20_000), powers, "-sin(".repeat(5000)] {
        let message = equations(&text).unwrap_err().to_string();
        assert!(message.contains("at most 100 levels"), "{message}");
    }
    let sum = vec!["x"; 30_000].join("+");
    assert_eq!(value(&sum), 60_000.0);
    let signs = format!("{}x", "-".repeat(60_001));
    assert_eq!(value(&signs), -2.0);
    let message = equations(&vec!["x"; 40_000].join("+")).unwrap_err().to_string();
    assert!(message.contains("at most 65536"), "{message}");
}

#[test]
fn a_thousand_parts_may_each_need_the_next() {
    let part = |i: usize| {
        (format!("p{i}"), if i == 999 { "x".to_owned() } else { format!("p{} + 1", i + 1) })
    };
    let definitions = Definitions {
        coordinates: vec!["x".into()],
        accelerations: vec![("x".into(), "p0".into())],
        parts: (0..1000).map(part).collect(),
        ..Definitions::default()
    };
    let equations = Equations::new(&definitions).unwrap();
    let found = equations.dynamics().accelerations().on::<f64>().run(&[0.5, 0.0]).next();
    assert_eq!(found, Some(999.5));
}

#[test]
fn wrong_names_are_refused() {
    let with = |change: fn(&mut Definitions)| {
        let mut definitions = Definitions {
            coordinates: vec!["x".into()],
            accelerations: vec![("x".into(), "-x".into())],
            ..Definitions::default()
        };
        change(&mut definitions);
        Equations::new(&definitions).unwrap_err().to_string()
    };
    for (message, parts) in [
        (with(|d| d.inputs = vec!["x".into()]), ["`x`", "given twice"]),
        (with(|d| d.inputs = vec!["sin".into()]), ["`sin`", "a name of the language"]),
        (with(|d| d.inputs = vec!["2u".into()]), ["`2u`", "no name"]),
        (
            with(|d| {
                d.coordinates = vec!["step".into()];
                d.accelerations = vec![("step".into(), "1".into())];
            }),
            ["`step`", "the name of a column"],
        ),
        (with(|d| d.coordinates.push("y".into())), ["`y`", "has no acceleration"]),
        (with(|d| d.accelerations.push(("z".into(), "1".into()))), ["`z`", "is no coordinate"]),
        (with(|d| d.parameters = vec![("k".into(), f64::NAN)]), ["`k`", "NaN"]),
        (with(|d| d.coordinates.clear()), ["0 coordinates and states", "1 to 256"]),
        (
            with(|d| d.parts = vec![("k".into(), "l".into()), ("l".into(), "k".into())]),
            ["`k`", "depends on itself"],
        ),
    ] {
        for part in parts {
            assert!(message.contains(part), "{message}");
        }
    }
}
