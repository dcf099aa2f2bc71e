//! Zeros of falling functions.

/// Where a falling function passes zero, between a point where it is above and one where it is below: by secants, each end's value
/// halved where the other moved twice (M. Dowell and P. Jarratt, *A modified regula falsi method*, BIT 11, 1971), and by halving
/// where they are slow.
pub(crate) fn falling_root(
    f: impl Fn(f64) -> f64,
    mut low: (f64, f64),
    mut high: (f64, f64),
) -> f64 {
    let mut rose = None;
    for i in 0..100 {
        if high.0 - low.0 <= 1e-15 * high.0.abs().max(low.0.abs()).max(1e-3) {
            break;
        }
        let secant = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        let inside = low.0 < secant && secant < high.0;
        let at = if inside && i % 4 != 3 { secant } else { 0.5 * (low.0 + high.0) };
        let value = f(at);
        let rises = value > 0.0;
        let again = rose == Some(rises);
        match rises {
            true => (low, high.1) = ((at, value), if again { 0.5 * high.1 } else { high.1 }),
            false => (high, low.1) = ((at, value), if again { 0.5 * low.1 } else { low.1 }),
        }
        rose = Some(rises);
    }
    high.0
}
