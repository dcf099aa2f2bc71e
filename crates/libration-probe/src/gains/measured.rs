//! Gains of servos in the step of the simulator itself.

use core::time::Duration;
use std::time::Instant;

use libration_report::verdict::Outcome;
use serde::Serialize;

use super::ServoGain;
use super::gain_search::{ERRORS, Gains, OUTSIDE, Search, by_step_alone};
use super::limit_in_json::limit;
use crate::flow::Flow;
use crate::linearised_step::LinearisedStep;
use crate::modes::{ProbedMode, modes};
use crate::prober::Prober;
use crate::rest::Rest;
use crate::{BlackBox, BlackBoxError, OperatingPoint, Subject};

/// Largest relative error of a row at which the step counts as differentiable.
const DIFFERENTIABLE: f64 = 0.01;
/// Time after which no search for the limit of another servo begins.
const PATIENCE: Duration = Duration::from_secs(90);

/// A servo with its limits in the measured step, all others as they are.
#[derive(Clone, Debug, Serialize)]
pub struct ServoRow {
    /// Its name.
    pub name: String,
    /// The joint on which it acts; none if there are several.
    pub joint: Option<String>,
    /// Its gain of position.
    pub kp: f64,
    /// Its gain of velocity.
    pub kv: f64,
    /// Its largest gain of position; 0 if none is stable, and not a number if the servo moves nothing at the point.
    #[serde(serialize_with = "limit")]
    pub largest_kp: f64,
    /// Its largest gain of velocity; 0 if none is stable.
    #[serde(serialize_with = "limit")]
    pub largest_kv: f64,
}

impl ServoRow {
    /// A servo that moves nothing at the point, where no gain of it changes the step.
    fn without_limits(servo: &ServoGain) -> Self {
        ServoRow {
            name: servo.name.clone(),
            joint: servo.joint.clone(),
            kp: servo.kp,
            kv: servo.kv,
            largest_kp: f64::NAN,
            largest_kv: f64::NAN,
        }
    }
}

/// What the step of the simulator does with the gains.
#[derive(Clone, Debug, Serialize)]
pub struct MeasuredGains {
    /// Where the point is from the requested one, if it was searched for.
    pub operating_point: Option<OperatingPoint>,
    /// Whether the point is an equilibrium of the step.
    pub equilibrium: Rest,
    /// The estimated relative error of the matrix of the step.
    pub error: f64,
    /// Whether the step has a derivative.
    pub is_differentiable: bool,
    /// The modes of the step beside those of the system, the one that grows fastest first: those of `probe`.
    pub modes: Vec<ProbedMode>,
    /// The largest factor of a mode per substep.
    pub spectral_radius: f64,
    /// Modes whose factors are 1 within their errors: those of a free base.
    pub neutral_modes: usize,
    /// Growth per substep that errors of the step may hide.
    pub hidden_growth: f64,
    /// The same as a growth rate in 1/s.
    pub hidden_growth_rate: f64,
    /// A servo with a negative gain of position: where it moves nothing but a neutral mode, that mode grows, however slowly.
    pub negative_gain: Option<String>,
    /// Whether a mode grows beyond errors.
    pub grows: bool,
    /// The growth rate in 1/s of a mode that grows in the system as well, whatever the step.
    pub growth_of_system: Option<f64>,
    /// The largest factor of a mode without gains of these servos, if it leaves the unit circle by the step alone. Other actuators act.
    pub unstable_without_servos: Option<f64>,
    /// The largest factor of all gains of position, with the same gains of velocity.
    #[serde(serialize_with = "limit")]
    pub largest_factor: f64,
    /// The least factor, if the given gains are too small; else 0.
    pub least_factor: f64,
    /// The fewest substeps with which the gains hold; none up to 1000.
    pub fewest_substeps: Option<u32>,
    /// The servos.
    pub servos: Vec<ServoRow>,
    /// Servos whose limits were not searched for, since the time was over.
    pub not_searched: Vec<String>,
}

impl MeasuredGains {
    /// The gains in a step whose length is that of the subject, of `substeps` in a step of the simulator.
    ///
    /// # Errors
    /// The simulator fails.
    pub fn measure(
        black_box: &mut dyn BlackBox,
        subject: &Subject,
        servos: &[ServoGain],
        substeps: u32,
    ) -> Result<Self, BlackBoxError> {
        let start = Instant::now();
        let mut prober = Prober::new(black_box, subject);
        prober.step_one(&subject.state, &subject.action, subject.dt)?;
        let equilibrium = Rest::measure(&mut prober)?;
        let step = LinearisedStep::at(&mut prober, subject.dt)?;
        let error = step.relative_error_of_states(subject);
        let is_differentiable = step.is_finite() && error <= DIFFERENTIABLE;
        let flow = if is_differentiable { Flow::of(&mut prober, &step)? } else { None };
        let found = modes(&step, flow.as_ref(), subject);
        let is_at_rest = equilibrium.holds;
        let mut report = MeasuredGains {
            operating_point: subject.operating_point.clone(),
            equilibrium,
            error,
            is_differentiable,
            spectral_radius: found.iter().map(|mode| mode.radius).fold(0.0, f64::max),
            modes: found,
            neutral_modes: 0,
            hidden_growth: 0.0,
            hidden_growth_rate: 0.0,
            negative_gain: servos
                .iter()
                .find(|servo| servo.kp < 0.0)
                .map(|servo| servo.name.clone()),
            grows: false,
            growth_of_system: None,
            unstable_without_servos: None,
            largest_factor: f64::NAN,
            least_factor: 0.0,
            fewest_substeps: None,
            servos: Vec::new(),
            not_searched: servos.iter().map(|servo| servo.name.clone()).collect(),
        };
        if !is_differentiable {
            return Ok(report);
        }
        let (kp, kv) = (
            servos.iter().map(|servo| servo.kp).collect(),
            servos.iter().map(|servo| servo.kv).collect(),
        );
        let mut search = Search {
            prober: &mut prober,
            kp,
            kv,
            dt: subject.dt,
            is_at_rest,
            outside: OUTSIDE,
            is_quick: true,
        };
        let (outside, neutral_modes) = search.errors(&step.a)?;
        search.outside = outside;
        (report.neutral_modes, report.hidden_growth) = (neutral_modes, outside);
        report.hidden_growth_rate = outside / subject.dt;
        report.grows = search.is_unstable(&step.a);
        report.growth_of_system = report.growth(report.hidden_growth_rate);
        if report.grows {
            let none = vec![0.0; servos.len()];
            let passive = search.step(&(none.clone(), none), subject.dt)?;
            report.unstable_without_servos = by_step_alone(&passive, outside);
        }
        // Limits beside gains of which nothing is known would be read as gains that hold.
        if report.verdict().outcome == Outcome::Unknown {
            return Ok(report);
        }
        report.limits(&mut search, servos, start)?;
        report.fewest_substeps = search.fewest_substeps(substeps)?;
        Ok(report)
    }

    /// The mode that grows beyond its own error where errors of other modes may hide as much; none where growth is known.
    pub(super) fn doubtful_growth(&self) -> Option<&ProbedMode> {
        let growing = |mode: &&ProbedMode| mode.step.growth_rate > ERRORS * mode.error;
        let most =
            |a: &&ProbedMode, b: &&ProbedMode| a.step.growth_rate.total_cmp(&b.step.growth_rate);
        self.modes.iter().filter(growing).max_by(most).filter(|_| !self.grows)
    }

    /// Whether the requested point is an equilibrium.
    pub(super) fn is_at_rest(&self) -> bool {
        let is_near = |point: &OperatingPoint| point.run.stands && !point.is_far();
        self.is_differentiable
            && self.equilibrium.holds
            && self.operating_point.as_ref().is_none_or(is_near)
    }

    /// Whether there are servos whose gains are changed.
    pub(super) fn has_servos(&self) -> bool {
        !(self.servos.is_empty() && self.not_searched.is_empty())
    }

    /// The growth rate of the system itself; it counts at an equilibrium only.
    fn growth(&self, unclear: f64) -> Option<f64> {
        let rates = self.modes.iter().filter_map(|mode| Some((mode.flow?, mode.error)));
        let known = rates.filter(|(flow, error)| flow.growth_rate > unclear.max(ERRORS * error));
        let most = known.map(|(flow, _)| flow.growth_rate).reduce(f64::max);
        most.filter(|_| self.equilibrium.holds)
    }

    fn limits(
        &mut self,
        search: &mut Search<'_, '_>,
        servos: &[ServoGain],
        start: Instant,
    ) -> Result<(), BlackBoxError> {
        let (kp, kv) = (search.kp.clone(), search.kv.clone());
        if kp.iter().any(|kp| *kp != 0.0) {
            let scaled =
                |factor: f64| -> Gains { (kp.iter().map(|kp| kp * factor).collect(), kv.clone()) };
            let all = search.limits(1.0, 1.0, &scaled)?;
            (self.largest_factor, self.least_factor) = (all.most, all.least);
        } else if !servos.is_empty() {
            self.largest_factor = f64::INFINITY;
        }
        for (k, servo) in servos.iter().enumerate() {
            if start.elapsed() > PATIENCE {
                return Ok(());
            }
            let with = |values: &[f64], value: f64| {
                let mut values = values.to_vec();
                values[k] = value;
                values
            };
            if servo.inertia <= 0.0 {
                self.servos.push(ServoRow::without_limits(servo));
                self.not_searched.remove(0);
                continue;
            }
            // Gains at which the step of the servo alone is about unstable.
            let [stiff, thick] = [2, 1].map(|power| servo.inertia / search.dt.powi(power));
            let of_kp = |value: f64| -> Gains { (with(&kp, value), kv.clone()) };
            let of_kv = |value: f64| -> Gains { (kp.clone(), with(&kv, value)) };
            self.servos.push(ServoRow {
                name: servo.name.clone(),
                joint: servo.joint.clone(),
                kp: servo.kp,
                kv: servo.kv,
                largest_kp: search.limits(servo.kp, 1e-2 * stiff, &of_kp)?.most,
                largest_kv: search.limits(servo.kv, 1e-2 * thick, &of_kv)?.most,
            });
            self.not_searched.remove(0);
        }
        Ok(())
    }
}
