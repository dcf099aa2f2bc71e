//! Dates with times of day in ISO 8601.

/// The time since 1970 in ns of `2025-10-09T08:53:20.123+02:00`; with a space instead of `T` as well, and UTC without an offset.
pub(crate) fn parse_iso_8601(text: &str) -> Option<i64> {
    let (date, time) = text.split_at_checked(10)?;
    let time = time.strip_prefix(['T', ' '])?;
    let [year, month, day] = fields(date, '-')?;
    let clock = time.trim_end_matches('Z');
    // The offset begins behind the hour.
    let (clock, offset) = match clock.rfind(['+', '-']) {
        Some(at) => {
            let (clock, offset) = clock.split_at(at);
            let (hours, minutes) = match offset.get(1..)?.split_once(':') {
                Some(parts) => parts,
                None => offset.get(1..)?.split_at_checked(2)?,
            };
            let minutes = if minutes.is_empty() { 0 } else { digits(minutes)? };
            let seconds = 3600 * digits(hours)? + 60 * minutes;
            (clock, if offset.starts_with('-') { -seconds } else { seconds })
        }
        None => (clock, 0),
    };
    let (clock, fraction) = clock.split_once(['.', ',']).unwrap_or((clock, ""));
    let [hour, minute, second] = fields(clock, ':')?;
    let is_valid = (1..=12).contains(&month)
        && (1..=31).contains(&day)
        && hour < 24
        && minute < 60
        && second <= 60;
    if !is_valid || fraction.len() > 9 {
        return None;
    }
    let nanoseconds = digits(&format!("{fraction:0<9}"))?;
    // H. Hinnant, chrono-compatible low-level date algorithms: days since 1970 of a civil date.
    let year = if month <= 2 { year - 1 } else { year };
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    let days = 365 * year + year / 4 - year / 100 + year / 400 + of_year - 719_468;
    let seconds = 86_400 * days + 3600 * hour + 60 * minute + second - offset;
    seconds.checked_mul(1_000_000_000)?.checked_add(nanoseconds)
}

fn fields(text: &str, separator: char) -> Option<[i64; 3]> {
    let mut parts = text.split(separator).map(digits);
    let fields = [parts.next()??, parts.next()??, parts.next()??];
    parts.next().is_none().then_some(fields)
}

fn digits(text: &str) -> Option<i64> {
    text.bytes().all(|byte| byte.is_ascii_digit()).then(|| text.parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::parse_iso_8601;

    #[test]
    fn dates_are_those_of_the_calendar() {
        for (text, seconds) in [
            ("1970-01-01T00:00:00Z", 0),
            ("2000-02-29 12:00:00", 951_825_600),
            ("2025-10-09T08:53:20+00:00", 1_760_000_000),
            ("2025-10-09T08:53:20-0130", 1_760_005_400),
        ] {
            assert_eq!(parse_iso_8601(text), Some(seconds * 1_000_000_000), "{text}");
        }
        for text in ["2025-10-09", "2025-13-09T00:00:00", "08:53:20", "2025-10-09T08:53", "x"] {
            assert_eq!(parse_iso_8601(text), None, "{text}");
        }
    }
}
