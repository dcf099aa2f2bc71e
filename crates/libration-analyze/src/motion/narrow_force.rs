//! Forces that act for less time than the evaluations of a motion are apart.

use std::sync::atomic::AtomicBool;

use libration::equations::Dynamics;

use super::reference::Samples;
use super::{MotionState, MotionSubject, adaptive_reference};
use crate::AnalyzeError;

/// Times at which motions are compared.
const SAMPLES: u32 = 64;

/// Tolerances of a motion, and of one that shows what differences the system amplifies.
const TOLERANCES: [f64; 2] = [1e-9, 1e-11];

/// The difference of motions with and without a look between evaluations from which a force is missed, relative to the range of a state.
const MISSED: f64 = 1e-4;

/// Operations of a motion: a fraction of a second.
const MOST_OPERATIONS: u64 = 1 << 26;

/// A time in s by which a force has acted that evaluations chosen by errors alone do not see, or about which forces have no bound. None if
/// there is none in `horizon` seconds, or if the motion takes long.
///
/// # Errors
/// [`AnalyzeError::Interrupted`].
pub fn narrow_force(
    dynamics: &Dynamics,
    start: &[f64],
    horizon: f64,
    stop: &AtomicBool,
) -> Result<Option<f64>, AnalyzeError> {
    let degrees = dynamics.degrees();
    let state = |place| MotionState {
        place,
        name: String::new(),
        unit: String::new(),
        is_velocity: place >= degrees,
    };
    let states: Vec<MotionState> = (0..2 * degrees).map(state).collect();
    let mut start = start.to_vec();
    start.resize(2 * degrees + dynamics.inputs(), 0.0);
    let subject = MotionSubject {
        dynamics,
        start: &start,
        states: &states,
        is_affine: false,
        energy_unit: "",
    };
    let rates = dynamics.accelerations();
    let of_polynomials = rates.polynomial_degrees(|input| input < 2 * degrees);
    if of_polynomials.iter().all(Option::is_some) {
        return Ok(None);
    }
    let times: Vec<f64> =
        (1..=SAMPLES).map(|i| horizon * (f64::from(i) / f64::from(SAMPLES))).collect();
    let follow = |tolerance, looks| {
        adaptive_reference::follow(&subject, &times, tolerance, MOST_OPERATIONS, looks, stop)
    };
    let looking = follow(TOLERANCES[0], true)?;
    if looking.unseen.is_some() {
        return Ok(looking.unseen);
    }
    let apart = |a: &Samples, b: &Samples, i: usize| {
        (0..2 * degrees).fold(0.0, |most, place| {
            let range = a.ranges[place][1] - a.ranges[place][0];
            let off = (a.states[i][place] - b.states[i][place]).abs();
            if off > 0.0 { f64::max(most, off / range) } else { most }
        })
    };
    let plain = follow(TOLERANCES[0], false)?;
    let both = looking.states.len().min(plain.states.len());
    let Some(missed) = (0..both).find(|&i| apart(&looking, &plain, i) > MISSED) else {
        return Ok(None);
    };
    let finer = follow(TOLERANCES[1], true)?;
    let is_known = missed < finer.states.len() && apart(&looking, &finer, missed) < 0.01 * MISSED;
    Ok(is_known.then(|| times[missed]))
}
