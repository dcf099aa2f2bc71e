//! The jitter margin of a loop.

use libration::Method;
use libration::analysis::{JitterMargin, Plant};
use libration::control::{Feedback, Jitter};
use libration::integrator::VelocityVerlet;
use libration_report::notation::number;
use libration_report::record::{Finding, Record, Tolerance};
use libration_study::{Lab, StudyError};

use super::map::{damped, damping};
use super::start;
use crate::sample::Sample;

/// `ωΔt` at which the margin is tried.
const Z: f64 = 1.7;

/// Parts of the margin that are tried: below it and above.
const SHARES: [f64; 2] = [0.7, 1.3];

const STEPS: [u64; 2] = [20, 40];

/// The margin of the damped loop in steps of `dt` seconds, as a standard deviation.
pub(super) fn margin(lab: &Lab<'_>, dt: f64) -> Option<f64> {
    match plant(lab, dt).jitter_margin(damping(lab), Jitter::Gaussian) {
        JitterMargin::Rms(rms) => Some(rms),
        JitterMargin::Beyond(_) | JitterMargin::Unstable => None,
    }
}

pub(super) fn plant(lab: &Lab<'_>, dt: f64) -> Plant<'static> {
    let model = lab.config.oscillator.system();
    Plant::new(VelocityVerlet, model, libration::State::origin(), dt)
}

/// Tries the loop below and above its margin.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let dt = Z / lab.config.oscillator.omega();
    let Some(margin) =
        margin(lab, dt).filter(|_| lab.config.integrators.contains(&Method::VelocityVerlet))
    else {
        return Ok(());
    };
    let text = format!(
        "velocity Verlet with a damper, ωΔt = {Z}: largest σ at which the mean square stays bounded, computed; loops below and above \
         it are simulated"
    );
    record.find(Finding::measured("jitter.margin.rms", text, "1", margin));
    let Feedback { velocity, .. } = damping(lab);
    let begin = start(lab);
    let starts = vec![begin; lab.effort.choose(4096, 32_768, 262_144)];
    let omega2 = lab.config.oscillator.system().omega2;
    for share in SHARES {
        let rms = share * margin;
        let theory = plant(lab, dt).mean_square(damping(lab), Jitter::Gaussian(rms));
        let energy = |[qq, _, vv]: [f64; 3]| omega2 * qq + vv;
        let first = energy(theory.moments(&begin, 0));
        let seen = damped(lab, dt, rms, &starts, &STEPS)?;
        for (steps, seen) in STEPS.iter().zip(&seen) {
            let wanted = energy(theory.moments(&begin, *steps)) / first;
            let energies = seen
                .logarithms(|y| (omega2 * y.q[0] * y.q[0] + y.v[0] * y.v[0]) / first)
                .into_iter()
                .map(f64::exp);
            let found = Sample::of(&energies.collect::<Vec<_>>());
            let text = format!(
                "velocity Verlet with a damper of {} s⁻¹, ωΔt = {Z}, at {share} of the margin: mean of E/E₀ after {steps} steps",
                number(velocity, 3)
            );
            record.find(Finding::predicted(
                format!("jitter.margin.share-{share}.steps-{steps}"),
                text,
                "1",
                wanted,
                found.mean,
                Tolerance::absolute(3.0 * found.error(), "three standard errors"),
            ));
        }
    }
    Ok(())
}
