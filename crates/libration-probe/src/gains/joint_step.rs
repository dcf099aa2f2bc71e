//! Steps of a joint alone in 1024-bit arithmetic.

use libration::analysis::{Spectrum, UpdateMatrix};
use libration::equations::{Definitions, Equations, StepProgram};
use libration::number::Wide;
use libration::{Scalar, State};

use super::growth::Growth;
use super::{ServoIntegrator, Torque};

/// Bits of 1024 that no rounding of a step reaches.
const ROUNDING: i64 = 1000;

/// Sizes of a stiffness or a damping in units of the step, as powers of two, beyond which its growth is lost in these bits.
const KNOWN: i64 = 990;

/// A joint alone, or a mode of joints, in units of the step and of its inertia: `q̈ = −(k_p + k) q − (k_v + d) q̇`.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointNumbers {
    pub(super) kp: Wide,
    pub(super) kv: Wide,
    pub(super) stiffness: Wide,
    pub(super) damping: Wide,
    pub(super) torque: Torque,
}

impl JointNumbers {
    /// Whether no force acts.
    fn is_free(&self) -> bool {
        match self.torque {
            Torque::EachSubstep => {
                (self.kp + self.stiffness).is_zero() && (self.kv + self.damping).is_zero()
            }
            Torque::Held => self.all().iter().all(|x| x.is_zero()),
        }
    }

    fn all(&self) -> [Wide; 4] {
        [self.kp, self.kv, self.stiffness, self.damping]
    }

    /// Whether a number is so small or so large that 1024 bits beside 1 lose it.
    fn is_lost(&self) -> bool {
        self.all().iter().any(|x| x.exponent().is_some_and(|size| size.abs() > KNOWN))
    }
}

/// Steps of an integrator on joints.
pub(super) struct JointSteps {
    /// From position, velocity, torque, stiffness, damping and time step; none of MuJoCo's Euler.
    program: Option<StepProgram>,
}

/// Rows of positions and velocities; columns of both and of a constant torque.
type AffineStep = [[Wide; 3]; 2];

impl JointSteps {
    pub(super) fn new(integrator: ServoIntegrator) -> Self {
        let ServoIntegrator::Method(method) = integrator else {
            return JointSteps { program: None };
        };
        let definitions = Definitions {
            coordinates: vec!["q".into()],
            accelerations: vec![("q".into(), "u - s*q - d*q'".into())],
            inputs: vec!["u".into()],
            varied: vec!["s".into(), "d".into()],
            ..Definitions::default()
        };
        let equations = Equations::new(&definitions).ok();
        JointSteps { program: equations.map(|own| StepProgram::of(method, own.dynamics())) }
    }

    /// The matrix of a step of `parts` substeps.
    fn matrix(&self, joint: &JointNumbers, parts: u32) -> UpdateMatrix<Wide> {
        let [kp, kv, stiffness, damping] = joint.all();
        let [a, b] = match joint.torque {
            Torque::EachSubstep => {
                let [[a, b, _], [c, d, _]] = power(self.substep(joint), parts);
                [[a, b], [c, d]]
            }
            Torque::Held => {
                let held =
                    JointNumbers { kp: Wide::ZERO, kv: Wide::ZERO, stiffness, damping, ..*joint };
                power(self.substep(&held), parts).map(|[q, v, u]| [q - u * kp, v - u * kv])
            }
        };
        let row = |[of_q, of_v]: [Wide; 2], e: &State<Wide, 1>| [of_q * e.q[0] + of_v * e.v[0]];
        UpdateMatrix::from_map(|e| State { q: row(a, &e), v: row(b, &e) })
    }

    fn substep(&self, joint: &JointNumbers) -> AffineStep {
        let [one, zero] = [Wide::one(), Wide::ZERO];
        let (stiffness, damping) = (joint.kp + joint.stiffness, joint.kv + joint.damping);
        let Some(program) = &self.program else {
            // `(1 + d) v' = v − (k_p + k) q − k_v v + u`, `q' = q + v'`.
            let of_v = [-stiffness, one - joint.kv, one];
            let of_v = of_v.map(|x| x / (one + joint.damping));
            return [[one + of_v[0], of_v[1], of_v[2]], of_v];
        };
        let mut run = program.program().on::<Wide>();
        let columns = [[one, zero, zero], [zero, one, zero], [zero, zero, one]].map(|[q, v, u]| {
            let inputs = [q, v, u, stiffness, damping, one];
            let mut end = run.run(&inputs);
            [end.next(), end.next()].map(|x| x.unwrap_or(Wide::NAN))
        });
        [0, 1].map(|i| columns.map(|column| column[i]))
    }

    /// Whether the joint grows under a step of `parts` substeps.
    pub(super) fn growth(&self, joint: &JointNumbers, parts: u32) -> Growth {
        if joint.is_free() {
            return Growth::None;
        }
        let step = self.matrix(joint, parts);
        let (trace, determinant) = (step.trace(), step.determinant());
        if trace.is_nan() || determinant.is_nan() {
            return Growth::Some;
        }
        let one = Wide::one();
        let scale = one + trace.abs() + determinant.abs();
        let sign = |x: Wide| match (x.exponent(), scale.exponent()) {
            (Some(size), Some(of)) if size >= of - ROUNDING => {
                if x.is_negative() {
                    -1
                } else {
                    1
                }
            }
            _ => 0,
        };
        // Both factors are inside the unit circle if the determinant is below 1 and the polynomial above 0 at 1 and −1.
        let sides = [one - determinant, one + determinant - trace, one + determinant + trace];
        match sides.map(sign) {
            [-1, ..] | [_, -1, _] | [_, _, -1] => Growth::Some,
            _ if joint.is_lost() => Growth::Unknown,
            // At −1, or a pair on the circle: one factor twice has but one shape, since a force acts.
            [_, _, 0] | [0, 0, _] => Growth::Some,
            _ => Growth::None,
        }
    }

    /// The spectral radius less 1.
    pub(super) fn radius_minus_one(&self, joint: &JointNumbers, parts: u32) -> f64 {
        let excess = Spectrum::new(&self.matrix(joint, parts)).radius_minus_one();
        if excess.is_nan() { f64::INFINITY } else { excess.to_f64() }
    }
}

/// A step after itself, `count` times in all, under one torque.
fn power(step: AffineStep, count: u32) -> AffineStep {
    let mut square = step;
    let mut all: Option<AffineStep> = None;
    let mut left = count;
    while left > 0 {
        if left % 2 == 1 {
            all = Some(all.map_or(square, |before| after(&square, &before)));
        }
        left /= 2;
        if left > 0 {
            square = after(&square, &square);
        }
    }
    all.unwrap_or(step)
}

fn after(second: &AffineStep, first: &AffineStep) -> AffineStep {
    second.map(|[q, v, u]| {
        let of = |k: usize| q * first[0][k] + v * first[1][k];
        [of(0), of(1), of(2) + u]
    })
}
