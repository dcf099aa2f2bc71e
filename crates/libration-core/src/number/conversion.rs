//! Conversions between number types.

use super::{Ratio, TwoFloat, Wide};
use crate::Scalar;

impl From<Ratio> for Wide {
    fn from(ratio: Ratio) -> Self {
        let Some((negative, num, den, exponent)) = ratio.parts() else { return Wide::NAN };
        let den = Wide::rounded(false, den, 0);
        Wide::rounded(negative, num, 0).scaled(exponent.into()) / den
    }
}

impl From<TwoFloat> for Wide {
    /// Exact.
    fn from(x: TwoFloat) -> Self {
        Wide::from_f64(x.hi()) + Wide::from_f64(x.lo())
    }
}

impl From<Wide> for TwoFloat {
    /// The nearest double-double.
    fn from(x: Wide) -> Self {
        let hi = x.to_f64();
        TwoFloat::from_sum(hi, (x - Wide::from_f64(hi)).to_f64())
    }
}
