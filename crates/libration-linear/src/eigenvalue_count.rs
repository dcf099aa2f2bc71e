//! The number of eigenvalues of a loop outside the unit circle.

use core::f64::consts::PI;

use num_complex::Complex64;

use crate::LinearLoopError;
use crate::angle_grid::{AngleGrid, turned, unit};
use crate::hessenberg::Resolved;
use crate::open_channels::PartResponse;

/// The characteristic polynomial `det(1 − z⁻ᵏ G)·det(z − A)` at an angle.
#[derive(Clone)]
struct Point {
    angle: f64,
    /// The largest gain.
    gain: f64,
    /// `1 − z⁻ᵏ λ` of all loci `λ`.
    factors: Vec<Complex64>,
    value: Complex64,
}

impl Point {
    /// The sum of the arguments of all factors, each within half a turn.
    fn argument(&self) -> f64 {
        self.factors.iter().map(|factor| factor.arg()).sum()
    }

    /// Whether a factor near zero has one beside it at `other`: a polynomial alone has the same value on both sides of two zeros.
    fn continues_at(&self, other: &Point) -> bool {
        let size = |factor: &&Complex64| factor.norm_sqr();
        let least = self.factors.iter().min_by(|a, b| size(a).total_cmp(&size(b)));
        least.is_none_or(|least| {
            let near = |factor: &Complex64| (factor - least).norm() < 0.7 * least.norm();
            least.norm() > 1.0 || other.factors.iter().any(near)
        })
    }
}

/// Gain below which `1 − z⁻ᵏ G` stays right of zero for each locus, however often `z⁻ᵏ` turns.
const SMALL: f64 = 0.9;

impl AngleGrid<'_> {
    /// The number of eigenvalues outside the unit circle: the argument of the characteristic polynomial along half of it.
    ///
    /// # Errors
    /// [`LinearLoopError::Range`] if the polynomial is beyond the range of floats, and [`LinearLoopError::Search`].
    pub(crate) fn unstable(
        &self,
        response: &PartResponse,
        whole: u64,
    ) -> Result<i64, LinearLoopError> {
        let k = whole as f64;
        let point = |angle: f64, resolved: &Resolved| {
            let loci = response.loci(unit(angle), resolved);
            let back = Complex64::from_polar(1.0, -k * angle);
            let factor = |locus: &Complex64| Complex64::ONE - back * locus;
            let factors: Vec<Complex64> = loci.iter().map(factor).collect();
            let value = resolved.determinant * factors.iter().product::<Complex64>();
            Point { angle, gain: loci.first().map_or(0.0, |most| most.norm()), factors, value }
        };
        let fresh = |angle: f64| point(angle, &self.open.resolved(unit(angle)));
        let all = self.points.iter().map(|(angle, resolved)| (point(*angle, resolved), resolved));
        let known: Vec<(Point, &Resolved)> = all.collect();
        // The polynomial turns by no more than this many turns of `z`.
        let delays = self.open.channels() as f64 * (k + 1.0 + self.open.most_periods() as f64);
        let mut turn = 0.0;
        for pair in known.windows(2) {
            let [(from, a), (to, b)] = [&pair[0], &pair[1]];
            turn += match from.gain.max(to.gain) < SMALL {
                // Right of zero an argument needs no steps.
                true => {
                    let own = turned(a.determinant.arg(), b.determinant.arg());
                    to.argument() - from.argument() + own
                }
                false => {
                    let ends = || self.open.is_exhausted();
                    argument((&fresh, &ends), from, to, 0.5 / delays, 48)
                }
            };
        }
        if self.open.is_exhausted() {
            return Err(self.open.exhausted());
        }
        if turn.is_nan() {
            return Err(LinearLoopError::Range);
        }
        Ok(self.open.size() as i64 - (turn / PI).round() as i64)
    }
}

/// The angle by which the polynomial turns from one point to another, which are halved until it changes by a part of its size, or the
/// search ends.
fn argument(
    (f, ends): (&impl Fn(f64) -> Point, &impl Fn() -> bool),
    from: &Point,
    to: &Point,
    most: f64,
    depth: u32,
) -> f64 {
    let change = (to.value - from.value).norm();
    if !change.is_finite() {
        // No part of the way is closer.
        return f64::NAN;
    }
    let small = change < 0.7 * from.value.norm().min(to.value.norm());
    let close = || from.continues_at(to) && to.continues_at(from);
    if small && to.angle - from.angle <= most && close() || depth == 0 || ends() {
        return turned(from.value.arg(), to.value.arg());
    }
    let at = f(0.5 * (from.angle + to.angle));
    let part = |from: &Point, to: &Point| argument((f, ends), from, to, most, depth - 1);
    part(from, &at) + part(&at, to)
}
