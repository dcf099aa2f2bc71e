//! Fixed trajectories, bit for bit: a change of physics is a visible change of this table.

use half::{bf16, f16};
use libration::system::{Oscillator, Pendulum};
use libration::{Float, Method, Model, State};

use super::step_function::{StepFunction, step_function};

/// Method, number type, and the hashes of the oscillator's and the pendulum's trajectory.
const GOLDEN: &[(&str, &str, u64, u64)] = &[
    ("explicit-euler", "f64", 0xd1dc21b806b67e4c, 0x895f4f4de9197009),
    ("explicit-euler", "f32", 0x44d81bb48f8df160, 0xb9d677bbc8c1ea35),
    ("explicit-euler", "f16", 0xae75c6cb81931946, 0x6ce6f3272b42f81b),
    ("explicit-euler", "bf16", 0xef80bde03e3b1a1f, 0x9b3b64b8473d20f2),
    ("symplectic-euler", "f64", 0xda0c55f1c908d5f2, 0xc7cb1a978ecb2336),
    ("symplectic-euler", "f32", 0x060b52aebf206329, 0x2c6387951aca3396),
    ("symplectic-euler", "f16", 0x10727168bbbe733e, 0xdb60cffeb41e0044),
    ("symplectic-euler", "bf16", 0x3758aa3fb647f11a, 0xbcee265709aaad17),
    ("symplectic-euler-drift-first", "f64", 0x3876173b31d9b662, 0xba8f2fdbc01a6dba),
    ("symplectic-euler-drift-first", "f32", 0x0f83a68abc62d7d3, 0xd6442b31d024db05),
    ("symplectic-euler-drift-first", "f16", 0x3cd3ec5c54a3bcba, 0x6eee5bd34c7439f3),
    ("symplectic-euler-drift-first", "bf16", 0x4a232feb5b2ba59a, 0x6c27b049d929a22a),
    ("velocity-verlet", "f64", 0x94917b25fdda4bde, 0x77b8bdbf6aee361f),
    ("velocity-verlet", "f32", 0x7f2096f9b0162c73, 0x6fb72dc80909a086),
    ("velocity-verlet", "f16", 0x445bdc92ecf4c2ce, 0xa977bcd4bd936ede),
    ("velocity-verlet", "bf16", 0xaf692c34889e2162, 0x9b2824635de82e6b),
    ("textbook-verlet", "f64", 0x54940a74aabc6a17, 0x53c25163da3ba4ac),
    ("textbook-verlet", "f32", 0x9f846b9e871678fa, 0x2b64ed5bec0d0057),
    ("textbook-verlet", "f16", 0x8ff5e8c19a337879, 0x7b347b7c928aa499),
    ("textbook-verlet", "bf16", 0xcc9dbff0a3c9d645, 0x02906f937ef08341),
    ("leapfrog", "f64", 0xeaa7a8a669514ddd, 0x1168a6d2d9216f2c),
    ("leapfrog", "f32", 0x888e6663646dad40, 0xbbc803ac08831894),
    ("leapfrog", "f16", 0x3f404e16dce3486f, 0xe9ef0efd2ba1e819),
    ("leapfrog", "bf16", 0xdf9593415fd128df, 0xd926ba2246d2869d),
    ("rk4", "f64", 0x1a3db7cf14596b4e, 0x94df4b089d46739f),
    ("rk4", "f32", 0x131cd4704c4ebfb3, 0xa3bf570829136764),
    ("rk4", "f16", 0x8321b4bfa0161c4f, 0x451f62cb980f6177),
    ("rk4", "bf16", 0x8bfbf8b242fb379d, 0xada46dca62767b64),
    ("yoshida4", "f64", 0xe61f688246b15a93, 0x659a300fb25ecb8b),
    ("yoshida4", "f32", 0xab38e08099f948dd, 0xbd506904da9d48e8),
    ("yoshida4", "f16", 0xeec4031b4cf37691, 0x39ab5c772c5692f5),
    ("yoshida4", "bf16", 0x3f170e387cdbc686, 0x773242648e8820f7),
    ("suzuki4", "f64", 0xddea9d67ed192c9a, 0x5bfe074d1cbc6881),
    ("suzuki4", "f32", 0xdc9cb69a88fa59f6, 0x5d7a85b173c4b808),
    ("suzuki4", "f16", 0x05e2f5a0003471db, 0x942a996b4de98487),
    ("suzuki4", "bf16", 0x7f279f12403fdb82, 0x804bedc22f943dd3),
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
    let step = step_function(method, system, dt);
    hash_of(&step, start, method.name())
}

fn hash_of<S: Float>(step: &StepFunction<'_, S, 1>, start: State<S, 1>, method: &str) -> u64 {
    let next = |&state: &State<S, 1>| Some(step(state));
    let trajectory: Vec<_> = std::iter::successors(Some(start), next).take(STEPS + 1).collect();
    let numbers = || trajectory.iter().flat_map(State::coordinates);
    assert!(numbers().all(|x| x.is_finite()), "{method} on {}", S::NAME);
    fnv1a(numbers().flat_map(|x| x.to_f64().to_bits().to_le_bytes()))
}

/// The default oscillator, and a pendulum that turns over.
fn row<S: Float>(method: Method) -> (&'static str, &'static str, u64, u64) {
    // The step is long, so that every rounding leaves a trace, and short enough for explicit
    // Euler to stay within the range of `f16`.
    let oscillator = hash::<S>(Oscillator { omega2: 10.0 }, method, 1.0, 0.0, 0.03);
    let pendulum = hash::<S>(Pendulum { omega2: 9.81 }, method, 3.0, 0.5, 0.03);
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
