//! The range of a gain with which steps are stable.

/// Ratio of successive trials.
const RATIO: f64 = 1.5;
/// Smallest and largest trial in units of the gain.
const RANGE: [f64; 2] = [1e-6, 1e6];
const BISECTIONS: usize = 60;

/// Gains with which steps are stable: those around the given one, or the next ones if it is unstable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GainLimits {
    /// The smallest one; 0 if the search begins with a stable one or finds none.
    pub(super) least: f64,
    /// The largest one; infinite if no limit was found, 0 if no gain is stable.
    pub(super) most: f64,
}

impl GainLimits {
    const NONE: Self = GainLimits { least: 0.0, most: 0.0 };

    /// The limits around `given`, in trials of at least `unit`, to a relative `resolution`.
    ///
    /// # Errors
    /// Those of `holds`.
    pub(super) fn search<E>(
        given: f64,
        unit: f64,
        resolution: f64,
        holds: &mut dyn FnMut(f64) -> Result<bool, E>,
    ) -> Result<Self, E> {
        let unit = if given > 0.0 { given } else { unit };
        if holds(given)? {
            let most = end(given, unit, RATIO, resolution, holds)?.unwrap_or(f64::INFINITY);
            return Ok(GainLimits { least: 0.0, most });
        }
        let fails = |gain: f64, holds: &mut dyn FnMut(f64) -> Result<bool, E>| {
            holds(gain).map(|holds| !holds)
        };
        let below = end(given, unit, RATIO.recip(), resolution, &mut |gain| fails(gain, holds))?;
        if let Some(limit) = below {
            // The last one that fails is above the limit.
            return Ok(GainLimits { least: 0.0, most: limit * (1.0 - 2.0 * resolution) });
        }
        let above = end(given, unit, RATIO, resolution, &mut |gain| fails(gain, holds))?;
        let Some(least) = above else { return Ok(Self::NONE) };
        let least = least * (1.0 + 10.0 * resolution);
        let most = end(least, least, RATIO, resolution, holds)?.unwrap_or(f64::INFINITY);
        Ok(GainLimits { least, most })
    }
}

/// The gain up to which `holds` is true from one at which it is; none within the range.
fn end<E>(
    from: f64,
    unit: f64,
    ratio: f64,
    resolution: f64,
    holds: &mut dyn FnMut(f64) -> Result<bool, E>,
) -> Result<Option<f64>, E> {
    let first = if from > 0.0 { from * ratio } else { unit };
    // Without a unit there is nothing to try.
    if ratio < 1.0 && from <= 0.0 || first <= 0.0 {
        return Ok(None);
    }
    let (mut inside, mut outside) = (from, first);
    while holds(outside)? {
        inside = outside;
        outside *= ratio;
        if !(unit * RANGE[0]..=unit * RANGE[1]).contains(&outside) {
            return Ok(None);
        }
    }
    for _ in 0..BISECTIONS {
        if (outside - inside).abs() <= resolution * inside {
            break;
        }
        let middle = f64::midpoint(inside, outside);
        if holds(middle)? {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    Ok(Some(inside))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(given: f64, stable: impl Fn(f64) -> bool) -> GainLimits {
        let found: Result<_, ()> =
            GainLimits::search(given, 1e-3, 1e-9, &mut |gain| Ok(stable(gain)));
        found.unwrap()
    }

    #[test]
    fn limits_are_those_of_the_stable_range_around_or_next_to_the_gain() {
        let near = |found: f64, wanted: f64| (found / wanted - 1.0).abs() < 1e-7;
        let inside = |gain: f64| gain < 7.0;
        assert!(near(limits(2.0, inside).most, 7.0) && near(limits(0.0, inside).most, 7.0));
        assert!(near(limits(20.0, inside).most, 7.0) && inside(limits(20.0, inside).most));
        let window = limits(2.0, |gain| (3.0..9.0).contains(&gain));
        assert!(near(window.least, 3.0) && near(window.most, 9.0));
        assert_eq!(limits(2.0, |_| true), GainLimits { least: 0.0, most: f64::INFINITY });
        assert_eq!(limits(2.0, |_| false), GainLimits::NONE);
        let without_unit = GainLimits::search(0.0, 0.0, 1e-9, &mut |_| Ok::<_, ()>(true));
        assert_eq!(without_unit, Ok(GainLimits { least: 0.0, most: f64::INFINITY }));
    }
}
