//! Conversions from and to the bits of an `f64`.

/// `|c| = magnitude · 2^exponent` of a finite `c`.
pub(super) fn decode(c: f64) -> (u64, i32) {
    let field = (c.to_bits() >> 52 & 0x7ff) as i32;
    let fraction = c.to_bits() & ((1 << 52) - 1);
    if field == 0 { (fraction, -1074) } else { (fraction | 1 << 52, field - 1075) }
}

/// `±top · 2^exponent` rounded to nearest, ties to even, where `top` has its highest bit set, and
/// `sticky`: the value is slightly further from zero.
pub(super) fn nearest_f64(negative: bool, top: u64, sticky: bool, exponent: i64) -> f64 {
    let leading = exponent.saturating_add(63);
    // Bits that an f64 of this size has: 53, fewer among the subnormals.
    let keep = (leading + 1075).clamp(-1, 53);
    let magnitude = if leading > 1023 {
        f64::INFINITY
    } else if keep < 0 {
        0.0
    } else {
        let drop = 64 - keep as u32;
        let kept = top.unbounded_shr(drop);
        let (half, rest) = (1 << (drop - 1), top & (u64::MAX >> (64 - drop)));
        let up = rest > half || rest == half && (sticky || kept & 1 == 1);
        // A carry out of the significand runs into the exponent field, where it belongs.
        let field = ((leading + 1022).max(0) as u64) << 52;
        f64::from_bits(field + kept + u64::from(up))
    };
    if negative { -magnitude } else { magnitude }
}
