//! The motion of a nonlinear system under the loop around its linearisation.

use libration::ensemble::Execution;
use libration::linear::{LinearLoop, LoopTiming};
use libration::linear_loops::LinearLoops;
use libration::{AnyMethod, Method};
use libration_settings::equations::EquationSystem;
use libration_settings::linear_loop::OperatingPoint;
use libration_work::{Interrupted, Work};

use super::motion_end::{Excursion, MotionEnd, SystemMotion};
use crate::linear_trajectory::LinearRequest;

/// A system by equations under a loop around its linearisation.
#[derive(Clone, Debug)]
pub struct SystemLoop {
    /// The system.
    pub system: EquationSystem,
    /// The point of the linearisation.
    pub point: OperatingPoint,
    /// Whether a request states this point, in place of the start of the system.
    pub has_stated_point: bool,
    /// The lengths of recorded periods, as multiples of their mean; none without time stamps.
    pub record: Option<Vec<f64>>,
    /// The rate of the fastest mode of the plant in 1/s.
    pub rate: f64,
}

/// Times in which second moments fall by a factor e until the linearised loop has forgotten its start.
pub const MEMORIES: f64 = 20.0;

/// Seed of the lengths of periods and of losses.
const SEED: u64 = 31;

/// Steps in a period.
const STEPS: f64 = 10.0;

/// Turn of the fastest mode of the plant in a step, in rad: RK4 errs by 10⁻⁶ then.
const TURN: f64 = 0.1;

/// Largest number of steps in the time in which the linearised loop forgets its start: about a second.
const MOST_STEPS: f64 = 5e5;

/// Multiples of that time after which a motion that has not returned counts as away: limits of commands delay a return.
const PATIENCE: u64 = 4;

/// Deviations from an operating point at which a system starts. One small enough returns where the linearisation holds.
const DEVIATIONS: [f64; 3] = [1e-3, 1e-6, 1e-9];

/// Part of its largest deviation to which a state returns. The linearised loop leaves e⁻¹⁰.
const RETURNED: f64 = 0.05;

/// Excursions of this many times the start of a state are told.
const FAR: f64 = 3.0;

/// Growth of a state that leaves.
const GROWN: f64 = 1e3;

/// Roundings of the largest deviation, which other states never lose.
const ROUNDING: f64 = 1e-9;

impl SystemLoop {
    /// The motion of the system under a loop whose second moments change by `growth` per period in its linearisation; none with lags and
    /// filters of channels, and if the simulation would take too many steps.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub fn motion(
        &self,
        linear: &LinearLoop,
        timing: &LoopTiming,
        growth: f64,
        work: &Work<'_>,
    ) -> Result<Option<SystemMotion>, Interrupted> {
        let period = linear.period();
        let longest = (period / STEPS).min(TURN / self.rate);
        let periods = (MEMORIES / -growth).ceil();
        let steps = periods * (period / longest);
        if steps.is_nan() || steps > MOST_STEPS {
            return Ok(None);
        }
        let plant = linear.plant();
        let request = LinearRequest {
            linear: linear.without_noise(),
            timing: timing.clone(),
            record: self.record.clone(),
            start: Vec::new(),
            reference: vec![0.0; plant.outputs.len()],
            disturbance: vec![0.0; plant.inputs.len()],
            steps: periods as u64,
            every: 1,
            ensemble: None,
            seed: SEED,
            motion: None,
        };
        let (system, point) = (&self.system, &self.point);
        let around = |longest| {
            request.clone().around_system(system, point, AnyMethod::from(Method::Rk4), longest)
        };
        let Ok([coarse, fine]) = around(longest).and_then(|own| Ok([own, around(0.25 * longest)?]))
        else {
            return Ok(None);
        };
        let scale = plant_scale(&coarse);
        let is_at_point = coarse.start.iter().all(|x| x.abs() <= ROUNDING * scale);
        let deviations = match is_at_point || self.has_stated_point {
            true => DEVIATIONS.map(|deviation| Some(deviation * scale)).to_vec(),
            false => vec![None],
        };
        let mut last = None;
        for deviation in deviations {
            let from = |request: &LinearRequest| {
                let start = match deviation {
                    Some(deviation) => vec![deviation; request.start.len()],
                    None => request.start.clone(),
                };
                LinearRequest { start, ..request.clone() }
            };
            let Some(mut found) = followed(&from(&coarse), work)? else { return Ok(None) };
            if found.end != MotionEnd::Returns {
                let Some(other) = followed(&from(&fine), work)? else { return Ok(None) };
                let kind = core::mem::discriminant::<MotionEnd>;
                let is_alike = kind(&other.end) == kind(&found.end);
                let end = if is_alike { other.end } else { MotionEnd::Unresolved };
                found = SystemMotion { end, ..other };
            }
            let returns = found.end == MotionEnd::Returns;
            found.excursion = found.excursion.filter(|_| deviation.is_none());
            last = Some(SystemMotion { deviation, ..found });
            if returns {
                break;
            }
        }
        Ok(last)
    }
}

/// A motion to its end; none where the loop cannot be simulated.
fn followed(request: &LinearRequest, work: &Work<'_>) -> Result<Option<SystemMotion>, Interrupted> {
    let Ok(mut loops) = request.loops(Execution::serial()) else { return Ok(None) };
    let states = &request.linear.plant().states;
    let scale = ROUNDING * plant_scale(request);
    let ended = |end, duration| SystemMotion { deviation: None, duration, end, excursion: None };
    let deviation = |loops: &LinearLoops, i| loops.state(0, i).abs();
    let mut most: Vec<f64> = request.start.iter().map(|x| x.abs()).collect();
    let mut before = most.clone();
    for periods in 1..=PATIENCE * request.steps {
        work.check()?;
        loops.advance(1);
        if !loops.is_finite(0) {
            return Ok(Some(ended(MotionEnd::NotFinite, loops.time(0))));
        }
        for (i, most) in most.iter_mut().enumerate() {
            *most = most.max(deviation(&loops, i));
        }
        if !periods.is_multiple_of(request.steps) {
            continue;
        }
        let grows = (0..states.len()).filter(|&i| most[i] > GROWN * before[i].max(scale));
        let grows = grows.max_by(|&i, &j| most[i].total_cmp(&most[j]));
        if let Some(i) = grows.filter(|_| periods > request.steps) {
            let (state, deviation) = (states[i].name.clone(), loops.state(0, i));
            return Ok(Some(ended(MotionEnd::Grows { state, deviation }, loops.time(0))));
        }
        before.clone_from(&most);
        let rest = ROUNDING * most.iter().copied().fold(0.0, f64::max);
        let left = (0..states.len()).map(|i| (deviation(&loops, i) / (most[i] + rest), i));
        let left = left.max_by(|a, b| a.0.total_cmp(&b.0));
        match left.filter(|(left, _)| *left > RETURNED) {
            None => {
                let excursion = excursion(request, &most);
                let end = ended(MotionEnd::Returns, loops.time(0));
                return Ok(Some(SystemMotion { excursion, ..end }));
            }
            Some((_, i)) if periods == PATIENCE * request.steps => {
                let (state, deviation) = (states[i].name.clone(), loops.state(0, i));
                return Ok(Some(ended(MotionEnd::Away { state, deviation }, loops.time(0))));
            }
            Some(_) => {}
        }
    }
    Ok(None)
}

/// The state that is farthest beside its start, where that is far.
fn excursion(request: &LinearRequest, most: &[f64]) -> Option<Excursion> {
    let starts = request.start.iter().map(|x| x.abs());
    let all = starts.zip(most).zip(&request.linear.plant().states);
    let far = all.filter(|((start, most), _)| *start > 0.0 && **most > FAR * start);
    let ((start, &deviation), signal) =
        far.max_by(|((a, x), _), ((b, y), _)| (*x / a).total_cmp(&(*y / b)))?;
    Some(Excursion { state: signal.name.clone(), deviation, start })
}

/// The size of the states at the operating point; 1 where they are zero.
fn plant_scale(request: &LinearRequest) -> f64 {
    let motion = request.motion.iter();
    let values = motion.flat_map(|own| own.places.iter().map(|&place| own.operating_point[place]));
    match values.map(f64::abs).fold(0.0, f64::max) {
        0.0 => 1.0,
        size => size,
    }
}
