//! Tables of lags and filters in the channels of a plant.

use libration::linear::{ChannelPart, LinearPlant, Signal};
use serde::Deserialize;

use crate::{Fault, Number, suggestions};

/// A table `[[part]]`: a lag or a filter before an input or behind an output.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct PartTable {
    /// Its name.
    pub name: Option<String>,
    /// The input before which it stands.
    pub input: Option<String>,
    /// The output behind which it stands.
    pub output: Option<String>,
    /// The time constant of a first-order lag, in s.
    pub lag: Option<Number>,
    /// The cutoff frequency of a second-order Butterworth filter, in Hz.
    pub butterworth2: Option<Number>,
}

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
    pub part: ChannelPart,
}

impl PartTable {
    /// The part in the channels of `plant`.
    ///
    /// # Errors
    /// [`Fault`]: an unknown channel, or not exactly one kind.
    pub fn part(&self, plant: &LinearPlant) -> Result<Part, Fault> {
        let wrong = |message: String| Fault::new("part", message);
        let (part, kind) = match (self.lag, self.butterworth2) {
            (Some(Number(time)), None) => (ChannelPart::Lag(time), "lag"),
            (None, Some(Number(frequency))) => {
                (ChannelPart::Butterworth2(frequency), "butterworth2")
            }
            _ => {
                return Err(wrong(
                    "a part requires exactly one of `lag` and `butterworth2`".into(),
                ));
            }
        };
        let (of, name, signals) = match (&self.input, &self.output) {
            (Some(name), None) => ("inputs", name, &plant.inputs),
            (None, Some(name)) => ("outputs", name, &plant.outputs),
            _ => return Err(wrong("a part requires exactly one of `input` and `output`".into())),
        };
        let channel = find(of, name, signals).map_err(|fault| Fault { key: "part", ..fault })?;
        let (input, output) = match of {
            "inputs" => (Some(channel), None),
            _ => (None, Some(channel)),
        };
        let name = self.name.clone().unwrap_or_else(|| format!("{kind} of {name}"));
        Ok(Part { name, input, output, part })
    }
}

/// The number of the signal of this name.
pub(super) fn find(of: &str, name: &str, signals: &[Signal]) -> Result<usize, Fault> {
    signals.iter().position(|signal| signal.name == name).ok_or_else(|| {
        let names = signals.iter().map(|signal| signal.name.as_str());
        let one = of.strip_suffix('s').unwrap_or(of);
        let fault = Fault::new("system", format!("unknown {one} `{name}`"));
        fault.help(suggestions::suggest(of, name, names))
    })
}

impl Part {
    /// The plant with this part.
    ///
    /// # Errors
    /// [`Fault`]: an invalid number, or too many states.
    pub fn applied(&self, plant: &LinearPlant) -> Result<LinearPlant, Fault> {
        let plant = match (self.input, self.output) {
            (Some(i), _) => plant.with_input_part(i, self.part, &self.name),
            (None, Some(j)) => plant.with_output_part(j, self.part, &self.name),
            (None, None) => return Ok(plant.clone()),
        };
        plant.map_err(|error| Fault::new("part", error.to_string()))
    }
}
