//! Tables of lags and filters in the channels of a plant.

use libration::linear::{ChannelPart, DiscreteFilter, LinearPlant, Signal};
use serde::Deserialize;

use super::part::{Part, PartKind};
use crate::{Count, Fault, Number, suggestions};

/// A table `[[part]]`: a lag or a filter before an input or behind an output.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct PartTable {
    /// Its name.
    pub name: Option<String>,
    /// The input before which it stands.
    pub input: Option<String>,
    /// The output behind which it stands.
    pub output: Option<String>,
    /// The time constant of a first-order lag, in s.
    #[serde(deserialize_with = "crate::duration::optional")]
    pub lag: Option<Number>,
    /// The cutoff frequency of a second-order Butterworth filter, in Hz.
    pub butterworth2: Option<Number>,
    /// The number of samples of a moving average, which runs with the controller.
    pub moving_average: Option<Count>,
    /// Whether it is the difference of two samples over the period, which runs with the controller.
    pub difference: bool,
}

impl PartTable {
    /// The part in the channels of `plant`.
    ///
    /// # Errors
    /// [`Fault`]: an unknown channel, or not exactly one kind.
    pub fn part(&self, plant: &LinearPlant) -> Result<Part, Fault> {
        let wrong = |message: String| Fault::new("part", message);
        let kinds = [
            self.lag.map(|Number(time)| (PartKind::Continuous(ChannelPart::Lag(time)), "lag")),
            self.butterworth2.map(|Number(frequency)| {
                (PartKind::Continuous(ChannelPart::Butterworth2(frequency)), "butterworth2")
            }),
            self.moving_average.map(|Count(samples)| {
                // What does not fit is refused as too many.
                let samples = usize::try_from(samples.max(0)).unwrap_or(usize::MAX);
                let average = DiscreteFilter::MovingAverage(samples);
                (PartKind::Discrete(average), "moving average")
            }),
            self.difference
                .then_some((PartKind::Discrete(DiscreteFilter::Difference), "difference")),
        ];
        let mut given = kinds.into_iter().flatten();
        let (Some((kind, word)), None) = (given.next(), given.next()) else {
            let message = "a part requires exactly one of `lag`, `butterworth2`, `moving-average` and `difference = true`";
            return Err(wrong(message.into()));
        };
        let (of, name, signals) = match (&self.input, &self.output) {
            (Some(name), None) => ("inputs", name, &plant.inputs),
            (None, Some(name)) => ("outputs", name, &plant.outputs),
            _ => return Err(wrong("a part requires exactly one of `input` and `output`".into())),
        };
        let channel =
            find(of, name, signals).map_err(|fault| Fault { key: "part".into(), ..fault })?;
        let (input, output) = match of {
            "inputs" => (Some(channel), None),
            _ => (None, Some(channel)),
        };
        if input.is_some() && kind == PartKind::Discrete(DiscreteFilter::Difference) {
            return Err(wrong(format!(
                "`difference` stands before the input `{name}`; expected an output"
            )));
        }
        let name = self.name.clone().unwrap_or_else(|| format!("{word} of {name}"));
        if let PartKind::Discrete(filter) = kind {
            filter.check(&name).map_err(|error| wrong(error.to_string()))?;
        }
        Ok(Part { name, input, output, kind })
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
