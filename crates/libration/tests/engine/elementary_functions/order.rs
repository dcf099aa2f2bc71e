//! Symmetries of the functions, and the order of neighbouring values.

use super::catalogue::FUNCTIONS;
use crate::elementary::Random;

#[test]
fn odd_functions_are_odd_and_the_hyperbolic_cosine_is_even_to_the_last_bit() {
    let mut random = Random(10);
    for _ in 0..50_000 {
        let x: f64 = random.float(0.0, 1e4);
        let single: f32 = random.float(0.0, 1e4);
        for function in FUNCTIONS {
            let sign = match function.name {
                "tan" | "asin" | "atan" | "sinh" | "tanh" => -1.0,
                "cosh" => 1.0,
                _ => continue,
            };
            let (there, here) = ((function.double)(-x), (function.double)(x));
            assert!(same(there, sign * here), "{} at {x:e}", function.name);
            let (there, here) = ((function.single)(-single), (function.single)(single));
            assert!(
                same(there.into(), f64::from(sign as f32 * here)),
                "{} at {single:e}",
                function.name
            );
        }
    }
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

#[test]
fn neighbours_stay_in_order_next_to_the_ends() {
    let ordered = |name: &str, from: f64, sign: f64| {
        let function = FUNCTIONS.iter().find(|function| function.name == name).unwrap();
        let bits = from.to_bits();
        for i in 0..20_000 {
            let [low, high] = [i, i + 1].map(|i| (function.double)(f64::from_bits(bits - i)));
            assert!(
                sign * high <= sign * low,
                "{name}, {i} floats below {from:e}: {low:e}, {high:e}"
            );
        }
        let bits = (from as f32).to_bits();
        for i in 0..20_000 {
            let [low, high] = [i, i + 1].map(|i| (function.single)(f32::from_bits(bits - i)));
            let sign = sign as f32;
            assert!(
                sign * high <= sign * low,
                "{name}, {i} floats below {from:e}: {low:e}, {high:e}"
            );
        }
    };
    ordered("asin", 1.0, 1.0);
    ordered("asin", -1.0, -1.0);
    ordered("acos", 1.0, -1.0);
    ordered("acos", -1.0, 1.0);
    ordered("tanh", 19.1, 1.0);
    ordered("tanh", 9.0, 1.0);
    ordered("exp", 88.0, 1.0);
    ordered("exp", -88.0, -1.0);
    ordered("ln", 1e-30, 1.0);
    ordered("atan", 1e16, 1.0);
    ordered("sinh", 80.0, 1.0);
}
