//! Latencies of parts that loops are made of, by name, with their sources.

mod delay;
mod presets;
mod value;

pub use delay::Delay;
pub use presets::PRESETS;
pub use value::{LatencyValue, LatencyValues};

use crate::suggestions::suggest;

/// What a value begins with that is the name of a preset.
pub const PREFIX: &str = "preset:";

/// A latency with its source.
#[derive(Clone, Copy, Debug)]
pub struct LatencyPreset {
    /// Its name.
    pub name: &'static str,
    /// The part that is late.
    pub about: &'static str,
    /// Its delay.
    pub delay: Delay,
    /// How the delay varies.
    pub law: DelayLaw,
    /// Where the number is stated.
    pub source: &'static str,
}

/// How a delay varies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DelayLaw {
    /// It is the same each time.
    Constant,
    /// It is any time up to that of the preset.
    UpTo,
    /// It is random, with this standard deviation in s.
    Random(f64),
}

impl DelayLaw {
    /// The law in words.
    pub fn text(self) -> String {
        match self {
            DelayLaw::Constant => "constant".to_owned(),
            DelayLaw::UpTo => "up to this".to_owned(),
            DelayLaw::Random(deviation) => {
                format!("random, standard deviation {} ms", 1e3 * deviation)
            }
        }
    }
}

impl LatencyPreset {
    /// The preset of a name, without the prefix.
    ///
    /// # Errors
    /// The message of an unknown name, with the nearest one.
    pub fn find(name: &str) -> Result<&'static LatencyPreset, String> {
        PRESETS.iter().find(|preset| preset.name == name).ok_or_else(|| {
            let help = suggest("presets", name, PRESETS.iter().map(|preset| preset.name));
            format!("unknown preset `{name}`; {help}")
        })
    }

    /// The latency in s of a value such as `preset:usb-frame`, or the sum of several, `preset:usb-frame+preset:px4-gyro`; none if the value
    /// does not begin with a preset.
    ///
    /// # Errors
    /// As [`LatencyPreset::find`].
    pub fn parse(value: &str) -> Result<Option<f64>, String> {
        if !value.trim().starts_with(PREFIX) {
            return Ok(None);
        }
        let seconds = |part: &str| match part.trim().strip_prefix(PREFIX) {
            Some(name) => LatencyPreset::find(name).map(|preset| preset.delay.seconds()),
            None => Err(format!("`{part}` is no preset; expected {PREFIX}NAME+{PREFIX}NAME")),
        };
        value.split('+').map(seconds).sum::<Result<f64, String>>().map(Some)
    }

    /// The latency in ms, with four digits.
    pub fn milliseconds(&self) -> String {
        let milliseconds = 1e3 * self.delay.seconds();
        let decimals = (3.0 - milliseconds.log10().floor()).clamp(0.0, 9.0) as usize;
        let text = format!("{milliseconds:.decimals$}");
        match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            false => text,
        }
    }
}

/// All presets as a table in Markdown, as in `docs/advise.md`.
pub fn markdown() -> String {
    let row = |preset: &LatencyPreset| {
        format!(
            "| `{}` | {} | {} | {} | {} | {} |\n",
            preset.name,
            preset.about,
            preset.milliseconds(),
            preset.delay.text(),
            preset.law.text(),
            preset.source
        )
    };
    let rows: String = PRESETS.iter().map(row).collect();
    format!(
        "| preset | part | latency (ms) | how | law | source |\n| --- | --- | --- | --- | --- | --- |\n{rows}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_preset_has_a_name_of_its_own_a_source_and_a_positive_latency() {
        for (i, preset) in PRESETS.iter().enumerate() {
            assert!(
                preset.delay.seconds() > 0.0 && preset.delay.seconds() < 1.0,
                "{}",
                preset.name
            );
            assert!(preset.source.len() > 10 && preset.about.len() > 5, "{}", preset.name);
            let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            assert!(preset.name.chars().all(plain), "{}", preset.name);
            assert!(PRESETS[..i].iter().all(|other| other.name != preset.name), "{}", preset.name);
            if let DelayLaw::Random(deviation) = preset.law {
                assert!(deviation > 0.0);
            }
        }
    }

    #[test]
    fn an_unknown_preset_is_refused_with_the_nearest_name() {
        assert_eq!(LatencyPreset::parse("preset:usb-frame"), Ok(Some(0.001)));
        assert_eq!(LatencyPreset::parse("0.001"), Ok(None));
        assert_eq!(LatencyPreset::parse("preset:usb-frame+preset:franka-fci"), Ok(Some(0.002)));
        let error = LatencyPreset::parse("preset:usb-frame+0.001").unwrap_err();
        assert!(error.contains("`0.001` is no preset"), "{error}");
        let error = LatencyPreset::parse("preset:px4-gyr").unwrap_err();
        assert!(error.contains("did you mean `px4-gyro`?"), "{error}");
    }
}
