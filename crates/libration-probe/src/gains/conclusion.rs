//! The verdict on gains by the measured step, the servo model, and what acts besides the servos.

use libration_report::verdict::{Outcome, Verdict};

use super::measured::MeasuredGains;
use super::{GainReport, JointRow, OtherForces};

impl GainReport {
    /// The same by the measured step of the simulator, whose verdict and limits take the place of those of the servo model.
    #[must_use]
    pub fn with_measured(mut self, measured: MeasuredGains) -> Self {
        self.spectral_radius = measured.spectral_radius;
        self.spectral_radius_minus_one = measured.spectral_radius - 1.0;
        self.growth_in_continuous_time = measured.growth_of_system;
        self.unstable_without_servos = measured.unstable_without_servos.is_some();
        self.largest_factor = measured.largest_factor;
        self.has_kp = measured.servos.iter().any(|servo| servo.kp != 0.0);
        self.least_factor = measured.least_factor;
        self.fewest_substeps = measured.fewest_substeps;
        // Limits of the servo model are not those of the simulator.
        for joint in &mut self.joints {
            (joint.largest_kp, joint.largest_kv) = (f64::NAN, f64::NAN);
        }
        for servo in &measured.servos {
            let own = |joint: &&mut JointRow| Some(&joint.name) == servo.joint.as_ref();
            if let Some(joint) = self.joints.iter_mut().find(own) {
                (joint.largest_kp, joint.largest_kv) = (servo.largest_kp, servo.largest_kv);
            }
        }
        self.measured = Some(measured);
        self.conclude();
        self
    }

    /// The same where forces are at a limit, or where servos do not act: the gains have no effect that a derivative has, so that nothing is
    /// known of them. A mode that grows without the servos that do not act grows all the same.
    #[must_use]
    pub fn with_inert_servos(mut self, saturated: Vec<String>, idle: Vec<String>) -> Self {
        (self.saturated, self.idle) = (saturated, idle);
        self.conclude();
        self
    }

    /// The same of a simulator in which more acts than the servos whose gains are changed.
    #[must_use]
    pub fn with_other_forces(mut self, others: OtherForces) -> Self {
        // A simulator in which an actuator has gains that are not changed is not without gains.
        let is_without = self.others.without_gains && others.actuators.is_empty();
        self.others = others;
        self.others.without_gains |= is_without;
        self.conclude();
        self
    }

    /// Whether a force is at a limit, or a servo does not act.
    pub(super) fn is_inert(&self) -> bool {
        !(self.saturated.is_empty() && self.idle.is_empty())
    }

    /// Why nothing is known of the gains, whatever the step does; none if all servos act and nothing else decides.
    fn unknown(&self, verdict: &Verdict) -> Option<Verdict> {
        let grows = verdict.outcome == Outcome::Unstable;
        let idle = self.idle.iter().filter(|_| !(grows && self.saturated.is_empty())).cloned();
        let mut reasons: Vec<String> = self.saturated.iter().cloned().chain(idle).collect();
        if verdict.is_good() || self.others.without_gains && !grows {
            reasons.extend(self.others.reasons());
        }
        let unknown = Verdict::unknown(reasons.join("; "));
        (!reasons.is_empty())
            .then(|| Verdict { not_examined: verdict.not_examined.clone(), ..unknown })
    }

    /// Removes all limits of gains, which would be read as gains that hold.
    fn withhold(&mut self) {
        (self.largest_factor, self.least_factor, self.fewest_substeps) = (f64::NAN, 0.0, None);
        for joint in &mut self.joints {
            (joint.largest_kp, joint.largest_kv) = (f64::NAN, f64::NAN);
            joint.largest_turn = f64::NAN;
        }
        for row in &mut self.integrators {
            (row.holds, row.is_known) = (false, false);
            (row.largest_factor, row.least_factor, row.fewest_substeps) = (f64::NAN, 0.0, None);
        }
        if let Some(measured) = &mut self.measured {
            (measured.largest_factor, measured.least_factor) = (f64::NAN, 0.0);
            measured.fewest_substeps = None;
            measured.not_searched.splice(0..0, measured.servos.drain(..).map(|servo| servo.name));
        }
    }

    /// The verdict of the step alone.
    fn verdict_of_step(&self) -> Verdict {
        let Some(measured) = &self.measured else { return self.verdict_of_model() };
        let mut verdict = measured.verdict();
        if !self.others.friction.is_empty() && verdict.outcome != Outcome::Unknown {
            verdict.evidence += ", without friction loss";
        }
        verdict.not_examined.extend(self.others.not_examined());
        verdict
    }

    /// Sets the verdict and the answer.
    pub(super) fn conclude(&mut self) {
        self.verdict = self.verdict_of_step();
        self.is_withheld = self.unknown(&self.verdict).is_some();
        if self.is_withheld {
            self.withhold();
            let of_step = self.verdict_of_step();
            self.verdict = self.unknown(&of_step).unwrap_or(of_step);
        }
        self.holds = self.verdict.is_good();
        self.answer = match &self.measured {
            Some(measured) => measured.summary(self),
            None => self.summary(),
        };
    }
}
