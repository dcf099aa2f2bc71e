//! Ticks of axes.

use super::axis::{Scale, Span};

/// A tick.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    /// Empty for a minor tick.
    pub(super) label: String,
}

/// Ticks for a span shown over a length in pixels, at least `apart` pixels from one to the next.
pub(super) fn ticks(span: &Span, length: f64, apart: f64) -> Vec<Tick> {
    match span.scale {
        Scale::Linear => linear(span.low, span.high, length / apart),
        Scale::Log => log(span.low, span.high, length / apart),
    }
}

fn linear(low: f64, high: f64, most: f64) -> Vec<Tick> {
    let step = step((high - low) / most.max(2.0));
    let slack = 1e-9 * (high - low) / step;
    let (first, last) = ((low / step - slack).ceil(), (high / step + slack).floor());
    let count = (last - first).clamp(0.0, 1000.0) as usize + 1;
    let values: Vec<f64> = (0..count).map(|i| tidy((first + i as f64) * step, step)).collect();
    let power = shared_power(&values, step);
    values.iter().map(|&value| Tick { value, label: number(value, step, power) }).collect()
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `least`.
fn step(least: f64) -> f64 {
    let decade = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0]
        .map(|m| m * decade)
        .into_iter()
        .find(|&s| s >= least * 0.999)
        .unwrap_or(10.0 * decade)
}

/// A multiple of a step without its rounding error.
fn tidy(value: f64, step: f64) -> f64 {
    let decimals = (1 - step.log10().floor() as i64).max(0);
    if decimals > 15 {
        return value;
    }
    format!("{value:.*}", decimals as usize).parse().unwrap_or(value)
}

/// The common power of ten of the numbers; 0 if they are short without it.
fn shared_power(values: &[f64], step: f64) -> i32 {
    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if (largest < 1e5 && step >= 0.99e-4) || largest == 0.0 {
        return 0;
    }
    largest.log10().floor() as i32
}

fn number(value: f64, step: f64, power: i32) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let unit = 10_f64.powi(power);
    let decimals = (-(step / unit * 1.001).log10().floor()).clamp(0.0, 12.0) as usize;
    written(&format!("{:.decimals$}", value / unit), power)
}

/// A number from its mantissa and its power of ten.
fn written(mantissa: &str, power: i32) -> String {
    let mantissa = mantissa.replace('-', "−");
    match (power, mantissa.as_str()) {
        (0, _) => mantissa,
        (_, "1") => format!("10^{{{}}}", minus(power)),
        (_, "−1") => format!("−10^{{{}}}", minus(power)),
        _ => format!("{mantissa}·10^{{{}}}", minus(power)),
    }
}

/// The shortest text of a contour level; long numbers have enough digits to distinguish the next level.
pub(super) fn level(value: f64, step: f64) -> String {
    let plain = value.to_string();
    let scientific = format!("{value:e}");
    let short = if plain.len() < 7 {
        Some((plain.as_str(), 0))
    } else {
        scientific.split_once('e').and_then(|(m, e)| Some((m, e.parse().ok()?)))
    };
    match short {
        Some((mantissa, power)) if mantissa.len() < 7 => written(mantissa, power),
        _ => {
            let step = if step.is_finite() && step > 0.0 { step } else { value.abs() / 100.0 };
            number(value, step, shared_power(&[value], step))
        }
    }
}

fn minus(number: i32) -> String {
    number.to_string().replace('-', "−")
}

fn log(low: f64, high: f64, most: f64) -> Vec<Tick> {
    let slack = 1e-9;
    let (first, last) = ((low - slack).ceil() as i32, (high + slack).floor() as i32);
    let decades = high - low;
    let stride = [1, 2, 3, 4, 5, 10, 20, 50, 100, 200]
        .into_iter()
        .find(|&stride| decades / f64::from(stride) <= most)
        .unwrap_or(400);
    let label = |decade: i32| format!("10^{{{}}}", minus(decade));
    let mut ticks: Vec<Tick> = (first..=last)
        .filter(|decade| decade.rem_euclid(stride) == 0)
        .map(|decade| Tick { value: power_of_ten(decade), label: label(decade) })
        .collect();
    if stride > 1 || decades > most {
        return ticks;
    }
    // With less than two labelled decades some values between get labels.
    let named: &[u32] = match ticks.len() {
        0 | 1 if decades < 0.7 => &[2, 3, 4, 5, 6, 7, 8, 9],
        0..=2 if 0.3 * most > 0.8 * decades => &[2, 5],
        _ => &[],
    };
    if !named.is_empty() {
        let plain = |tick: &Tick| between(1, tick.value.log10().round() as i32);
        ticks.iter_mut().for_each(|tick| tick.label = plain(tick));
    }
    for decade in first - 1..=last {
        for digit in 2..=9 {
            let value = f64::from(digit) * power_of_ten(decade);
            if (low - slack..=high + slack).contains(&value.log10()) {
                let named = named.contains(&digit);
                let label = if named { between(digit, decade) } else { String::new() };
                ticks.push(Tick { value, label });
            }
        }
    }
    ticks.sort_by(|a, b| a.value.total_cmp(&b.value));
    if !named.is_empty() {
        thin_labels(&mut ticks, LEAST_APART * decades / most);
    }
    ticks
}

/// Part of the distance of ticks that labels of a logarithmic axis have at least.
const LEAST_APART: f64 = 0.7;

/// Removes labels that are closer than this many decades to one of a rounder number.
fn thin_labels(ticks: &mut [Tick], apart: f64) {
    let mut kept: Vec<f64> = Vec::new();
    for digits in ["1", "25", "346789"] {
        for tick in ticks.iter_mut().filter(|tick| !tick.label.is_empty()) {
            let is_due = format!("{:e}", tick.value).starts_with(|digit| digits.contains(digit));
            let place = tick.value.log10();
            match kept.iter().any(|other| (other - place).abs() < apart) {
                _ if !is_due => {}
                true => tick.label.clear(),
                false => kept.push(place),
            }
        }
    }
}

/// A correctly rounded power of ten, also where `powi` underflows.
fn power_of_ten(decade: i32) -> f64 {
    format!("1e{decade}").parse().unwrap_or(f64::NAN)
}

fn between(digit: u32, decade: i32) -> String {
    match decade {
        0..=3 => format!("{digit}{}", "0".repeat(decade as usize)),
        -3..=-1 => format!("0.{}{digit}", "0".repeat((-decade - 1) as usize)),
        _ if digit == 1 => format!("10^{{{}}}", minus(decade)),
        _ => format!("{digit}·10^{{{}}}", minus(decade)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, low: f64, high: f64) -> Vec<String> {
        let named = ticks(&Span { scale, low, high }, 400.0, 60.0).into_iter().map(|t| t.label);
        named.filter(|label| !label.is_empty()).collect()
    }

    #[test]
    fn linear_numbers_are_short_and_signed_truly() {
        assert_eq!(labels(Scale::Linear, -1.0, 1.0), ["−1.0", "−0.5", "0", "0.5", "1.0"]);
        assert_eq!(
            labels(Scale::Linear, 0.0, 0.3),
            ["0", "0.05", "0.10", "0.15", "0.20", "0.25", "0.30"]
        );
        let millions = labels(Scale::Linear, 0.0, 4e6);
        assert_eq!(millions, ["0", "10^{6}", "2·10^{6}", "3·10^{6}", "4·10^{6}"]);
        assert_eq!(labels(Scale::Linear, 0.0, 4e-9)[2], "2·10^{−9}");
    }

    #[test]
    fn levels_are_short() {
        let named = [1e-12, -2.5e-7, 0.25, 0.0, 1e9, 1.0 / 3.0].map(|value| level(value, 0.1));
        assert_eq!(named, ["10^{−12}", "−2.5·10^{−7}", "0.25", "0", "10^{9}", "0.3"]);
    }

    #[test]
    fn decades_are_thinned_evenly_down_to_the_smallest_numbers() {
        assert_eq!(labels(Scale::Log, -2.0, 1.0), ["10^{−2}", "10^{−1}", "10^{0}", "10^{1}"]);
        assert_eq!(
            labels(Scale::Log, -300.0, 0.0),
            ["10^{−300}", "10^{−250}", "10^{−200}", "10^{−150}", "10^{−100}", "10^{−50}", "10^{0}"]
        );
    }

    #[test]
    fn a_part_of_a_decade_is_still_marked() {
        assert!(labels(Scale::Log, 0.1, 0.6).len() >= 2);
        assert_eq!(labels(Scale::Log, -1.2, 0.2), ["0.1", "0.2", "0.5", "1"]);
        // 0.04 to 0.16 on a narrow axis: no room for each digit.
        let narrow = ticks(&Span { scale: Scale::Log, low: -1.4, high: -0.8 }, 120.0, 62.0);
        let narrow: Vec<&str> =
            narrow.iter().map(|tick| &*tick.label).filter(|label| !label.is_empty()).collect();
        assert_eq!(narrow, ["0.05", "0.1"]);
    }
}
