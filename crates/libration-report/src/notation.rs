//! Notation of numbers for readers: `1.39·10⁻¹¹`, `0.0158`, `707 107`.

/// Formats `x` with `digits` significant digits, and very large or small numbers with powers of ten.
pub fn number(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return match x {
            f64::INFINITY => "∞".into(),
            f64::NEG_INFINITY => "−∞".into(),
            _ => "not a number".into(),
        };
    }
    if x == 0.0 {
        return "0".into();
    }
    let scientific = format!("{:.*e}", digits.max(1) - 1, x);
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return scientific };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..digits.max(6) as i32).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        return trimmed(&group(&format!("{x:.decimals$}")));
    }
    let mantissa = trimmed(mantissa);
    match mantissa.as_str() {
        "1" => format!("10{}", superscript(exponent)),
        "−1" => format!("−10{}", superscript(exponent)),
        _ => format!("{mantissa}·10{}", superscript(exponent)),
    }
}

/// Formats a count with thin spaces between groups of three digits.
pub fn count(n: u64) -> String {
    group(&n.to_string())
}

/// A count of things: `1 integrator`, `4 integrators`.
pub fn plural(n: usize, thing: &str) -> String {
    let ending = if n == 1 { "" } else { "s" };
    format!("{} {thing}{ending}", count(n as u64))
}

/// Joins words: `a`, `a and b`, `a, b and c`.
pub fn list(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [only] => (*only).into(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// Formats a power of ten from its logarithm: `4.84·10⁴¹³⁹²`.
pub fn power_of_ten(logarithm: f64, digits: usize) -> String {
    let exponent = logarithm.floor();
    let mantissa = trimmed(&format!("{:.*}", digits.max(1) - 1, 10_f64.powf(logarithm - exponent)));
    format!("{mantissa}·10{}", superscript(exponent as i32))
}

/// Formats a time in ns, µs, ms or s.
pub fn seconds(t: f64, digits: usize) -> String {
    match t.abs() {
        t_abs if t_abs < 1e-6 && t_abs > 0.0 => format!("{} ns", number(t * 1e9, digits)),
        t_abs if t_abs < 1e-3 && t_abs > 0.0 => format!("{} µs", number(t * 1e6, digits)),
        t_abs if t_abs < 1.0 && t_abs > 0.0 => format!("{} ms", number(t * 1e3, digits)),
        _ => format!("{} s", number(t, digits)),
    }
}

/// Formats `n` in superscript digits.
pub fn superscript(n: i32) -> String {
    let raised = |c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁰' as u32 + (digit as u32 - '0' as u32)).unwrap_or(digit),
    };
    n.to_string().chars().map(raised).collect()
}

/// Removes trailing zeros after the point and sets a minus sign.
fn trimmed(digits: &str) -> String {
    let plain = match digits.contains('.') {
        true => digits.trim_end_matches('0').trim_end_matches('.'),
        false => digits,
    };
    plain.replace('-', "−")
}

/// Inserts thin spaces between groups of three digits if the integer part has five or more.
fn group(number: &str) -> String {
    let (sign, rest) = number.strip_prefix('-').map_or(("", number), |rest| ("-", rest));
    let (whole, fraction) = rest.split_once('.').map_or((rest, None), |(w, f)| (w, Some(f)));
    let mut grouped = String::new();
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && (whole.len() - i) % 3 == 0 && whole.len() > 4 {
            grouped.push('\u{202f}');
        }
        grouped.push(digit);
    }
    let fraction = fraction.map(|f| format!(".{f}")).unwrap_or_default();
    format!("{sign}{grouped}{fraction}")
}

/// An upper limit with so many digits, not above itself: cut off behind the twelve digits that a search has.
pub fn cut_off(limit: f64, digits: usize) -> f64 {
    let text = format!("{limit:.11e}");
    let cut = text.split_once('e').map(|(mantissa, exponent)| {
        let kept = digits + 1 + usize::from(limit < 0.0);
        let mantissa: String = mantissa.chars().take(kept).collect();
        format!("{mantissa}e{exponent}")
    });
    cut.and_then(|cut| cut.parse().ok()).unwrap_or(limit)
}

/// A lower limit of positive numbers with so many digits, not below itself.
pub fn cut_up(limit: f64, digits: usize) -> f64 {
    let cut = cut_off(limit, digits);
    // As near to it as its twelve digits tell.
    if limit - cut <= 1e-11 * limit {
        return cut;
    }
    let last = 10_f64.powi(limit.log10().floor() as i32 + 1 - digits as i32);
    format!("{:.*e}", digits - 1, cut + last).parse().unwrap_or(limit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_a_physicist_writes_them() {
        assert_eq!(number(1.388887e-11, 3), "1.39·10⁻¹¹");
        assert_eq!(number(0.0158364, 3), "0.0158");
        assert_eq!(number(-0.25, 3), "−0.25");
        assert_eq!(number(22024.36, 3), "22\u{202f}024");
        assert_eq!(number(1e-16, 2), "10⁻¹⁶");
        assert_eq!(number(2.0, 6), "2");
        assert_eq!(number(0.0, 3), "0");
        assert_eq!(count(1_000_000), "1\u{202f}000\u{202f}000");
        assert_eq!((plural(1, "core"), plural(4, "core")), ("1 core".into(), "4 cores".into()));
        assert_eq!((list(&["a"]), list(&["a", "b", "c"])), ("a".into(), "a, b and c".into()));
        assert_eq!(power_of_ten(41392.685158, 3), "4.84·10⁴¹³⁹²");
        assert_eq!(seconds(0.01, 3), "10 ms");
    }

    #[test]
    fn limits_are_not_beyond_themselves() {
        for (x, off, up) in [
            (7.306_194_4e-4, 7.306e-4, 7.307e-4),
            (0.632_455_532, 0.6324, 0.6325),
            (0.1, 0.1, 0.1),
            (0.3 - 0.1, 0.2, 0.2),
            (9.999_96, 9.999, 10.0),
            (12_345.6, 12_340.0, 12_350.0),
        ] {
            assert_eq!([cut_off(x, 4), cut_up(x, 4)], [off, up], "{x}");
        }
        assert_eq!(cut_off(-0.012_349, 4), -0.01234);
        assert!(cut_off(f64::INFINITY, 4).is_infinite());
    }
}
