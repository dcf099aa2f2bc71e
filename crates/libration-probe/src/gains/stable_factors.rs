//! The factors of gains with which steps are stable.

use super::growth::Growth;

/// Gains in units of those at which a step is about unstable, between which limits are searched for in small steps.
const NEAR: [f64; 2] = [1e-6, 1e3];
/// The least and the largest ones that are tried.
const RANGE: [f64; 2] = [1e-30, 1e9];
const BISECTIONS: usize = 100;
/// Relative accuracy of limits, and of those of many coupled joints, whose steps take long.
const RESOLUTION: [f64; 2] = [1e-13, 1e-10];
/// Joints that are not many.
const FEW: usize = 4;

/// The relative accuracy of limits of joints whose largest coupled part has this size.
pub(super) fn resolution_of(coupled: usize) -> f64 {
    RESOLUTION[usize::from(coupled > FEW)]
}

/// The factors with which steps are stable: those around 1, or the next ones if a step with 1 is unstable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StableFactors {
    /// The smallest one; 0 if the search begins with it or does not go there.
    pub(super) least: f64,
    /// The largest one; infinite if there is no limit, 0 if no factor is stable.
    pub(super) most: f64,
}

impl StableFactors {
    const NONE: Self = StableFactors { least: 0.0, most: 0.0 };

    /// The stable factors of a gain whose given value has this `size`, in units of the gain at which a step is about unstable.
    pub(super) fn search(size: f64, resolution: f64, growth: impl Fn(f64) -> Growth) -> Self {
        if size == 0.0 {
            let most = if growth(1.0) == Growth::Some { 0.0 } else { f64::INFINITY };
            return StableFactors { least: 0.0, most };
        }
        let size = size.clamp(f64::MIN_POSITIVE, f64::MAX);
        let upper =
            |from: f64| upper_end(from, [size, resolution], &growth).unwrap_or(f64::INFINITY);
        if growth(1.0) != Growth::Some {
            return StableFactors { least: 0.0, most: upper(1.0) };
        }
        // Gains that are too large, or too small beside a negative stiffness.
        let holds = |factor: f64| growth(factor) == Growth::None;
        if let Some((inside, outside)) = first_below(size, &holds) {
            return StableFactors {
                least: 0.0,
                most: bisected([inside, outside], resolution, holds),
            };
        }
        match first_above(size, &holds) {
            Some((outside, inside)) => {
                let least = bisected([inside, outside], resolution, holds);
                StableFactors { least, most: upper(least) }
            }
            None => Self::NONE,
        }
    }
}

/// The largest gain with which a step is stable; `unit` is one that is about the limit, and `size` the given one in this unit.
pub(super) fn largest_gain(
    given: f64,
    [size, unit]: [f64; 2],
    resolution: f64,
    growth: impl Fn(f64) -> Growth,
) -> f64 {
    if given > 0.0 {
        let size = size.max(f64::MIN_POSITIVE);
        return given
            * StableFactors::search(size, resolution, |factor| growth(given * factor)).most;
    }
    // Beyond the range of floats no gain is as large as the limit.
    if !unit.is_finite() {
        return f64::INFINITY;
    }
    let growth = |gain: f64| growth(gain * unit);
    let first = NEAR[0];
    if growth(0.0) == Growth::Some || growth(first) == Growth::Some {
        let most = match growth(0.0) {
            Growth::Some => StableFactors::search(1.0, resolution, growth).most,
            _ => {
                StableFactors::search(first, resolution, |factor| growth(factor * first)).most
                    * first
            }
        };
        return unit * most;
    }
    unit * upper_end(first, [1.0, resolution], &growth).unwrap_or(f64::INFINITY)
}

/// The ratio of the next trial to one of this size, or of this one to the next.
fn ratio(size: f64) -> f64 {
    match size {
        size if size < NEAR[0] => 1e3,
        size if size < NEAR[1] => 1.5,
        _ => 10.0,
    }
}

/// The factor up to which no motion grows from one at which none does; none within the range.
fn upper_end(
    from: f64,
    [size, resolution]: [f64; 2],
    growth: &impl Fn(f64) -> Growth,
) -> Option<f64> {
    let is_known = growth(from) == Growth::None;
    let mut inside = from;
    loop {
        // Not far into the range of small steps.
        let most = (NEAR[0] / (size * inside)).max(1.5);
        let outside =
            inside * ratio(size * inside).min(if size * inside < NEAR[0] { most } else { 10.0 });
        if outside * size.min(1.0) > RANGE[1] || !outside.is_finite() {
            return None;
        }
        if growth(outside) == Growth::Some {
            let holds = |factor: f64| match growth(factor) {
                Growth::None => true,
                Growth::Some => false,
                Growth::Unknown => !is_known,
            };
            return Some(bisected([inside, outside], resolution, holds));
        }
        inside = outside;
    }
}

/// A factor below 1 that holds, and the next tried one above it, which does not.
fn first_below(size: f64, holds: &impl Fn(f64) -> bool) -> Option<(f64, f64)> {
    let mut outside = 1.0;
    loop {
        let inside = outside / ratio(size * outside);
        if size * inside < RANGE[0] || inside == 0.0 {
            return None;
        }
        if holds(inside) {
            return Some((inside, outside));
        }
        outside = inside;
    }
}

/// A factor above 1 that does not hold, and the next tried one above it, which holds.
fn first_above(size: f64, holds: &impl Fn(f64) -> bool) -> Option<(f64, f64)> {
    let mut outside = 1.0;
    loop {
        let inside = outside * ratio(size * outside);
        if inside * size.min(1.0) > RANGE[1] || !inside.is_finite() {
            return None;
        }
        if holds(inside) {
            return Some((outside, inside));
        }
        outside = inside;
    }
}

/// The last factor that holds between one that does and one that does not.
fn bisected(
    [mut inside, mut outside]: [f64; 2],
    resolution: f64,
    holds: impl Fn(f64) -> bool,
) -> f64 {
    for _ in 0..BISECTIONS {
        if (outside - inside).abs() <= resolution * inside {
            break;
        }
        let middle = match outside / inside {
            part if (0.5..2.0).contains(&part) => f64::midpoint(inside, outside),
            _ => inside.sqrt() * outside.sqrt(),
        };
        if holds(middle) { inside = middle } else { outside = middle }
    }
    inside
}
