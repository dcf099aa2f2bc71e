//! `libration list --presets`.

use libration_settings::latency_presets::{DelayLaw, LatencyPreset, PREFIX, PRESETS};
use serde_json::{Value, json};

/// Returns the presets of latencies, as text or as JSON.
pub(super) fn listing(as_json: bool) -> String {
    match as_json {
        true => format!("{:#}\n", Value::Array(PRESETS.iter().map(value).collect())),
        false => text(),
    }
}

fn value(preset: &LatencyPreset) -> Value {
    let deviation = match preset.law {
        DelayLaw::Random(deviation) => Some(deviation),
        DelayLaw::Constant | DelayLaw::UpTo => None,
    };
    json!({
        "name": preset.name,
        "about": preset.about,
        "latency": preset.delay.seconds(),
        "how": preset.delay.text(),
        "law": preset.law.text(),
        "standard_deviation": deviation,
        "source": preset.source,
    })
}

fn text() -> String {
    let width = PRESETS.iter().map(|preset| preset.name.len()).max().unwrap_or_default();
    let row = |preset: &LatencyPreset| {
        format!(
            "  {:width$} {:>9} ms  {}\n  {:width$}               {}; {}\n  {:width$}               source: {}\n",
            preset.name,
            preset.milliseconds(),
            preset.about,
            "",
            preset.delay.text(),
            preset.law.text(),
            "",
            preset.source
        )
    };
    let rows: String = PRESETS.iter().map(row).collect();
    format!(
        "Presets of latencies, for --latency {PREFIX}NAME and latency = \"{PREFIX}NAME\" in files. Delays of filters are those at low frequency.\n{rows}"
    )
}
