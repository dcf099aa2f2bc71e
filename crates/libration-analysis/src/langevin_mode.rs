//! The stationary covariance of Langevin dynamics in a mode, from the step itself.

use libration_core::number::{Ratio, TwoFloat};
use libration_core::system::Oscillator;
use libration_core::thermostat::{LangevinLetter, LangevinMethod, LangevinStep};
use libration_core::{Elementary, Float, Scalar, State};

/// The stationary covariance of an oscillator with `ω = m = kT = 1` under a method: `⟨q²⟩`, `⟨qv⟩` and `⟨v²⟩`, each `1`, `0` and `1` under
/// the exact flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeCovariance<S> {
    /// `⟨q²⟩`.
    pub qq: S,
    /// `⟨qv⟩`.
    pub qv: S,
    /// `⟨v²⟩`.
    pub vv: S,
}

/// The step of a method on the oscillator: its matrix by rows, and the covariance of its noise.
struct ModeStep<S> {
    matrix: [S; 4],
    noise: ModeCovariance<S>,
}

impl<S: Scalar> ModeStep<S> {
    fn new(method: &LangevinMethod, step: LangevinStep<S>) -> Self {
        let system = Oscillator { omega2: S::one() };
        let (zero, one) = (S::zero(), S::one());
        let count = method.noises();
        let image = |q: S, v: S, noise: &[[S; 1]]| {
            let State { q: [q], v: [v] } =
                method.step(&system, State { q: [q], v: [v] }, step, noise);
            (q, v)
        };
        let quiet = vec![[zero]; count];
        let ((a, c), (b, d)) = (image(one, zero, &quiet), image(zero, one, &quiet));
        let variance = method.noise_variance(step);
        let mut noise = ModeCovariance { qq: zero, qv: zero, vv: zero };
        for i in 0..count {
            let mut lone = quiet.clone();
            lone[i] = [one];
            let (q, v) = image(zero, zero, &lone);
            noise.qq = noise.qq + variance * (q * q);
            noise.qv = noise.qv + variance * (q * v);
            noise.vv = noise.vv + variance * (v * v);
        }
        ModeStep { matrix: [a, b, c, d], noise }
    }
}

/// Stein's equation `P = M P Mᵀ + N` of a step as linear equations of three unknowns: their columns and right side.
struct SteinEquations<S> {
    columns: [[S; 3]; 3],
    right: [S; 3],
}

impl<S: Scalar> SteinEquations<S> {
    fn new(method: &LangevinMethod, step: LangevinStep<S>) -> Self {
        let ModeStep { matrix: [a, b, c, d], noise } = ModeStep::new(method, step);
        let one = S::one();
        let twice = |x: S| x + x;
        let columns = [
            [one - a * a, -(a * c), -(c * c)],
            [-twice(a * b), one - a * d - b * c, -twice(c * d)],
            [-(b * b), -(b * d), one - d * d],
        ];
        SteinEquations { columns, right: [noise.qq, noise.qv, noise.vv] }
    }

    /// The solution, by Cramer's rule, because an entry of the diagonal may be zero, such as that of a word that begins with a drift.
    fn solve(self, recip: impl Fn(S) -> S) -> ModeCovariance<S> {
        let SteinEquations { columns, right } = self;
        let scale = recip(determinant(columns));
        let [qq, qv, vv] = core::array::from_fn(|i| {
            let mut replaced = columns;
            replaced[i] = right;
            determinant(replaced) * scale
        });
        ModeCovariance { qq, qv, vv }
    }
}

impl<S: Elementary> ModeCovariance<S> {
    /// The solution of Stein's equation of a step, which is the covariance if the step is stable.
    pub fn new(method: &LangevinMethod, step: LangevinStep<S>) -> Self {
        SteinEquations::new(method, step).solve(Elementary::recip)
    }
}

fn determinant<S: Scalar>([x, y, z]: [[S; 3]; 3]) -> S {
    let minor = |i: usize, j: usize| y[i] * z[j] - y[j] * z[i];
    x[0] * minor(1, 2) - x[1] * minor(0, 2) + x[2] * minor(0, 1)
}

/// How far a step on a mode is within its stability: below zero it grows. The step has the time step `z = ωh` and the friction `γ/ω`.
///
/// By the criterion of Jury: the eigenvalues of a matrix of two rows are within the unit circle if and only if `det < 1` and
/// `|trace| < 1 + det`.
pub fn stability_margin(method: &LangevinMethod, z: f64, friction: f64) -> f64 {
    let step =
        LangevinStep::new(TwoFloat::from_f64(z), TwoFloat::from_f64(friction), letters(method));
    let [a, b, c, d] = ModeStep::new(method, step).matrix;
    let (trace, determinant) = ((a + d).to_f64(), a * d - b * c);
    // Near zero both margins are small: no digit may get lost.
    let circle = (TwoFloat::one() - determinant).to_f64();
    let real = (TwoFloat::one() + determinant).to_f64() - trace.abs();
    let sharp = (TwoFloat::one() + determinant - (a + d)).to_f64();
    circle.min(real.min(sharp))
}

/// The part of a deviation from the mean that a step on a mode leaves: the largest size of an eigenvalue.
pub fn mode_memory(method: &LangevinMethod, z: f64, friction: f64) -> f64 {
    let [a, b, c, d] =
        ModeStep::new(method, LangevinStep::new(z, friction, letters(method))).matrix;
    let (half, determinant) = (0.5 * (a + d), a * d - b * c);
    match half * half - determinant {
        square if square < 0.0 => determinant.sqrt(),
        square => half.abs() + square.sqrt(),
    }
}

/// The covariance of a stable step on a mode with the time step `z = ωh` and the friction `γ/ω`; none of an unstable one.
pub fn mode_covariance(
    method: &LangevinMethod,
    z: f64,
    friction: f64,
) -> Option<ModeCovariance<f64>> {
    let wide = wide_covariance(method, z, friction)?;
    Some(ModeCovariance { qq: wide.qq.to_f64(), qv: wide.qv.to_f64(), vv: wide.vv.to_f64() })
}

/// The same with 106 bits, so that small biases keep their digits.
fn wide_covariance(
    method: &LangevinMethod,
    z: f64,
    friction: f64,
) -> Option<ModeCovariance<TwoFloat>> {
    if stability_margin(method, z, friction).is_nan()
        || stability_margin(method, z, friction) <= 0.0
    {
        return None;
    }
    let [z, friction] = [z, friction].map(TwoFloat::from_f64);
    let found = ModeCovariance::new(method, LangevinStep::new(z, friction, letters(method)));
    let is_finite = [found.qq, found.qv, found.vv].iter().all(|x| x.to_f64().is_finite());
    is_finite.then_some(found)
}

/// The number of letters O, among which friction is divided.
pub fn letters(method: &LangevinMethod) -> usize {
    match method {
        LangevinMethod::Word(word) => word.count(LangevinLetter::OrnsteinUhlenbeck),
        LangevinMethod::Gjf | LangevinMethod::EulerMaruyama => 1,
    }
}

/// Relative biases `⟨q²⟩ − 1` and `⟨v²⟩ − 1` of a stable step on a mode.
pub fn mode_biases(method: &LangevinMethod, z: f64, friction: f64) -> Option<[f64; 2]> {
    let wide = wide_covariance(method, z, friction)?;
    Some([wide.qq, wide.vv].map(|x| (x - TwoFloat::one()).to_f64()))
}

/// The friction over the frequency at which orders are found. At extreme ones 106 bits lose the bias, or the step is unstable.
const ORDER_FRICTION: f64 = 0.7;

/// The powers of the time step as which both biases vanish, of `⟨q²⟩` and `⟨v²⟩`, whatever the friction; none of a bias that is zero.
pub fn bias_orders(method: &LangevinMethod) -> Option<[Option<u32>; 2]> {
    // So small that the leading term is left, and not so small that 106 bits lose it.
    let [large, small] =
        [512.0_f64, 1024.0].map(|parts| mode_biases(method, parts.recip(), ORDER_FRICTION));
    let (large, small) = (large?, small?);
    let order = |i: usize| {
        // The rounding of 106 bits, over the part of a motion that a step forgets.
        let is_bias = small[i].abs() > 1e-22;
        is_bias.then(|| (large[i] / small[i]).log2().round().max(0.0) as u32)
    };
    Some([order(0), order(1)])
}

/// `⟨q²⟩` and `⟨v²⟩` of a step with exact numbers; undefined where they outgrow exact arithmetic.
pub(crate) fn exact_covariance(method: &LangevinMethod, step: LangevinStep<Ratio>) -> [Ratio; 2] {
    let ModeCovariance { qq, vv, .. } = SteinEquations::new(method, step).solve(Ratio::recip);
    [qq, vv]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn method(name: &str) -> LangevinMethod {
        name.parse().unwrap()
    }

    /// Closed forms of `⟨q²⟩` and `⟨v²⟩`: B. Leimkuhler, C. Matthews, *Molecular Dynamics*, 2015, section 7.4; J. Fass et al.,
    /// *Quantifying configuration-sampling error in Langevin simulations of complex molecular systems*, Entropy 20, 2018.
    #[test]
    fn covariances_of_words_are_the_closed_forms_whatever_the_friction() {
        for z in [0.1, 0.7, 1.3, 1.9] {
            let narrow = 1.0 - z * z / 4.0;
            for friction in [0.01, 1.0, 30.0] {
                for (name, qq, vv) in [
                    ("BAOAB", 1.0, narrow),
                    ("ABOBA", 1.0, 1.0 / narrow),
                    ("OBABO", 1.0 / narrow, 1.0),
                    ("OABAO", narrow, 1.0),
                    ("gjf", 1.0, narrow),
                ] {
                    let found = mode_covariance(&method(name), z, friction).unwrap();
                    assert!((found.qq - qq).abs() < 1e-13 * qq, "{name} {z} {friction} {found:?}");
                    assert!((found.vv - vv).abs() < 1e-13 * vv, "{name} {z} {friction} {found:?}");
                }
            }
        }
    }

    #[test]
    fn a_word_is_stable_up_to_the_limit_of_leapfrog_and_not_beyond() {
        for (name, limit) in [("BAOAB", 2.0), ("OABAO", 2.0), ("BABOBAB", 4.0), ("gjf", 2.0)] {
            assert!(mode_biases(&method(name), limit * 0.999, 0.5).is_some(), "{name}");
            assert!(mode_biases(&method(name), limit * 1.001, 0.5).is_none(), "{name}");
        }
        // Without friction nothing is stationary.
        assert_eq!(mode_biases(&method("BAOAB"), 0.5, 0.0), None);
    }

    #[test]
    fn biases_have_their_orders_and_exact_words_have_none() {
        for (name, orders) in [
            ("BAOAB", [None, Some(2)]),
            ("OBABO", [Some(2), None]),
            ("BAOA", [None, None]),
            // ⟨v²⟩ = 1 + (γ/2 + 1/γ)·z and ⟨q²⟩ = 1 + z/γ, to first order.
            ("euler-maruyama", [Some(1), Some(1)]),
        ] {
            assert_eq!(bias_orders(&method(name)), Some(orders), "{name}");
            // The order at a friction of the power by which the bias falls with the step.
            for friction in [0.1, 1.0, 10.0] {
                let [large, small] =
                    [1.0, 0.5].map(|h| mode_biases(&method(name), h / 512.0, friction).unwrap());
                for i in [0, 1] {
                    let factor = orders[i].map_or(1.0, |order| 2.0_f64.powi(order as i32));
                    let off = (large[i] - factor * small[i]).abs();
                    assert!(off <= 0.1 * large[i].abs() + 1e-20, "{name} {friction}");
                }
            }
        }
    }

    /// Stein's equation of `[[1, z], [−z, 1 − γz]]` by hand: with `d = 1 − γz`, `⟨q²⟩ = ⟨v²⟩·(1 + d + z²)/2` and
    /// `⟨v²⟩ = 2γz/(1 − d² − z²·d − z²·(1 + d + z²)/2)`. It is stable where `z < γ` and `z² − 2γz + 4 > 0`.
    #[test]
    fn euler_maruyama_has_its_covariance_and_its_stable_steps() {
        let euler = method("euler-maruyama");
        for (z, friction) in [(0.1, 1.0), (0.5, 2.0), (0.3, 0.5), (0.2, 6.0)] {
            let d = 1.0 - friction * z;
            let vv =
                2.0 * friction * z / (1.0 - d * d - z * z * d - z * z * (1.0 + d + z * z) / 2.0);
            let qq = vv * (1.0 + d + z * z) / 2.0;
            let found = mode_covariance(&euler, z, friction).unwrap();
            assert!((found.qq - qq).abs() < 1e-12 * qq, "{z} {friction} {found:?}");
            assert!((found.vv - vv).abs() < 1e-12 * vv, "{z} {friction} {found:?}");
        }
        for (friction, limit) in [(0.5, 0.5), (1.0, 1.0), (4.0, 4.0 - 12.0_f64.sqrt())] {
            assert!(mode_biases(&euler, limit * 0.999, friction).is_some(), "{friction}");
            assert!(mode_biases(&euler, limit * 1.001, friction).is_none(), "{friction}");
        }
    }
}
