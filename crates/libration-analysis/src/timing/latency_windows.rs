//! The latency windows within which a loop is stable.

use libration_core::control::{Feedback, Latency};
use libration_core::number::Wide;
use libration_core::{Elementary, Scalar};

use super::Plant;

/// The intervals of latency, in steps, within which a loop is stable.
///
/// Between whole steps they follow the characteristic polynomial with `λᵈ` for any real `d`, as one finds it in
/// textbooks: whole latencies in an interval are stable, others are not. Where an eigenvalue can pass through −1, which
/// it does at whole latencies of one parity, that has no meaning: then the intervals begin and end with
/// whole latencies, and those up to 64 are tried.
#[derive(Clone, Debug, PartialEq)]
pub struct LatencyWindows {
    /// The lower and upper end of each window; no upper end if every larger latency is stable.
    pub stable: Vec<(f64, Option<f64>)>,
}

/// A pair of eigenvalues on the unit circle, at every latency of a series.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// The first latency, in steps.
    first: f64,
    /// The period of the series.
    apart: f64,
    /// Whether it leaves the circle as the latency grows.
    outward: bool,
}

impl Crossing {
    /// Where it is without latency, says whether it leaves the circle then; rounding may have put it a turn later.
    fn begin(&mut self) -> Option<bool> {
        let near = |d: f64| d.abs() < 1e-9 * self.apart;
        if near(self.first) || near(self.first - self.apart) {
            self.first = 0.0;
            return Some(self.outward);
        }
        None
    }
}

/// Bits after the point to which a determinant must be 1 to be that of a pair on the circle.
const EDGE: i64 = 900;

/// Whole latencies that are tried one by one.
const TRIED: u32 = 64;

/// Latencies beyond this are no numbers of steps, but the rounding of a loop that no delay makes unstable.
const FARTHEST: f64 = 1e15;

/// The largest latency, in whole steps, for which the end within a step is computed.
const SPLIT: f64 = 256.0;

/// Halvings of a step.
const HALVINGS: u32 = 44;

/// Golden sections of a step: to a part of 10⁻⁸.
const SECTIONS: u32 = 40;

/// The largest number of crossings.
const MOST: usize = 100_000;

impl LatencyWindows {
    /// The end of the interval that begins without latency: the critical latency in steps. None if the loop is
    /// not stable without latency, or whatever the latency is.
    pub fn critical(&self) -> Option<f64> {
        self.stable.first().filter(|(from, _)| *from == 0.0).and_then(|(_, to)| *to)
    }
}

impl Plant<'_> {
    /// The latencies at which the loop that `feedback` closes is stable.
    pub fn latency_windows(&self, feedback: Feedback) -> LatencyWindows {
        let none = Latency::of_steps(0.0).map(|none| self.characteristic(feedback, none));
        let Some(quasi) = none else { return LatencyWindows { stable: Vec::new() } };
        let ([a0, a1], [b0, b1, _]) = (quasi.a, quasi.b);
        let one = Wide::one();
        // At λ = 1 the delay does not matter: an eigenvalue beyond stays there.
        if !positive(one + a1 + a0 + b1 + b0) {
            return LatencyWindows { stable: Vec::new() };
        }
        if !positive(one - a1 + a0 - (b0 - b1).abs()) {
            return self.whole_windows(feedback);
        }
        let mut crossings = crossings([a0, a1], [b0, b1]);
        // By Jury's conditions, of which two are met: both eigenvalues are inside, or none, or both are on the circle.
        let room = one - a0 - b0;
        let edge = room.abs() < one.scaled(-EDGE);
        let moved = crossings.iter_mut().filter(|_| edge).find_map(Crossing::begin);
        let mut unstable: u32 = match moved {
            Some(outward) => {
                if outward {
                    0
                } else {
                    2
                }
            }
            None => {
                if positive(room) {
                    0
                } else {
                    2
                }
            }
        };
        let mut stable = Vec::new();
        let mut from = (unstable == 0).then_some(0.0);
        for (d, outward) in events(&crossings) {
            unstable = if outward { unstable + 2 } else { unstable.saturating_sub(2) };
            match (unstable, from) {
                (0, None) => from = Some(d),
                (1.., Some(begin)) => {
                    // What leaves the circle without latency was never within.
                    stable.extend((d > begin).then_some((begin, Some(d))));
                    from = None;
                }
                _ => {}
            }
        }
        stable.extend(from.map(|begin| (begin, None)));
        LatencyWindows { stable }
    }

    /// The latency in steps at which the loop that `feedback` closes becomes unstable, where a command that arrives within
    /// a step splits it, as it does in a simulation: where the spectral radius passes 1.
    ///
    /// It lies within the same step as an end of [`Plant::latency_windows`]. None where there is none, and beyond 256 steps.
    pub fn split_critical_latency(&self, feedback: Feedback) -> Option<f64> {
        let ends = self.latency_windows(feedback).stable.into_iter().filter_map(|(_, end)| end);
        ends.take_while(|&d| d < SPLIT).find_map(|d| self.crossing(feedback, d.floor()))
    }

    /// Where the spectral radius passes 1 between a latency of whole steps at which it is below and the next.
    fn crossing(&self, feedback: Feedback, whole: f64) -> Option<f64> {
        let above = |d: f64| {
            let latency = Latency::of_steps(d).unwrap_or(Latency::NONE);
            self.spectral_radius(feedback, latency) - Wide::one()
        };
        let mut high = whole + 1.0;
        if !positive(above(high)) {
            // It may be above for a while between: the largest of what has one maximum (J. Kiefer, *Sequential minimax search for a
            // maximum*, Proceedings of the American Mathematical Society 4, 1953).
            const PART: f64 = 0.618_033_988_749_894_9;
            let (mut from, mut to) = (whole, high);
            for _ in 0..SECTIONS {
                let [left, right] = [to - PART * (to - from), from + PART * (to - from)];
                match positive(above(left) - above(right)) {
                    true => to = right,
                    false => from = left,
                }
            }
            high = 0.5 * (from + to);
            if !positive(above(high)) {
                return None;
            }
        }
        let mut low = whole;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if positive(above(middle)) { high = middle } else { low = middle }
        }
        Some(low)
    }

    /// Runs of whole latencies at which the loop is stable, each tried.
    fn whole_windows(&self, feedback: Feedback) -> LatencyWindows {
        let is_stable = |steps: &u32| {
            let latency = Latency::of_steps(f64::from(*steps));
            latency.is_some_and(|d| positive(Wide::one() - self.spectral_radius(feedback, d)))
        };
        let mut stable: Vec<(f64, Option<f64>)> = Vec::new();
        for d in (0..=TRIED).filter(is_stable).map(f64::from) {
            match stable.last_mut() {
                Some((_, to)) if *to == Some(d - 1.0) => *to = Some(d),
                _ => stable.push((d, Some(d))),
            }
        }
        LatencyWindows { stable }
    }
}

fn positive(x: Wide) -> bool {
    !x.is_negative() && !x.is_zero()
}

/// Where `λᵈ·a(λ) + b(λ)` with `a = λ² + a₁λ + a₀`, `b = b₁λ + b₀` has roots `e^{±iθ}`: there `|a| = |b|`, which is a
/// quadratic in `cos θ`, and the angle between the two says at which latencies.
fn crossings([a0, a1]: [Wide; 2], [b0, b1]: [Wide; 2]) -> Vec<Crossing> {
    let one = Wide::one();
    let two = |x: Wide| x.scaled(1);
    // F(c) = |a|² − |b|² = f₂c² + f₁c + f₀.
    let f2 = two(two(a0));
    let f1 = two(a1 * (one + a0) - b0 * b1);
    let f0 = one + a1 * a1 + a0 * a0 - two(a0) - b1 * b1 - b0 * b0;
    let roots: Vec<Wide> = if f2.is_zero() {
        vec![-f0 / f1]
    } else {
        let discriminant = f1 * f1 - two(two(f2 * f0));
        let half = discriminant.sqrt();
        [half, -half].map(|half| (half - f1) / two(f2)).to_vec()
    };
    let inside = |c: &Wide| !c.is_nan() && c.abs() < one;
    let crossing = |c: Wide| {
        let s = (one - c * c).sqrt();
        // λ = c + is, λ² = 2c² − 1 + 2ics.
        let a = [two(c * c) - one + a1 * c + a0, two(c * s) + a1 * s];
        let b = [b1 * c + b0, b1 * s];
        // −b/a, but for a positive factor.
        let angle = (b[0] * a[1] - b[1] * a[0]).atan2(-(b[0] * a[0] + b[1] * a[1]));
        let theta = s.atan2(c);
        let turn = two(Wide::pi());
        let positive = if angle.is_negative() { angle + turn } else { angle };
        // |λ| grows with the latency where |a|² − |b|² grows with θ, that is where F falls with c.
        let slope = two(f2 * c) + f1;
        Crossing {
            first: (positive / theta).to_f64(),
            apart: (turn / theta).to_f64(),
            outward: slope.is_negative(),
        }
    };
    let seen = |crossing: &Crossing| crossing.first < FARTHEST;
    roots.into_iter().filter(inside).map(crossing).filter(seen).collect()
}

/// All crossings by rising latency, as far as the loop can become stable again.
fn events(crossings: &[Crossing]) -> Vec<(f64, bool)> {
    let of = |outward: bool| crossings.iter().find(move |crossing| crossing.outward == outward);
    // Each pair that leaves the circle needs one that comes back; those that leave come oftener.
    let last = match (of(true), of(false)) {
        (Some(out), Some(back)) if out.apart < back.apart => {
            let gap = 1.0 / out.apart - 1.0 / back.apart;
            (2.0 + out.first / out.apart - back.first / back.apart) / gap + out.apart + back.apart
        }
        (Some(out), None) => out.first + out.apart,
        _ => crossings
            .iter()
            .map(|crossing| crossing.first + 4.0 * crossing.apart)
            .fold(0.0, f64::max),
    };
    let mut events: Vec<(f64, bool)> = Vec::new();
    for crossing in crossings {
        let series = core::iter::successors(Some(crossing.first), |d| Some(d + crossing.apart));
        let series = series.take_while(|&d| d <= last).take(MOST);
        events.extend(series.map(|d| (d, crossing.outward)));
    }
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    events
}
