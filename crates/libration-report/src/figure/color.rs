//! Colours of values.

use serde::Serialize;

use super::axis::Scale;

/// The mapping of values to colours, with the colour bar.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Colors {
    /// The colours.
    pub map: ColorMap,
    /// Linear: equal differences are equal steps of colour. Logarithmic: equal ratios.
    pub scale: Scale,
    /// The values at the two ends; none for those of the data.
    pub range: Option<[f64; 2]>,
    /// The quantity.
    pub label: String,
    /// The unit, if it has one.
    pub unit: Option<String>,
}

/// A series of colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum ColorMap {
    /// From small to large, even in lightness, safe for the colour-blind.
    #[default]
    Viridis,
    /// For both signs, white in the middle.
    Diverging,
}

impl Colors {
    /// Viridis over the range of the data, on a linear scale.
    pub fn new(label: impl Into<String>) -> Self {
        let (map, scale) = (ColorMap::default(), Scale::Linear);
        Self { map, scale, range: None, label: label.into(), unit: None }
    }

    /// Makes equal ratios of value equal steps of colour.
    #[must_use]
    pub fn log(mut self) -> Self {
        self.scale = Scale::Log;
        self
    }

    /// Sets the colours.
    #[must_use]
    pub fn map(mut self, map: ColorMap) -> Self {
        self.map = map;
        self
    }

    /// Sets the values at the two ends.
    #[must_use]
    pub fn range(mut self, low: f64, high: f64) -> Self {
        self.range = Some([low, high]);
        self
    }

    /// Sets the unit.
    #[must_use]
    pub fn unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = Some(unit.into());
        self
    }

    /// The label with its unit.
    pub(super) fn title(&self) -> String {
        match &self.unit {
            Some(unit) => format!("{} ({unit})", self.label),
            None => self.label.clone(),
        }
    }

    /// The ends of the scale for these values.
    pub(super) fn ends(&self, values: &[f64]) -> [f64; 2] {
        if let Some(range) = self.range {
            return range;
        }
        let shown = || values.iter().copied().filter(|&v| self.scale.of(v).is_finite());
        let (low, high) = (shown().fold(f64::NAN, f64::min), shown().fold(f64::NAN, f64::max));
        if !(low.is_finite() && high.is_finite()) {
            return if self.scale == Scale::Log { [0.1, 1.0] } else { [0.0, 1.0] };
        }
        match (low < high, self.map, self.scale) {
            (_, ColorMap::Diverging, Scale::Linear) if low < 0.0 && high > 0.0 => {
                let reach = high.max(-low);
                [-reach, reach]
            }
            (true, ..) => [low, high],
            (false, _, Scale::Log) => [low / 2.0, low * 2.0],
            (false, ..) => [low - 0.5, low + 0.5],
        }
    }
}

impl ColorMap {
    /// Evenly spaced colours; between them one interpolates.
    pub(super) fn stops(self) -> [[u8; 3]; 11] {
        let hex: [u32; 11] = match self {
            Self::Viridis => [
                0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c, 0x22a884, 0x44bf70,
                0x7ad151, 0xbddf26, 0xfde725,
            ],
            Self::Diverging => [
                0x053061, 0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7, 0xfddbc7, 0xf4a582,
                0xd6604d, 0xb2182b, 0x67001f,
            ],
        };
        hex.map(|h| [(h >> 16) as u8, (h >> 8) as u8, h as u8])
    }

    /// The colour at a place between 0 and 1.
    pub(super) fn at(self, place: f64) -> [u8; 3] {
        let stops = self.stops();
        let place = place.clamp(0.0, 1.0) * 10.0;
        let index = (place as usize).min(9);
        let share = place - index as f64;
        let mix = |c: usize| {
            let (from, to) = (f64::from(stops[index][c]), f64::from(stops[index + 1][c]));
            (from + (to - from) * share).round() as u8
        };
        [mix(0), mix(1), mix(2)]
    }
}
