//! Forces of a simulator besides those of the servos whose gains are changed.

use serde::Deserialize;

/// Most names in a sentence.
const MOST_NAMES: usize = 4;

/// What acts in the step of a simulator besides the servos whose gains are changed.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OtherForces {
    /// Joints and tendons whose friction loss is not in the step, in words.
    pub friction: Vec<String>,
    /// Actuators whose forces depend on the motion, and whose gains are not changed.
    pub actuators: Vec<String>,
    /// Actuators whose effect on the motion changes with their commands.
    pub commanded: Vec<String>,
    /// Whether no actuator has gains.
    pub without_gains: bool,
    /// Further reasons for which a step that does not grow leaves it unknown whether the gains hold, in words.
    pub undecided: Vec<String>,
    /// What the derivative of the step at the point does not have, in words.
    pub not_examined: Vec<String>,
}

impl OtherForces {
    /// Why a step that does not grow leaves it unknown whether the gains hold.
    pub(super) fn reasons(&self) -> Vec<String> {
        let none = self
            .without_gains
            .then(|| "there are no gains: no actuator is a servo with gains".to_owned());
        let commanded = (!self.commanded.is_empty()).then(|| {
            format!(
                "the effect of {} on the motion changes with the command, and only that of the point was examined",
                in_words(&self.commanded)
            )
        });
        none.into_iter().chain(commanded).chain(self.undecided.iter().cloned()).collect()
    }

    /// What to do where nothing is known of the gains.
    pub(super) fn actions(&self) -> Vec<String> {
        if self.without_gains {
            return vec![
                "Examine a model with servos: actuators whose forces fall with positions or velocities.".into(),
            ];
        }
        if !self.commanded.is_empty() {
            return vec![format!(
                "Examine the servos in a model without {}.",
                in_words(&self.commanded)
            )];
        }
        vec!["Lower the gains: they must hold with and without what acts at the point.".into()]
    }

    /// The actuators that remain in a step without gains of servos; none if there are none.
    pub(super) fn remaining(&self) -> Option<String> {
        (!self.actuators.is_empty()).then(|| in_words(&self.actuators))
    }

    /// What was not examined of the measured step.
    pub(super) fn not_examined(&self) -> Vec<String> {
        let friction = self.friction.iter().take(MOST_NAMES).cloned().collect::<Vec<_>>();
        let friction = (!friction.is_empty())
            .then(|| format!("friction loss of {}{}", friction.join(", "), more(&self.friction)));
        let gains = self.actuators.iter().map(|name| format!("other gains of `{name}`"));
        friction.into_iter().chain(gains).chain(self.not_examined.iter().cloned()).collect()
    }

    /// Of which model an unstable or stable step is, in sentences.
    pub(super) fn sentences(&self, is_unknown: bool) -> Vec<String> {
        let mut found = Vec::new();
        if !self.friction.is_empty() {
            found.push(
                "This is without friction loss: it holds small deviations only, and is a constant force on what moves.".to_owned(),
            );
        }
        if !self.commanded.is_empty() && !is_unknown {
            found.push(format!(
                "The effect of {} on the motion changes with the command; this is that of the point.",
                in_words(&self.commanded)
            ));
        }
        found
    }
}

/// Names in a sentence.
fn in_words(names: &[String]) -> String {
    let shown: Vec<String> =
        names.iter().take(MOST_NAMES).map(|name| format!("`{name}`")).collect();
    shown.join(", ") + &more(names)
}

fn more(names: &[String]) -> String {
    match names.len().saturating_sub(MOST_NAMES) {
        0 => String::new(),
        more => format!(" and {more} more"),
    }
}
