//! Fixed trajectories, bit for bit: a change of physics is a visible change of this table.

use half::{bf16, f16};
use libration::system::{Oscillator, Pendulum};
use libration::{Float, Integrator, Method, Model, State, with_method};

/// Method, number type, and the hashes of the oscillator's and the pendulum's trajectory.
const GOLDEN: &[(&str, &str, u64, u64)] = &[
    ("explicit-euler", "f64", 0xdbf5a978754c6be7, 0x1b9fb9fe967dd8fb),
    ("explicit-euler", "f32", 0xfb7243299af4d2a3, 0x80f31532df8a4969),
    ("explicit-euler", "f16", 0x62ec4ce6726d3aaa, 0x0d3efc4fa47c5955),
    ("explicit-euler", "bf16", 0x22ad88e3e2069b2c, 0xf086f1ae720ab129),
    ("symplectic-euler", "f64", 0x387fdbf0761878c0, 0x889035577e33295e),
    ("symplectic-euler", "f32", 0x66e1b7f5a355bb9d, 0xf288de7770a1c2d3),
    ("symplectic-euler", "f16", 0x4233c1986cbe3f82, 0xbae7f8836a1bcb58),
    ("symplectic-euler", "bf16", 0xcaecd1e5de28270b, 0x1557e91229af8590),
    ("symplectic-euler-drift-first", "f64", 0x5341e0b3efb0e577, 0x3208db5fecc2327d),
    ("symplectic-euler-drift-first", "f32", 0x53f31c87e851534b, 0xca3f38c086063f66),
    ("symplectic-euler-drift-first", "f16", 0xc471eb1b50a88121, 0x6195e3a5a33ff4f8),
    ("symplectic-euler-drift-first", "bf16", 0xcae129089d694d05, 0x8713211c6222d910),
    ("velocity-verlet", "f64", 0x431f21020074ed51, 0xbd08bb87c9e838dd),
    ("velocity-verlet", "f32", 0x8efc5a7ffda39723, 0xdc9a68016b8f3eab),
    ("velocity-verlet", "f16", 0xf881ff61ba3268da, 0x9adc89617a6bbc67),
    ("velocity-verlet", "bf16", 0x2ed312d0e60c606e, 0x0cabfebad9ae3880),
    ("textbook-verlet", "f64", 0x59bb1fca2c56e9e0, 0x7cd1bfaffbe19f1f),
    ("textbook-verlet", "f32", 0x339972fad6c7d9ae, 0xf96f75010fd0aeb0),
    ("textbook-verlet", "f16", 0xebba0d94d7f95584, 0x0d44fd19219c1c2d),
    ("textbook-verlet", "bf16", 0xac0d5dca8a7a580c, 0x637237dc4e8cf581),
    ("leapfrog", "f64", 0x38814295bc769848, 0x9961c671cd2daf14),
    ("leapfrog", "f32", 0x0b250a16c545bfbf, 0xb90d8fb378655589),
    ("leapfrog", "f16", 0x1079a8e3e432cfb9, 0x80bf7b804b3a88b4),
    ("leapfrog", "bf16", 0xedaf1ffb71bfd762, 0x3762d97c291e2fb5),
    ("rk4", "f64", 0x65f608e27c08484c, 0x9aca77e3d53fdb3c),
    ("rk4", "f32", 0xe6557051f0fd5ded, 0x01e2aaf0dad8440e),
    ("rk4", "f16", 0x0c21857ae858c22e, 0x5770e690cfdbcc33),
    ("rk4", "bf16", 0x9a091376e7bb0455, 0x8fbe6b62e5605ce6),
    ("yoshida4", "f64", 0xee18d8b5757b5cf2, 0x42f25d122d7d813c),
    ("yoshida4", "f32", 0x0f86b90a44a3ed0b, 0xcac2613d38da2ab2),
    ("yoshida4", "f16", 0x8d3221df72c49201, 0xec75997462ecce4e),
    ("yoshida4", "bf16", 0xc1850952f49b66e7, 0xc9fbab68c7c48a83),
];

const STEPS: usize = 1000;

/// FNV-1a with 64 bits (Fowler, Noll, Vo).
fn fnv1a(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

#[test]
fn fnv1a_gives_its_published_vectors() {
    assert_eq!(fnv1a(*b""), 0xcbf2_9ce4_8422_2325);
    assert_eq!(fnv1a(*b"foobar"), 0x8594_4171_f739_67e8);
}

/// The hash of every state of the trajectory; `f64` holds the numbers of all four types exactly.
fn hash<S: Float>(model: impl Model<1>, method: Method, q: f64, v: f64, dt: f64) -> u64 {
    let system = model.on::<S>();
    let (start, dt) = (State { q: [q], v: [v] }.map(S::from_f64), S::from_f64(dt));
    with_method!(method, |m| {
        let step = |&state: &State<S, 1>| Some(m.step(&system, state, dt));
        let trajectory: Vec<_> = std::iter::successors(Some(start), step).take(STEPS + 1).collect();
        let numbers = || trajectory.iter().flat_map(State::coordinates);
        assert!(numbers().all(|x| x.is_finite()), "{} on {}", method.name(), S::NAME);
        fnv1a(numbers().flat_map(|x| x.to_f64().to_bits().to_le_bytes()))
    })
}

/// The default oscillator, and a pendulum that turns over.
fn row<S: Float>(method: Method) -> (&'static str, &'static str, u64, u64) {
    let oscillator = hash::<S>(Oscillator { omega2: 10.0 }, method, 1.0, 0.0, 0.01);
    let pendulum = hash::<S>(Pendulum { omega2: 9.81 }, method, 3.0, 0.5, 0.01);
    (method.name(), S::NAME, oscillator, pendulum)
}

#[test]
fn trajectories_keep_their_bits() {
    let rows: Vec<_> = Method::ALL
        .into_iter()
        .flat_map(|m| [row::<f64>(m), row::<f32>(m), row::<f16>(m), row::<bf16>(m)])
        .collect();
    let table: String = rows
        .iter()
        .map(|(method, float, oscillator, pendulum)| {
            format!("    ({method:?}, {float:?}, {oscillator:#018x}, {pendulum:#018x}),\n")
        })
        .collect();
    assert!(rows == GOLDEN, "the table should now be\n{table}");
}
