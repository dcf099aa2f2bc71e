//! Lags and filters of a loop.

use libration::linear::{ChannelPart, ControllerSchedule, DiscreteFilter, LinearPlant, Signal};

use crate::Fault;

/// A lag or a filter of a loop.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its name.
    pub name: String,
    /// The number of the input; none behind an output.
    pub input: Option<usize>,
    /// The number of the output; none before an input.
    pub output: Option<usize>,
    /// The lag or filter.
    pub kind: PartKind,
}

/// A lag or a filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartKind {
    /// In continuous time: its states belong to the plant.
    Continuous(ChannelPart),
    /// A filter of samples: its memory belongs to the controller.
    Discrete(DiscreteFilter),
}

impl Part {
    /// The plant with this part, if it is one in continuous time.
    ///
    /// # Errors
    /// [`Fault`]: an invalid number, or too many states.
    pub fn applied(&self, plant: &LinearPlant) -> Result<LinearPlant, Fault> {
        let plant = match (self.kind, self.input, self.output) {
            (PartKind::Continuous(part), Some(i), _) => plant.with_input_part(i, part, &self.name),
            (PartKind::Continuous(part), None, Some(j)) => {
                plant.with_output_part(j, part, &self.name)
            }
            _ => return Ok(plant.clone()),
        };
        plant.map_err(|error| Fault::new("part", error.to_string()))
    }

    /// Its filter of samples.
    fn filter(&self) -> Option<DiscreteFilter> {
        match self.kind {
            PartKind::Discrete(filter) => Some(filter),
            PartKind::Continuous(_) => None,
        }
    }

    /// Whether it is a filter of samples.
    pub fn is_discrete(&self) -> bool {
        self.filter().is_some()
    }

    /// Whether the length of a period is in its coefficients, as in those of a difference per second.
    pub fn counts_seconds(&self) -> bool {
        self.filter() == Some(DiscreteFilter::Difference)
    }

    /// The delay at low frequencies in s, in a loop with this period in s.
    pub fn delay(&self, period: f64) -> f64 {
        match self.kind {
            PartKind::Continuous(part) => part.delay(),
            PartKind::Discrete(filter) => filter.delay(period),
        }
    }

    /// The phase in rad at `omega` rad/s.
    pub fn phase(&self, omega: f64, period: f64) -> f64 {
        match self.kind {
            PartKind::Continuous(part) => part.phase(omega),
            PartKind::Discrete(filter) => filter.phase(omega, period),
        }
    }

    /// The controllers with the filters of samples among `parts`, each in its channel of `plant`: behind the outputs in their order,
    /// then the controller, then before the inputs.
    pub fn filtered(
        parts: &[Part],
        controllers: &ControllerSchedule,
        plant: &LinearPlant,
        period: f64,
    ) -> ControllerSchedule {
        let of = |channel: fn(&Part) -> Option<usize>| -> Vec<(usize, DiscreteFilter)> {
            parts.iter().filter_map(|part| Some((channel(part)?, part.filter()?))).collect()
        };
        let (inputs, outputs) = (of(|part| part.input), of(|part| part.output));
        let mut controllers = controllers.clone();
        if !outputs.is_empty() {
            let bank = DiscreteFilter::bank(plant.outputs.len(), &outputs, period);
            controllers = controllers.after(&bank);
        }
        if !inputs.is_empty() {
            let bank = DiscreteFilter::bank(plant.inputs.len(), &inputs, period);
            controllers = controllers.before(&bank);
        }
        controllers
    }

    /// The outputs as the controller reads them: behind a difference per second.
    pub fn read(parts: &[Part], outputs: &[Signal]) -> Vec<Signal> {
        let mut signals = outputs.to_vec();
        for j in parts.iter().filter(|part| part.counts_seconds()).filter_map(|part| part.output) {
            signals[j].unit = per_second(&signals[j].unit);
        }
        signals
    }
}

/// A unit per second: `rad` becomes `rad/s`, that `rad/s²`, and that `rad/s³`.
fn per_second(unit: &str) -> String {
    match unit {
        "" => String::new(),
        _ if unit.ends_with("/s") => format!("{unit}²"),
        _ => match unit.strip_suffix("/s²") {
            Some(rest) => format!("{rest}/s³"),
            None => format!("{unit}/s"),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_of_an_output_are_per_second_each_time() {
        let difference = |output| Part {
            name: "rate".into(),
            input: None,
            output: Some(output),
            kind: PartKind::Discrete(DiscreteFilter::Difference),
        };
        let outputs = [Signal::new("angle", "rad"), Signal::new("pure", ""), Signal::new("x", "m")];
        let parts = [0, 0, 0, 1].map(difference);
        let read = Part::read(&parts, &outputs);
        let units: Vec<&str> = read.iter().map(|signal| signal.unit.as_str()).collect();
        assert_eq!(units, ["rad/s³", "", "m"]);
        assert_eq!(Part::read(&parts[..1], &outputs)[0].unit, "rad/s");
    }
}
