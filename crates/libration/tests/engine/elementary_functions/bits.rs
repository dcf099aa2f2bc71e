//! The bits of the results: the same in a loop of vectors, and the same on every machine.

use std::hint::black_box;

use libration::Elementary;

use crate::elementary::Random;

/// Arguments of both signs and all sizes, and infinities, NaN, zeros and subnormal numbers.
fn arguments(count: usize) -> Vec<f64> {
    let mut random = Random(11);
    let special = [0.0, 1.0, f64::INFINITY, f64::NAN, 1e-310, f64::MAX, 1e-40, 0.5];
    let mut x: Vec<f64> = (0..count)
        .map(|i| {
            let x = match i % 4 {
                0 => random.float(0.0, f64::INFINITY),
                1 => random.real(1.0),
                2 => random.real(800.0),
                _ => random.float(1e-10, 1e3),
            };
            if random.bits() & 1 == 0 { -x } else { x }
        })
        .collect();
    for (i, x) in x.iter_mut().step_by(101).enumerate() {
        *x = special[i % special.len()];
    }
    x
}

/// In both loops the function is the same; the second may not be made of vectors.
macro_rules! lanes {
    ($float:ident: $($name:ident($($other:ident)?))*) => {{
        let x: Vec<$float> = arguments(4096).iter().map(|&x| x as $float).collect();
        let others: Vec<$float> = arguments(5000)[904..].iter().map(|&x| x as $float).collect();
        $({
            let mut lanes = x.clone();
            for (x, &_other) in lanes.iter_mut().zip(&others) {
                *x = Elementary::$name(*x $(, { let $other = _other; $other })?);
            }
            for ((&x, &_other), found) in x.iter().zip(&others).zip(lanes) {
                let lone: $float = Elementary::$name(black_box(x) $(, { let $other = _other; $other })?);
                assert_eq!(found.to_bits(), lone.to_bits(), "{} of {x:e}", stringify!($name));
            }
        })*
    }};
}

#[test]
fn a_lane_of_a_vector_has_the_bits_of_the_lone_number() {
    lanes!(f64: tan() asin() acos() atan() atan2(x) exp() ln() sinh() cosh() tanh() abs() min(x) max(x) signum());
    lanes!(f32: tan() asin() acos() atan() atan2(x) exp() ln() sinh() cosh() tanh() abs() min(x) max(x) signum());
}

/// FNV-1a over the bits of the results.
macro_rules! digests {
    ($float:ident: $($name:ident($($other:ident)?))*) => {{
        let x: Vec<$float> = arguments(40_000).iter().map(|&x| x as $float).collect();
        [$({
            let pairs = x.iter().zip(x.iter().rev());
            let digest = pairs.fold(0xcbf2_9ce4_8422_2325_u64, |digest, (&x, &_other)| {
                let value: $float = Elementary::$name(x $(, { let $other = _other; $other })?);
                (digest ^ u64::from(value.to_bits())).wrapping_mul(0x0100_0000_01b3)
            });
            (stringify!($name), digest)
        }),*]
    }};
}

#[test]
fn the_bits_of_f64_are_the_same_on_every_machine() {
    let found = digests!(f64: tan() asin() acos() atan() atan2(x) exp() ln() sinh() cosh() tanh());
    assert_eq!(found, DIGESTS_OF_F64, "{found:#018x?}");
}

#[test]
fn the_bits_of_f32_are_the_same_on_every_machine() {
    let found = digests!(f32: tan() asin() acos() atan() atan2(x) exp() ln() sinh() cosh() tanh());
    assert_eq!(found, DIGESTS_OF_F32, "{found:#018x?}");
}

/// A change of these changes every simulation of a system that uses the function.
const DIGESTS_OF_F64: [(&str, u64); 10] = [
    ("tan", 0x374d_7a95_1960_6b4e),
    ("asin", 0x0b5a_3916_672c_2e98),
    ("acos", 0x1e5c_5786_a790_473f),
    ("atan", 0x672f_0563_96a0_860a),
    ("atan2", 0xa4f5_f437_6dc0_7a6d),
    ("exp", 0x2798_fc97_9ce6_0798),
    ("ln", 0x78af_059f_a35f_c969),
    ("sinh", 0x4731_9698_b87c_e940),
    ("cosh", 0x2cd7_0b4e_5c92_d306),
    ("tanh", 0xc3ff_56dc_c2c6_4613),
];

const DIGESTS_OF_F32: [(&str, u64); 10] = [
    ("tan", 0x6501_7eb6_86b9_f41e),
    ("asin", 0x6a42_905f_9e56_8e77),
    ("acos", 0x6abf_730b_918d_1e6f),
    ("atan", 0xdea5_29c5_1ea8_dc05),
    ("atan2", 0xfbe9_21e8_d98d_36de),
    ("exp", 0x592c_d9c7_9576_8ef3),
    ("ln", 0x3fba_a509_258b_1d58),
    ("sinh", 0x9f9e_9700_3266_b011),
    ("cosh", 0x591e_2808_ed90_30b6),
    ("tanh", 0xc229_8f9e_eb0e_6d7a),
];
