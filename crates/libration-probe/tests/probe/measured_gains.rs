//! Gains in the step of a simulator beside closed forms.

use libration::linear::Matrix;
use libration_probe::{BlackBox, BlackBoxError, GainReport, MeasuredGains, ServoGain, Subject};
use libration_probe::{ServoIntegrator, ServosDescription, gains, gains_page};
use libration_report::verdict::Outcome;

/// Sliders with springs, servos and walls: kick, then drift.
pub(crate) struct Sliders {
    mass: f64,
    /// Stiffness of a spring of each slider.
    spring: Vec<f64>,
    /// Constant force on each slider.
    force: f64,
    /// Whether all sliders are one rigid body, so that their coordinates are the same.
    is_tied: bool,
    kp: Vec<f64>,
    kv: Vec<f64>,
}

impl Sliders {
    pub(crate) fn new(spring: &[f64], kp: &[f64], kv: &[f64]) -> Self {
        Sliders {
            mass: 2.0,
            spring: spring.to_vec(),
            force: 0.0,
            is_tied: false,
            kp: kp.to_vec(),
            kv: kv.to_vec(),
        }
    }
}

impl BlackBox for Sliders {
    fn step(&mut self, states: &Matrix, _: &Matrix, dt: f64) -> Result<Matrix, BlackBoxError> {
        let n = self.spring.len();
        let mut next = states.clone();
        for row in 0..states.rows() {
            let force = |i: usize| {
                let (q, v) = (states[(row, i)], states[(row, n + i)]);
                self.force - (self.spring[i] + self.kp[i]) * q - self.kv[i] * v
            };
            let mean = (0..n).map(force).sum::<f64>() / n as f64;
            let of_tie = |i: usize| {
                // A stiff tie of zero length would have its own modes; this one projects.
                let at = |k: usize| (0..n).map(|j| states[(row, k + j)]).sum::<f64>() / n as f64;
                (at(0), at(n), i)
            };
            for i in 0..n {
                let (q, v, f) = match self.is_tied {
                    true => {
                        let (q, v, _) = of_tie(i);
                        (q, v, mean)
                    }
                    false => (states[(row, i)], states[(row, n + i)], force(i)),
                };
                let v = v + dt * f / self.mass;
                next[(row, n + i)] = v;
                next[(row, i)] = q + dt * v;
            }
        }
        Ok(next)
    }

    fn is_batched(&self) -> bool {
        true
    }

    fn set_gains(&mut self, kp: &[f64], kv: &[f64]) -> Result<bool, BlackBoxError> {
        (self.kp, self.kv) = (kp.to_vec(), kv.to_vec());
        Ok(true)
    }
}

pub(crate) const DT: f64 = 0.01;

pub(crate) fn measured(mut sliders: Sliders, dt: f64) -> GainReport {
    let n = sliders.spring.len();
    let mut subject = Subject::new("sliders", vec![0.0; 2 * n], vec![], dt);
    subject.pairs = Some((0..n).map(|i| (i, n + i)).collect());
    let servo = |i: usize| ServoGain {
        name: format!("servo {i}"),
        kp: sliders.kp[i],
        kv: sliders.kv[i],
        inertia: sliders.mass,
        joint: Some(format!("joint {}", i + 1)),
    };
    let servos: Vec<ServoGain> = (0..n).map(servo).collect();
    let model = serde_json::json!({
        "mass": vec![sliders.mass; n], "kp": sliders.kp, "kv": sliders.kv, "stiffness": sliders.spring,
    });
    let model: ServosDescription = serde_json::from_value(model).unwrap();
    let found = MeasuredGains::measure(&mut sliders, &subject, &servos, 1).unwrap();
    gains(&model.servos().unwrap(), dt, 1, ServoIntegrator::SYMPLECTIC_EULER, vec![])
        .with_measured(found)
}

fn close(found: f64, wanted: f64) {
    // The growth that counts as none, 10⁻⁷, beside limits at which it grows as their distance.
    assert!((found / wanted - 1.0).abs() <= 1e-5, "{found:e} {wanted:e}");
}

#[test]
fn limits_of_a_measured_step_are_those_of_its_characteristic_polynomial() {
    for (spring, kp, kv) in [(0.0, 100.0, 3.0), (50.0, 1e4, 10.0), (0.0, 2e4, 0.0), (7.0, 0.0, 5.0)]
    {
        let found = measured(Sliders::new(&[spring], &[kp], &[kv]), DT);
        assert!(found.holds, "{}", found.answer);
        let of_both = 4.0 * 2.0 / (DT * DT);
        let servo = &found.measured.as_ref().unwrap().servos[0];
        close(servo.largest_kp, of_both - 2.0 * kv / DT - spring);
        close(servo.largest_kv, (of_both - spring - kp) * DT / 2.0);
        close(found.joints[0].largest_kp, servo.largest_kp);
    }
}

#[test]
fn a_constraint_that_the_servo_model_lacks_decides_by_the_measured_step() {
    // A spring of −30 N/m beside a servo of 10 N/m: unstable alone. Tied to another slider with 100 N/m the sum is stable.
    let mut sliders = Sliders::new(&[-30.0, 0.0], &[10.0, 100.0], &[1.0, 1.0]);
    let alone = measured(Sliders::new(&[-30.0], &[10.0], &[1.0]), DT);
    assert_eq!(alone.verdict.outcome, Outcome::Unstable);
    // s² + s/2 − 10 = 0.
    let growth = -0.25 + (0.0625 + 10.0_f64).sqrt();
    assert!((alone.growth_in_continuous_time.unwrap() / growth - 1.0).abs() < 1e-5);
    sliders.is_tied = true;
    let tied = measured(sliders, DT);
    assert!(tied.holds && tied.verdict.outcome == Outcome::Stable, "{}", tied.answer);
    // Both sliders as one: m q̈ = −(kp₁ + kp₂ − 30)/2 q.
    let servo = &tied.measured.as_ref().unwrap().servos[0];
    close(servo.largest_kp, 2.0 * (4.0 * 2.0 / (DT * DT) - 2.0 / DT) - 100.0 + 30.0);
}

#[test]
fn a_window_of_gains_has_both_ends() {
    let found = measured(Sliders::new(&[-500.0], &[100.0], &[20.0]), DT);
    assert_eq!(found.verdict.outcome, Outcome::Unstable);
    close(found.least_factor, 5.0);
    close(found.largest_factor, (4.0 * 2.0 / (DT * DT) - 2.0 * 20.0 / DT + 500.0) / 100.0);
    assert!(found.answer.contains("hold from 5"), "{}", found.answer);
}

#[test]
fn off_an_equilibrium_a_slow_motion_has_no_verdict() {
    let mut sliders = Sliders::new(&[0.0], &[100.0], &[3.0]);
    sliders.force = 5.0;
    let found = measured(sliders, DT);
    assert_eq!(found.verdict.outcome, Outcome::Unknown);
    assert!(!found.holds && found.answer.contains("no equilibrium"), "{}", found.answer);
    let mut beyond = Sliders::new(&[0.0], &[1e6], &[3.0]);
    beyond.force = 5.0;
    assert_eq!(measured(beyond, DT).verdict.outcome, Outcome::Unstable);
}

#[test]
fn a_spring_that_is_unstable_alone_is_named_and_neutral_modes_are_counted() {
    let found = measured(Sliders::new(&[1e6, 0.0], &[10.0, 10.0], &[1.0, 1.0]), DT);
    assert!(found.answer.starts_with("The step is unstable without any servo"), "{}", found.answer);
    let free = measured(Sliders::new(&[0.0, 0.0], &[0.0, 10.0], &[0.0, 1.0]), DT);
    assert!(free.holds && free.measured.as_ref().unwrap().neutral_modes == 2, "{}", free.answer);
    assert!(free.answer.contains("2 modes are neutral"), "{}", free.answer);
}

#[test]
fn growth_too_slow_for_the_differences_of_a_step_is_never_a_gain_that_holds() {
    // m s² + kv s + kp + spring = 0 with kv = 1 and a small stiffness k: a mode grows at −k 1/s, below 10⁻⁷ per step from k = −10⁻⁵ on.
    for (spring, kp) in [
        (0.0, -5e-6),
        (0.0, -1e-7),
        (0.0, -1e-9),
        (0.0, -1e-13),
        (-5e-6, 0.0),
        (-1e-5, 5e-6),
        (-1e-6, -1e-6),
    ] {
        let found = measured(Sliders::new(&[spring], &[kp], &[1.0]), DT);
        assert_eq!(found.verdict.outcome, Outcome::Unknown, "{spring:e} {kp:e}: {}", found.answer);
        assert!(found.largest_factor.is_nan() && !found.holds, "{}", found.answer);
    }
    // Beyond it the growth is known, and a spring that is stiffer than a negative gain holds.
    let fast = measured(Sliders::new(&[0.0], &[-5e-5], &[1.0]), DT);
    assert_eq!(fast.verdict.outcome, Outcome::Unstable, "{}", fast.answer);
    let held = measured(Sliders::new(&[2.0], &[-1.0], &[1.0]), DT);
    assert!(held.holds && held.verdict.not_examined[0].contains("negative kp of servo 0"));
    close(held.largest_factor, 2.0);
    // The verdict names the growth of a neutral mode that it cannot tell from none.
    let free = measured(Sliders::new(&[0.0], &[0.0], &[1.0]), DT);
    assert!(free.holds && free.answer.contains("Not examined: growth of neutral modes below"));
}

#[test]
fn a_step_without_a_derivative_has_no_verdict() {
    struct Kink(Sliders);
    impl BlackBox for Kink {
        fn step(&mut self, states: &Matrix, u: &Matrix, dt: f64) -> Result<Matrix, BlackBoxError> {
            let mut next = self.0.step(states, u, dt)?;
            for row in 0..states.rows() {
                next[(row, 1)] -= 0.5 * states[(row, 0)].abs();
            }
            Ok(next)
        }
        fn set_gains(&mut self, kp: &[f64], kv: &[f64]) -> Result<bool, BlackBoxError> {
            self.0.set_gains(kp, kv)
        }
    }
    let mut kink = Kink(Sliders::new(&[0.0], &[100.0], &[3.0]));
    let subject = Subject::new("kink", vec![0.0; 2], vec![], DT);
    let found = MeasuredGains::measure(&mut kink, &subject, &[], 1).unwrap();
    assert!(!found.is_differentiable);
    // The page shows no rate as zero, and says of which model the integrators are.
    let servos: ServosDescription =
        serde_json::from_str(r#"{"mass": [2], "kp": [100], "kv": [3]}"#).unwrap();
    let model = gains(&servos.servos().unwrap(), DT, 1, ServoIntegrator::SYMPLECTIC_EULER, vec![]);
    let page = gains_page(&model.with_measured(found));
    let modes = page.split("of the system (1/s)").nth(1).unwrap().split("</table>").next().unwrap();
    // Growth and frequency of the one pair of modes.
    assert!(modes.matches(">unknown<").count() == 2 && !modes.contains(">0<"), "{modes}");
    assert!(page.contains("Which integrator holds the gains in the servo model, without contacts"));
}

#[test]
fn the_page_of_a_measured_step_has_the_gain_and_the_limit_of_the_same_servo() {
    let mut found = measured(Sliders::new(&[50.0], &[3.0], &[0.5]), DT);
    // As a simulator describes it: the gain of the joint has its stiffness, too.
    found.joints[0].kp += 50.0;
    let page = gains_page(&found);
    let limit = found.measured.as_ref().unwrap().servos[0].largest_kp;
    // 4 m/h² − 2 kv/h − 50 = 79 850.
    close(limit, 79_850.0);
    for part in ["largest kp of servo 0; given 3<", "kp 3 of 79", "Keep kp of servo 0 below 79"] {
        assert!(page.contains(part), "{part}: {page}");
    }
    assert!(!page.contains("given 53") && !page.contains("kp 53 of"));
    let joints = page.split("<table").nth(1).unwrap().split("</table>").next().unwrap();
    assert!(joints.contains(">53<") && !joints.contains("largest kp"), "{joints}");
}

#[test]
fn gains_of_servos_at_a_force_limit_or_without_effect_are_unknown_and_have_no_limits() {
    let one = || vec!["`servo 0` is at its force limit".to_owned()];
    let stable = || measured(Sliders::new(&[0.0], &[100.0], &[3.0]), DT);
    assert_eq!(stable().verdict.outcome, Outcome::Stable);
    for (saturated, idle) in [(one(), vec![]), (vec![], one())] {
        let found = stable().with_inert_servos(saturated, idle);
        assert_eq!(found.verdict.outcome, Outcome::Unknown);
        assert!(found.answer.contains("`servo 0` is at its force limit"), "{}", found.answer);
        assert!(found.largest_factor.is_nan() && found.joints[0].largest_kp.is_nan());
        assert!(found.measured.as_ref().unwrap().servos.is_empty());
        assert!(found.integrators.iter().all(|row| !row.holds && row.largest_factor.is_nan()));
    }
    // 8·10⁴ N/m is the limit without damping: growth without a servo that does not act is growth, but the mean of two slopes is none.
    let unstable = || measured(Sliders::new(&[1e5], &[100.0], &[3.0]), DT);
    assert_eq!(unstable().with_inert_servos(vec![], one()).verdict.outcome, Outcome::Unstable);
    assert_eq!(unstable().with_inert_servos(one(), vec![]).verdict.outcome, Outcome::Unknown);
}
