//! The report on gains.

use libration::linear::eigenvalues;
use libration_report::notation::number;
use serde::{Serialize, Serializer};

use super::servo_mode::{ServoMode, modes};
use super::stable_factors::{StableFactors, growth, is_stable};
use super::{ServoIntegrator, Servos};

/// Most substeps that are tried.
const MOST_SUBSTEPS: u32 = 1000;
/// Part of the fastest rate below which growth is rounding.
const ROUNDING: f64 = 1e-7;
/// What no linear analysis has.
const LIMITATION: &str = "The analysis is linear: contact, friction and limits of forces are not in it. A gain that holds in free motion may be unstable in contact.";

/// The results; the fields are the keys of `gains --json`. Infinite limits are `null` there.
#[derive(Clone, Debug, Serialize)]
pub struct GainReport {
    /// The answer in a few sentences.
    pub answer: String,
    /// Whether the gains hold.
    pub holds: bool,
    /// The growth rate in 1/s of a motion that grows in continuous time, whatever the step; none if no motion does.
    pub growth_in_continuous_time: Option<f64>,
    /// The length of a step of the simulator, in s.
    pub dt: f64,
    /// Steps of the integrator in it.
    pub substeps: u32,
    /// The integrator.
    pub integrator: &'static str,
    /// The same in running text.
    pub integrator_title: String,
    /// The largest factor of a mode per substep.
    pub spectral_radius: f64,
    /// The largest factor of all gains of position, with the same gains of velocity.
    #[serde(serialize_with = "limit")]
    pub largest_factor: f64,
    /// The least factor, if the given gains are too small; else 0.
    pub least_factor: f64,
    /// The fewest substeps with which the gains hold; none up to 1000.
    pub fewest_substeps: Option<u32>,
    /// The joints.
    pub joints: Vec<JointRow>,
    /// The modes of all joints together, the fastest first.
    pub modes: Vec<ServoMode>,
    /// All integrators.
    pub integrators: Vec<IntegratorRow>,
    /// Facts that limit the validity.
    pub notes: Vec<String>,
    /// The command that repeats the report.
    pub repeat_command: String,
}

/// A joint.
#[derive(Clone, Debug, Serialize)]
pub struct JointRow {
    /// Its name.
    pub name: String,
    /// Its inertia with all other joints at rest.
    pub inertia: f64,
    /// Its gain of position.
    pub kp: f64,
    /// Its gain of velocity.
    pub kv: f64,
    /// `ωh` of the joint alone.
    pub turn: f64,
    /// The damping ratio of the joint alone.
    pub damping_ratio: Option<f64>,
    /// The largest `ωh` of the joint alone with the same damping; not a number if ω is 0.
    #[serde(serialize_with = "limit")]
    pub largest_turn: f64,
    /// Its largest gain of position, with all others as they are and with all couplings.
    #[serde(serialize_with = "limit")]
    pub largest_kp: f64,
}

/// What an integrator does with the gains.
#[derive(Clone, Debug, Serialize)]
pub struct IntegratorRow {
    /// Its name.
    pub name: &'static str,
    /// The same in running text.
    pub title: String,
    /// Whether the gains hold.
    pub holds: bool,
    /// The largest factor of all gains of position.
    #[serde(serialize_with = "limit")]
    pub largest_factor: f64,
    /// The least factor, if the given gains are too small; else 0.
    pub least_factor: f64,
    /// The fewest substeps.
    pub fewest_substeps: Option<u32>,
    /// The largest factor of a mode per substep.
    pub spectral_radius: f64,
}

fn limit<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    match value.is_finite() {
        true => serializer.serialize_some(value),
        false => serializer.serialize_none(),
    }
}

/// Whether the gains of servos hold at steps of `dt` seconds in `substeps` parts.
pub fn gains(
    servos: &Servos,
    dt: f64,
    substeps: u32,
    integrator: ServoIntegrator,
    notes: Vec<String>,
) -> GainReport {
    let h = dt / f64::from(substeps);
    let row = |integrator: ServoIntegrator| {
        let holds = is_stable(servos.step(integrator, h));
        let factor = StableFactors::search(|factor| servos.with_factor(factor).step(integrator, h));
        IntegratorRow {
            name: integrator.name(),
            title: integrator.title(),
            holds,
            largest_factor: factor.most,
            least_factor: factor.least,
            fewest_substeps: fewest_substeps(servos, dt, integrator),
            spectral_radius: growth(servos.step(integrator, h)).exp(),
        }
    };
    let integrators: Vec<IntegratorRow> = ServoIntegrator::all().map(row).collect();
    let known = integrators.iter().find(|row| row.name == integrator.name());
    let own = known.cloned().unwrap_or_else(|| row(integrator));
    let mut report = GainReport {
        answer: String::new(),
        holds: own.holds,
        growth_in_continuous_time: continuous_growth(servos),
        dt,
        substeps,
        integrator: own.name,
        integrator_title: own.title,
        spectral_radius: own.spectral_radius,
        largest_factor: own.largest_factor,
        least_factor: own.least_factor,
        fewest_substeps: own.fewest_substeps,
        joints: (0..servos.joints.len()).map(|i| joint_row(servos, i, integrator, h)).collect(),
        modes: modes(servos, integrator, h),
        integrators,
        notes,
        repeat_command: String::new(),
    };
    report.answer = report.summary();
    report
}

/// The growth rate of a motion that grows beyond rounding, which parts a repeated eigenvalue by its root.
fn continuous_growth(servos: &Servos) -> Option<f64> {
    let values = eigenvalues(&servos.plant().ok()?.a)?;
    let size = values.iter().map(|s| s.norm()).fold(0.0, f64::max);
    let growth = values.iter().map(|s| s.re).fold(f64::NEG_INFINITY, f64::max);
    (growth > ROUNDING * size).then_some(growth)
}

fn fewest_substeps(servos: &Servos, dt: f64, integrator: ServoIntegrator) -> Option<u32> {
    let holds = |substeps: u32| is_stable(servos.step(integrator, dt / f64::from(substeps)));
    // Doubling finds a number that holds, bisection the fewest.
    let mut high = 1;
    while !holds(high) {
        if high == MOST_SUBSTEPS {
            return None;
        }
        high = (2 * high).min(MOST_SUBSTEPS);
    }
    let mut low = high / 2;
    while high - low > 1 {
        let middle = u32::midpoint(low, high);
        if holds(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

fn joint_row(servos: &Servos, i: usize, integrator: ServoIntegrator, h: f64) -> JointRow {
    let alone = servos.alone(i);
    let (inertia, kp, kv) = (alone.mass[(0, 0)], alone.kp[(0, 0)], alone.kv[(0, 0)]);
    let stiffness = kp + alone.stiffness[(0, 0)];
    let omega = (stiffness / inertia).max(0.0).sqrt();
    let damping = kv + alone.damping[(0, 0)];
    let damping_ratio = (omega > 0.0).then(|| damping / inertia / (2.0 * omega));
    // Longer steps change ωh at the same damping ratio.
    let longest = StableFactors::search(|factor| alone.step(integrator, h * factor));
    let factor =
        StableFactors::search(|factor| servos.with_joint_factor(i, factor).step(integrator, h));
    let largest_kp = if kp == 0.0 { f64::INFINITY } else { 0.0 + kp * factor.most };
    JointRow {
        name: servos.joints[i].name.clone(),
        inertia,
        kp,
        kv,
        turn: omega * h,
        damping_ratio,
        largest_turn: if omega == 0.0 { f64::NAN } else { omega * h * longest.most },
        largest_kp,
    }
}

impl GainReport {
    fn summary(&self) -> String {
        let h = self.dt / f64::from(self.substeps);
        let integrator = ServoIntegrator::label(self.integrator);
        let of = if self.substeps == 1 {
            format!("steps of {} s", number(h, 6))
        } else {
            format!("{} substeps of {} s", self.substeps, number(h, 4))
        };
        if let Some(growth) = self.growth_in_continuous_time {
            let window = match (self.least_factor, self.largest_factor) {
                (0.0, _) => String::new(),
                (least, f64::INFINITY) => format!(
                    " With {} and this step gains of position hold from {} times the given ones on.",
                    integrator,
                    number(least, 5)
                ),
                (least, most) => format!(
                    " With {} and this step gains of position hold from {} to {} times the given ones.",
                    integrator,
                    number(least, 5),
                    number(most, 5)
                ),
            };
            return format!(
                "The motion is unstable in continuous time, whatever the step: it grows by {} 1/s with these gains and stiffnesses.{window} {LIMITATION}",
                number(growth, 5)
            );
        }
        let mut text = if self.holds {
            format!("The gains hold with {integrator} and {of}")
        } else {
            format!(
                "The gains do not hold with {} and {of}: a mode grows by a factor {} per step",
                integrator,
                number(self.spectral_radius, 5)
            )
        };
        text += &match self.largest_factor {
            f64::INFINITY => "; no gain of position was found that does not.".to_owned(),
            0.0 => "; no gain of position does.".to_owned(),
            factor => {
                let factor = number(factor, 5);
                format!("; the largest gains of position are {factor} times the given ones.")
            }
        };
        let worst = self
            .joints
            .iter()
            .filter(|joint| joint.kp > 0.0)
            .min_by(|a, b| (a.largest_kp / a.kp).total_cmp(&(b.largest_kp / b.kp)));
        if let Some(joint) = worst.filter(|joint| joint.largest_kp.is_finite()) {
            let most = match joint.largest_kp {
                0.0 => "no gain of it holds".to_owned(),
                most => format!("its gain is at most {}", number(most, 5)),
            };
            text += &format!(
                " The joint with the least margin is {}: {most}, with all others as they are.",
                joint.name
            );
        }
        if !self.holds {
            match self.fewest_substeps {
                Some(substeps) => text += &format!(" {substeps} substeps hold them."),
                None => {
                    text += &format!(" No number of substeps up to {MOST_SUBSTEPS} holds them.")
                }
            }
            let others: Vec<String> = self
                .integrators
                .iter()
                .filter(|row| row.holds)
                .map(|row| ServoIntegrator::label(row.name))
                .collect();
            if !others.is_empty() {
                text += &format!(" They hold with {}.", others.join(", "));
            }
        }
        format!("{text} {LIMITATION}")
    }
}
