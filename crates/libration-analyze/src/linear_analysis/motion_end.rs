//! How the motion of a nonlinear system under a loop ends.

use libration_report::verdict::{Outcome, Verdict};
use serde::Serialize;

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
    /// The farthest that a state is from the operating point on the way, where that is several times its start.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excursion: Option<Excursion>,
}

/// A state far from the operating point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Excursion {
    /// The state.
    pub state: String,
    /// The size of its deviation.
    pub deviation: f64,
    /// Its size at the start.
    pub start: f64,
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

impl Excursion {
    /// The excursion in words.
    pub fn in_words(&self) -> String {
        let Excursion { state, deviation, start } = self;
        let times = deviation / start;
        format!(
            "{state} has been {deviation:.4} from the operating point, {times:.1} times its start"
        )
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
            MotionEnd::Returns => {
                let far = self.excursion.as_ref().map(|own| format!(", after {}", own.in_words()));
                format!("the motion {from} returns within {duration} s{}", far.unwrap_or_default())
            }
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
