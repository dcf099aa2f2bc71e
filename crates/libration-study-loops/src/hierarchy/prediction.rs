//! Predicted distances of disturbed trajectories.

use libration::State;
use libration::analysis::{JitterMargin, Plant, StepNoise};
use libration::control::{Feedback, Jitter, Latency};
use libration::integrator::SymplecticEuler;
use libration::system::Oscillator;

use super::disturbed_run::{COUNT, DT, SPRING};
use super::imperfection::{Kind, Profile};

pub(super) const ORIGIN: State<f64, 1> = State { q: [0.0], v: [0.0] };

/// Nobody commands.
const FREE: Feedback = Feedback { position: 0.0, velocity: 0.0 };

/// The gains of the loop whose margins are told.
pub(super) const GAINS: Feedback = Feedback { position: 10.0, velocity: 2.0 };

/// The rms distance from the undisturbed orbits in units of their size, after `n` steps; none where rounding decides.
pub(super) fn divergence(kind: Kind, profile: &Profile, n: u64) -> Option<f64> {
    let n = n as f64;
    let apart = |angle_squared: f64| (-2.0 * (-angle_squared / 2.0).exp_m1()).sqrt();
    match kind {
        Kind::Latency => Some((growth(profile.latency)? * n).exp_m1()),
        Kind::Jitter => Some(apart(n * turned(profile.jitter)?.powi(2))),
        Kind::Asynchrony => Some(apart((n * turned(profile.asynchrony)?).powi(2))),
        Kind::Precision => None,
    }
}

/// The rms of `ln E/E₀` after `n` steps; none where rounding decides.
pub(super) fn energy(kind: Kind, profile: &Profile, n: u64) -> Option<f64> {
    let n = n as f64;
    match kind {
        Kind::Latency => Some(2.0 * n * growth(profile.latency)?),
        Kind::Jitter => {
            let plant = Plant::new(SymplecticEuler, SPRING, ORIGIN, DT);
            let noise = StepNoise::white(profile.jitter);
            let rate = n * plant.resonance(FREE)?.weak_growth(noise);
            Some((2.0 * rate).hypot(2.0 * rate.sqrt()))
        }
        Kind::Asynchrony => Some(0.0),
        Kind::Precision => None,
    }
}

/// Returns the tolerance of that prediction, with its reason.
pub(super) fn energy_tolerance(kind: Kind, profile: &Profile, energy: f64) -> (f64, &'static str) {
    let z = SPRING.omega2.sqrt() * DT;
    match kind {
        Kind::Latency => (
            2.0 * z * (1.0 + profile.latency) * (1.0 + energy),
            "the angle of the latency, by which an orbit that begins without a past is off",
        ),
        Kind::Asynchrony => (
            4.0 * z * profile.asynchrony,
            "the ellipse that a clock keeps differs by the angle of a step times the error of its rate, of which no \
             one has four deviations",
        ),
        _ => (tolerance(kind, profile).0 * energy, tolerance(kind, profile).1),
    }
}

/// The number of steps after which trajectories are this far apart, if they are after `most`.
pub(super) fn horizon(kind: Kind, profile: &Profile, far: f64, most: u64) -> Option<f64> {
    let (mut near, mut beyond) = (0, most);
    if divergence(kind, profile, most)? < far {
        return None;
    }
    while beyond - near > 1 {
        let middle = near + (beyond - near) / 2;
        match divergence(kind, profile, middle)? < far {
            true => near = middle,
            false => beyond = middle,
        }
    }
    Some(beyond as f64)
}

/// The size at which a loop that a PD controller closes is no longer stable; none where no size is known.
///
/// Of the latency in steps, of jitter as the relative rms of Gaussian steps (in the mean square), of asynchrony as the
/// part by which a clock may be slow.
pub(super) fn critical(kind: Kind) -> Option<f64> {
    let plant = |dt: f64| Plant::new(SymplecticEuler, SPRING, ORIGIN, dt);
    match kind {
        Kind::Latency => plant(DT).split_critical_latency(GAINS),
        Kind::Jitter => match plant(DT).jitter_margin(GAINS, Jitter::Gaussian) {
            JitterMargin::Rms(rms) => Some(rms),
            JitterMargin::Beyond(_) | JitterMargin::Unstable => None,
        },
        Kind::Asynchrony => {
            let none = Latency::of_steps(0.0)?;
            let stable =
                |part: f64| plant(DT * (1.0 + part)).spectral_radius(GAINS, none).to_f64() <= 1.0;
            let (mut low, mut high) = (0.0, 1.0);
            while stable(high) {
                (low, high) = (high, 2.0 * high);
            }
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if stable(middle) { low = middle } else { high = middle }
            }
            Some(low)
        }
        Kind::Precision => None,
    }
}

/// Returns the relative tolerance of the prediction, with its reason.
pub(super) fn tolerance(kind: Kind, profile: &Profile) -> (f64, &'static str) {
    let z = SPRING.omega2.sqrt() * DT;
    match kind {
        Kind::Latency => (
            0.02 + 2.0 * z * (1.0 + profile.latency),
            "an orbit that begins without a past lies off the growing one by the angle of the latency",
        ),
        _ => (
            4.0 / (2.0 * COUNT as f64).sqrt() + z,
            "four standard errors of a root mean square over the trajectories, and the angle of a step",
        ),
    }
}

/// The growth of the orbit in a step where the force is so many steps late: the spring as a feedback of what moves
/// freely without it.
fn growth(steps: f64) -> Option<f64> {
    let free = Plant::new(SymplecticEuler, Oscillator { omega2: 0.0 }, ORIGIN, DT);
    let spring = Feedback { position: SPRING.omega2, velocity: 0.0 };
    Some(free.spectral_radius(spring, Latency::of_steps(steps)?).to_f64().ln())
}

/// The rms angle by which a relative change of this rms in the length of a step turns a trajectory.
fn turned(rms: f64) -> Option<f64> {
    let plant = Plant::new(SymplecticEuler, SPRING, ORIGIN, DT);
    // The mean over a Gaussian law has fallen to 1/e where the angle is √2.
    Some(2.0_f64.sqrt() / plant.dephasing_steps(Jitter::Gaussian(rms))?.to_f64())
}
