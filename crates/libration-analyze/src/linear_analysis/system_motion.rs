//! The motion of a nonlinear system under the loop around its linearisation.

use libration::ensemble::Execution;
use libration::linear::{LinearLoop, LoopTiming};
use libration::linear_loops::LinearLoops;
use libration::{AnyMethod, Method};
use libration_report::verdict::{Outcome, Verdict};
use libration_settings::equations::EquationSystem;
use libration_settings::linear_loop::OperatingPoint;
use libration_work::{Interrupted, Work};
use serde::Serialize;

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

/// The motion of a system by equations under the loop, without noise, from the start of the system.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SystemMotion {
    /// The deviation of each state from the operating point in place of the start, where the system starts at that point or the request
    /// states another one; none from the start.
    pub deviation: Option<f64>,
    /// The simulated time in s.
    pub duration: f64,
    /// Whether the motion returns to the operating point, and how it ends if not.
    pub end: MotionEnd,
}

/// The end of a motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MotionEnd {
    /// All deviations fall below a twentieth of their largest size.
    Returns,
    /// A state keeps a deviation.
    Away {
        /// The state whose deviation is largest beside its largest size.
        state: String,
        /// The deviation.
        deviation: f64,
    },
    /// A state grows by a factor of 1000 in the time in which the linearised loop forgets its start.
    Grows {
        /// The state.
        state: String,
        /// Its deviation.
        deviation: f64,
    },
    /// The state stops being finite.
    NotFinite,
    /// Steps of a quarter of the length end in another way.
    Unresolved,
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
            let Some((mut end, mut duration)) = followed(&from(&coarse), work)? else {
                return Ok(None);
            };
            if end != MotionEnd::Returns {
                let Some((other, longer)) = followed(&from(&fine), work)? else { return Ok(None) };
                let is_alike = core::mem::discriminant(&other) == core::mem::discriminant(&end);
                end = if is_alike { other } else { MotionEnd::Unresolved };
                duration = longer;
            }
            let returns = end == MotionEnd::Returns;
            last = Some(SystemMotion { deviation, duration, end });
            if returns {
                break;
            }
        }
        Ok(last)
    }
}

/// The end of a motion, and its duration in s; none where the loop cannot be simulated.
fn followed(
    request: &LinearRequest,
    work: &Work<'_>,
) -> Result<Option<(MotionEnd, f64)>, Interrupted> {
    let Ok(mut loops) = request.loops(Execution::serial()) else { return Ok(None) };
    let states = &request.linear.plant().states;
    let scale = ROUNDING * plant_scale(request);
    let deviation = |loops: &LinearLoops, i| loops.state(0, i).abs();
    let mut most: Vec<f64> = request.start.iter().map(|x| x.abs()).collect();
    let mut before = most.clone();
    for periods in 1..=PATIENCE * request.steps {
        work.check()?;
        loops.advance(1);
        if !loops.is_finite(0) {
            return Ok(Some((MotionEnd::NotFinite, loops.time(0))));
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
            return Ok(Some((MotionEnd::Grows { state, deviation }, loops.time(0))));
        }
        before.clone_from(&most);
        let rest = ROUNDING * most.iter().copied().fold(0.0, f64::max);
        let left = (0..states.len()).map(|i| (deviation(&loops, i) / (most[i] + rest), i));
        let left = left.max_by(|a, b| a.0.total_cmp(&b.0));
        match left.filter(|(left, _)| *left > RETURNED) {
            None => return Ok(Some((MotionEnd::Returns, loops.time(0)))),
            Some((_, i)) if periods == PATIENCE * request.steps => {
                let (state, deviation) = (states[i].name.clone(), loops.state(0, i));
                return Ok(Some((MotionEnd::Away { state, deviation }, loops.time(0))));
            }
            Some(_) => {}
        }
    }
    Ok(None)
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

impl SystemMotion {
    /// Where the motion begins and how it ends, in words.
    pub fn in_words(&self) -> String {
        let from = match self.deviation {
            None => "from the start of the system".to_owned(),
            Some(deviation) => format!("from {deviation:e} beside the operating point"),
        };
        let duration = format!("{:.4e}", self.duration).parse().unwrap_or(self.duration);
        match &self.end {
            MotionEnd::Returns => format!("the motion {from} returns within {duration} s"),
            MotionEnd::Away { state, deviation } => format!(
                "the motion {from} does not return: after {duration} s {state} is {deviation:.4e} from the operating point"
            ),
            MotionEnd::Grows { state, deviation } => format!(
                "the motion {from} leaves: after {duration} s {state} is {deviation:.4e} from the operating point, and grows"
            ),
            MotionEnd::NotFinite => format!("the motion {from} is not finite after {duration} s"),
            MotionEnd::Unresolved => {
                format!("the motion {from} ends differently in shorter steps of its simulation")
            }
        }
    }

    /// A good verdict on the linearised loop, together with this motion.
    pub fn judged(&self, of_loop: Verdict) -> Verdict {
        self.contradiction().unwrap_or_else(|| {
            let evidence = format!("{}; {}", of_loop.evidence, self.in_words());
            Verdict { evidence, ..of_loop }
        })
    }

    /// The verdict on a motion that does not return.
    pub fn contradiction(&self) -> Option<Verdict> {
        let outcome = match self.end {
            MotionEnd::Returns => return None,
            MotionEnd::NotFinite | MotionEnd::Grows { .. } if self.deviation.is_none() => {
                Outcome::Unstable
            }
            _ => Outcome::Unknown,
        };
        Some(Verdict::new(outcome, self.in_words()))
    }
}
