//! Design of a linear-quadratic regulator.

use libration_core::control::{Feedback, LqrWeights};
use libration_core::number::Wide;
use libration_core::{Scalar, State};

use super::riccati::{DOUBLINGS, Matrix, dot, riccati};
use super::{Plant, ZohStep};
use crate::spectrum::negligible;
use crate::{QuadraticForm, Spectrum};

/// The feedback that costs least, and what it costs.
#[derive(Clone, Copy, Debug)]
pub struct Regulator {
    /// The feedback, rounded to floats.
    pub feedback: Feedback,
    /// The cost-to-go matrix: the solution of the Riccati equation.
    pub cost: QuadraticForm<Wide>,
}

/// Error of an LQR design.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LqrError {
    /// A weight of position or velocity is invalid.
    #[error("the weight of the {of} is {weight}; it must be a number that is at least 0")]
    StateWeight {
        /// The weighted quantity.
        of: &'static str,
        /// The weight.
        weight: f64,
    },
    /// The weight of the command is invalid.
    #[error("the weight of the command is {0}; it must be a number above 0")]
    CommandWeight(f64),
    /// A motion that does not decay is out of reach of the command.
    #[error(
        "no feedback stabilises the plant: in steps of this size the command does not reach a \
         motion that does not decay"
    )]
    OutOfReach,
    /// A motion that does not decay costs nothing.
    #[error(
        "the feedback that costs least is not stable: the weights miss a motion that does \
         not decay; give weights above 0 to both position and velocity"
    )]
    Unseen,
    /// The iteration did not come to an end.
    #[error(
        "the Riccati equation was not solved in {DOUBLINGS} doublings: the loop that costs least is \
         too close to the edge of stability, or the step has no value"
    )]
    Unsettled,
}

impl Plant<'_> {
    /// The feedback that costs least over all steps from any state: the linear–quadratic regulator of the
    /// step that is shipped, with a command that acts at once. The cost is the sum over the samples, which has the minimum of
    /// [`Plant::cost`] in the limit of short periods only.
    ///
    /// # Errors
    /// [`LqrError`]: weights that are none, or a loop that they do not make stable.
    pub fn lqr(&self, weights: LqrWeights) -> Result<Feedback, LqrError> {
        self.regulator(weights).map(|regulator| regulator.feedback)
    }

    /// The regulator with its cost.
    ///
    /// Of the discrete Riccati equation `X = Q + ΦᵀXΦ − ΦᵀXΓ(r + ΓᵀXΓ)⁻¹ΓᵀXΦ` this is the solution that is approached
    /// from a finite horizon, which is doubled again and again.
    ///
    /// # Errors
    /// [`LqrError`]: weights that are none, or a loop that they do not make stable.
    pub fn regulator(&self, weights: LqrWeights) -> Result<Regulator, LqrError> {
        let (state, command) = checked(weights)?;
        let ZohStep { phi, gamma } = (self.step)(self.dt);
        if out_of_reach(&phi, &gamma) {
            return Err(LqrError::OutOfReach);
        }
        let cost = riccati(phi, gamma, state, command).ok_or(LqrError::Unsettled)?;
        // K = (r + ΓᵀXΓ)⁻¹·ΓᵀXΦ.
        let image = cost.apply(&gamma);
        let price = command + dot(&image, &gamma);
        let gain = |column: &State<Wide, 1>| (dot(&image, column) / price).to_f64();
        let feedback = Feedback { position: gain(&phi.dq), velocity: gain(&phi.dv) };
        let excess = Spectrum::new(&self.closed(feedback, self.dt)).radius_minus_one();
        if !excess.is_negative() {
            return Err(LqrError::Unseen);
        }
        let qv = (cost.entry(0, 1) + cost.entry(1, 0)).ratio(1, 2);
        let cost = QuadraticForm { qq: cost.entry(0, 0), qv, vv: cost.entry(1, 1) };
        Ok(Regulator { feedback, cost })
    }
}

/// `Q` and `r`.
fn checked(weights: LqrWeights) -> Result<(Matrix, Wide), LqrError> {
    for (of, weight) in [("position", weights.position), ("velocity", weights.velocity)] {
        if !(weight.is_finite() && weight >= 0.0) {
            return Err(LqrError::StateWeight { of, weight });
        }
    }
    if !(weights.command.is_finite() && weights.command > 0.0) {
        return Err(LqrError::CommandWeight(weights.command));
    }
    let [q, v, u] = [weights.position, weights.velocity, weights.command].map(Wide::from_f64);
    Ok((Matrix::from_map(|e| State { q: [q * e.q[0]], v: [v * e.v[0]] }), u))
}

/// Whether there is an uncontrollable mode that does not decay.
fn out_of_reach(phi: &Matrix, gamma: &State<Wide, 1>) -> bool {
    let next = phi.apply(gamma);
    let (one, other) = (gamma.q[0] * next.v[0], gamma.v[0] * next.q[0]);
    if !negligible(one - other, one.abs() + other.abs()) {
        return false;
    }
    let size = dot(gamma, gamma);
    if size.is_zero() {
        return !Spectrum::new(phi).radius_minus_one().is_negative();
    }
    // Γ is an eigenvector; the command does not change the other eigenvalue.
    let eigenvalue = phi.trace() - dot(gamma, &next) / size;
    eigenvalue.abs() >= Wide::one()
}

#[cfg(test)]
mod tests {
    use libration_core::integrator::VelocityVerlet;
    use libration_core::system::{DampedOscillator, Oscillator};

    use super::super::sample::{all, textbook};
    use super::*;

    const MODEL: Oscillator<f64> = Oscillator { omega2: 10.0 };
    const WEIGHTS: LqrWeights = LqrWeights { position: 50.0, velocity: 2.0, command: 0.5 };

    #[test]
    fn the_loop_is_stable_in_steps_of_every_method() {
        let mut tried = 0;
        for (omega2, gamma, dt) in
            [(10.0, 0.0, 0.1), (0.0, 0.0, 0.2), (25.0, -0.8, 0.05), (3.0, 1.5, 0.3)]
        {
            for weights in [WEIGHTS, LqrWeights { position: 1.0, velocity: 0.0, command: 1e4 }] {
                for (name, plant) in all(DampedOscillator { omega2, gamma }, dt) {
                    let feedback = plant.lqr(weights).unwrap();
                    let closed = Spectrum::new(&plant.closed(feedback, plant.dt));
                    assert!(closed.radius().to_f64() < 1.0, "{name} {omega2} {gamma}");
                    tried += 1;
                }
            }
        }
        assert!(tried >= 40, "{tried}");
    }

    #[test]
    fn gains_and_costs_are_those_of_plain_iteration_in_floats() {
        // X ← Q + ΦᵀXΦ − ΦᵀXΓ(r + ΓᵀXΓ)⁻¹ΓᵀXΦ in NumPy, from X = Q until it moved by less than 10⁻¹⁵ of itself, with the
        // matrices of textbooks: K_p, K_d, and X by rows.
        let wanted = [
            [
                1.281891234072361,
                4.127730283448078,
                365.87219268538433,
                38.637621055936386,
                28.566278664558048,
            ],
            [
                1.8424453088731065,
                2.9878244553174573,
                252.29793149889315,
                9.212226544365507,
                16.939122276587273,
            ],
            [
                1.880742320816138,
                3.1142925244709843,
                272.6611322646945,
                21.063352017759378,
                19.050902793069604,
            ],
            [
                1.8811884089942799,
                3.0865195341205367,
                274.72033955988815,
                20.89333671982563,
                18.747180402725398,
            ],
            [
                1.8809425010808718,
                3.086613218519936,
                274.7109420755622,
                20.89342841954138,
                18.7467816660836,
            ],
        ];
        for ((name, plant), wanted) in textbook(MODEL, 0.1).into_iter().zip(wanted) {
            let Regulator { feedback, cost } = plant.regulator(WEIGHTS).unwrap();
            let [qq, qv, vv] = [cost.qq, cost.qv, cost.vv].map(Wide::to_f64);
            let found = [feedback.position, feedback.velocity, qq, qv, vv];
            for (found, wanted) in found.into_iter().zip(wanted) {
                // The iteration falls by 0.7 a step: its last change is a third of its error; the rest is rounding.
                assert!((found / wanted - 1.0).abs() < 1e-13, "{name}: {found} {wanted}");
            }
        }
    }

    #[test]
    fn short_steps_give_the_regulator_of_continuous_time() {
        // A'P + PA − PBB'P/r + Q = 0 for q̈ = −ω²q + u is solved by P = r·[[K_p K_d + ω²K_d, K_p], [K_p, K_d]].
        let LqrWeights { position, velocity, command } = WEIGHTS;
        let kp = (100.0 + position / command).sqrt() - 10.0;
        let kd = (2.0 * kp + velocity / command).sqrt();
        let p = [kd * (kp + 10.0), kp, kd].map(|x| x * command);
        let of = |dt: f64| -> Vec<[f64; 5]> {
            let found = |(_, plant): &(_, Plant<'_>)| {
                let Regulator { feedback, cost } = plant.regulator(WEIGHTS).unwrap();
                // The sum over steps, times their length, is the integral.
                let [qq, qv, vv] = [cost.qq, cost.qv, cost.vv].map(|x| x.to_f64() * dt);
                [feedback.position, feedback.velocity, qq, qv, vv]
            };
            textbook(MODEL, dt).iter().map(found).collect()
        };
        let (long, short) = (of(1.0 / 256.0), of(1.0 / 512.0));
        for (long, short) in long.into_iter().zip(short) {
            let wanted = [kp, kd, p[0], p[1], p[2]];
            for i in 0..5 {
                let limit = 2.0 * short[i] - long[i];
                // The error is of first order; without its first term it falls as Δt², 4·10⁻⁶, with factors up to ω².
                assert!((short[i] / wanted[i] - 1.0).abs() < 0.04, "{short:?} {wanted:?}");
                assert!((limit / wanted[i] - 1.0).abs() < 4e-4, "{i}: {limit} {wanted:?}");
            }
        }
    }

    #[test]
    fn the_cost_is_the_sum_over_all_steps_and_any_other_feedback_costs_more() {
        for (name, plant) in textbook(MODEL, 0.1) {
            let Regulator { feedback, cost } = plant.regulator(WEIGHTS).unwrap();
            let start = State { q: [1.0], v: [-2.0] };
            let spent = |feedback: Feedback| {
                let closed = plant.closed(feedback, plant.dt).map(Wide::to_f64);
                let mut state = start;
                // 0.75⁴⁰⁰ of the start is left.
                (0..400).fold(0.0, |sum, _| {
                    let State { q: [q], v: [v] } = state;
                    let u = feedback.position * q + feedback.velocity * v;
                    state = closed.apply(&state);
                    sum + 50.0 * q * q + 2.0 * v * v + 0.5 * u * u
                })
            };
            let wanted = cost.at(&start.map(Wide::from_f64)).to_f64();
            let least = spent(feedback);
            assert!((least / wanted - 1.0).abs() < 1e-13, "{name}: {least} {wanted}");
            for (p, v) in [(0.1, 0.0), (-0.1, 0.0), (0.0, 0.1), (0.0, -0.1)] {
                let Feedback { position, velocity } = feedback;
                let other = Feedback { position: position + p, velocity: velocity + v };
                assert!(spent(other) > least, "{name}");
            }
        }
    }

    #[test]
    fn what_has_no_regulator_is_refused_in_words() {
        let plant = || Plant::new(VelocityVerlet, MODEL, State::origin(), 0.1);
        let refused = |plant: Plant<'_>, weights| plant.lqr(weights).unwrap_err();
        let of = |position, velocity, command| LqrWeights { position, velocity, command };
        assert!(refused(plant(), of(-1.0, 1.0, 1.0)).to_string().contains("position is -1"));
        assert!(refused(plant(), of(1.0, f64::NAN, 1.0)).to_string().contains("velocity is NaN"));
        assert_eq!(refused(plant(), of(1.0, 1.0, 0.0)), LqrError::CommandWeight(0.0));
        assert!(matches!(
            refused(plant(), of(1.0, 1.0, f64::INFINITY)),
            LqrError::CommandWeight(_)
        ));
        // Nothing costs anything, and nothing decays.
        assert_eq!(refused(plant(), of(0.0, 0.0, 1.0)), LqrError::Unseen);
        // Where a mass without a spring lies costs nothing.
        let free = Plant::new(VelocityVerlet, Oscillator { omega2: 0.0 }, State::origin(), 0.1);
        assert_eq!(refused(free, of(0.0, 1.0, 1.0)), LqrError::Unseen);
        // At z = 2 a held command moves the position alone, and the velocity changes its sign for ever.
        let edge = Plant::new(VelocityVerlet, Oscillator { omega2: 4.0 }, State::origin(), 1.0);
        assert_eq!(refused(edge, WEIGHTS), LqrError::OutOfReach);
        let none = Plant::new(VelocityVerlet, MODEL, State::origin(), f64::NAN);
        assert_eq!(refused(none, WEIGHTS), LqrError::Unsettled);
    }
}
