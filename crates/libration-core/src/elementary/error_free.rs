//! Sums and products of two `f64` as a rounded result and its exact error, without fused multiply-add.

/// `a + b` as rounded sum and rounding error (Knuth's 2Sum).
#[inline(always)]
pub(crate) const fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// The same for `|a| ≥ |b|` or `a = 0` (Dekker's Fast2Sum).
#[inline(always)]
pub(crate) const fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// `a` as a sum of two numbers of 26 bits each (Veltkamp); NaN for `|a|` above 2⁹⁹⁶.
#[inline(always)]
pub(crate) const fn split(a: f64) -> (f64, f64) {
    // 2²⁷ + 1.
    let t = 134_217_729.0 * a;
    let head = t - (t - a);
    (head, a - head)
}

/// `a · b` as rounded product and rounding error (Dekker's product), for operands that [`split`] takes.
#[inline(always)]
pub(crate) const fn two_product(a: f64, b: f64) -> (f64, f64) {
    product_of_parts(a * b, split(a), split(b))
}

/// The same from `product = a·b` rounded and both factors in two parts.
#[inline(always)]
pub(crate) const fn product_of_parts(
    product: f64,
    (a1, a2): (f64, f64),
    (b1, b2): (f64, f64),
) -> (f64, f64) {
    (product, a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2))
}

/// `(n + n_low) / (d + d_low)` as a quotient and a correction, for low parts of about an ulp.
#[inline(always)]
pub(crate) const fn quotient((n, n_low): (f64, f64), (d, d_low): (f64, f64)) -> (f64, f64) {
    let q = n / d;
    let (product, error) = two_product(q, d);
    let rest = ((n - product) - error) + (n_low - q * d_low);
    (q, rest / d)
}
