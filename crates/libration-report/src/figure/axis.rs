//! Axes: labels, scales and ranges.

use serde::Serialize;

/// The scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Equal differences are equal lengths.
    #[default]
    Linear,
    /// Equal ratios are equal lengths; zero and negative values have no place.
    Log,
}

impl Scale {
    /// The value on the scale; not finite if it has no place.
    pub(super) fn of(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Log if value > 0.0 => value.log10(),
            Self::Log => f64::NAN,
        }
    }

    /// The value at a place on the scale.
    pub(super) fn value(self, place: f64) -> f64 {
        match self {
            Self::Linear => place,
            Self::Log => 10_f64.powf(place),
        }
    }
}

/// One axis of a panel.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Axis {
    /// The quantity, with its symbol.
    pub label: String,
    /// The unit; none for dimensionless quantities.
    pub unit: Option<String>,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// The smallest and largest shown value; none for those of the data with a margin.
    pub range: Option<[f64; 2]>,
    /// Names in place of numbers: the first at 0, the next at −1, and so on.
    pub names: Vec<String>,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// A logarithmic axis.
    pub fn log(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Log, ..Self::default() }
    }

    /// A vertical axis of names, from top to bottom.
    pub fn names(label: impl Into<String>, names: impl IntoIterator<Item = String>) -> Self {
        let names: Vec<String> = names.into_iter().collect();
        let range = Some([0.4 - names.len() as f64, 0.6]);
        Self { label: label.into(), names, range, ..Self::default() }
    }

    /// Sets the unit.
    #[must_use]
    pub fn unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = Some(unit.into());
        self
    }

    /// Sets the smallest and largest shown value.
    #[must_use]
    pub fn range(mut self, low: f64, high: f64) -> Self {
        self.range = Some([low, high]);
        self
    }

    /// The label with its unit.
    pub fn title(&self) -> String {
        match &self.unit {
            Some(unit) => format!("{} ({unit})", self.label),
            None => self.label.clone(),
        }
    }

    /// The shown range on the scale (logarithms on a logarithmic axis) for the data, with a share of
    /// their extent as margin at each end.
    pub(super) fn span(&self, data: impl Iterator<Item = f64>, air: f64) -> Span {
        if let Some([low, high]) = self.range {
            let (low, high) = (self.scale.of(low), self.scale.of(high));
            if low.is_finite() && high.is_finite() && low < high {
                return Span { scale: self.scale, low, high };
            }
        }
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for place in data.map(|value| self.scale.of(value)).filter(|place| place.is_finite()) {
            (low, high) = (low.min(place), high.max(place));
        }
        if low > high {
            (low, high) = (0.0, 1.0);
        } else if high - low <= 1e-12 * high.abs().max(low.abs()) {
            let reach = match self.scale {
                Scale::Log => 0.5,
                Scale::Linear if high == 0.0 => 1.0,
                Scale::Linear => 0.1 * high.abs(),
            };
            (low, high) = (low - reach, high + reach);
        } else {
            // Halves, so that the difference of two huge values stays finite.
            let reach = 2.0 * air * (high / 2.0 - low / 2.0);
            (low, high) = (low - reach, high + reach);
        }
        let limit = f64::MAX / 4.0;
        Span { scale: self.scale, low: low.max(-limit), high: high.min(limit) }
    }
}

/// The shown range of an axis, on its scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    pub(super) scale: Scale,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Span {
    /// The position of a value along the axis: 0 at its low end, 1 at its high end.
    pub(super) fn share(&self, value: f64) -> f64 {
        (self.scale.of(value) - self.low) / (self.high - self.low)
    }

    /// Widens the range about its middle.
    pub(super) fn widen(&mut self, factor: f64) {
        let (middle, half) = ((self.low + self.high) / 2.0, (self.high - self.low) / 2.0);
        (self.low, self.high) = (middle - half * factor, middle + half * factor);
    }
}

/// A span on the page, from one pixel coordinate to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ruler {
    pub(super) span: Span,
    pub(super) from: f64,
    pub(super) to: f64,
}

impl Ruler {
    /// The pixel coordinate of a value; not finite if it has no place.
    pub(super) fn at(&self, value: f64) -> f64 {
        self.from + self.span.share(value) * (self.to - self.from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_logarithmic_axis_is_never_clamped() {
        let span = Axis::log("error").span([1e-300, 0.0, -1.0, 1e-16, 1.0].into_iter(), 0.0);
        assert!((span.low + 300.0).abs() < 1e-9 && span.high == 0.0, "{span:?}");
        let ruler = Ruler { span, from: 310.0, to: 10.0 };
        assert!((ruler.at(1e-16) - 26.0).abs() < 1e-9, "one pixel a decade");
        assert!(ruler.at(0.0).is_nan() && ruler.at(-1.0).is_nan());
    }

    #[test]
    fn a_constant_still_has_a_range() {
        for value in [0.0, 3.0, -1e300] {
            let span = Axis::linear("").span([value].into_iter(), 0.05);
            assert!(span.low < value && value < span.high, "{span:?}");
        }
    }

    #[test]
    fn the_whole_range_of_f64_can_be_shown() {
        let span = Axis::linear("").span([f64::MIN, f64::MAX].into_iter(), 0.05);
        assert!((span.high - span.low).is_finite());
    }
}
