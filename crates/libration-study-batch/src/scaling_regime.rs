//! Regimes of a rate curve and their limits.

/// A rate that more of the same reach so many times over is that of an overhead.
const OVERHEAD: f64 = 2.0;

/// Rates within this factor of each other belong to one plateau.
const PLATEAU: f64 = 1.3;

/// A run of numbers (of trajectories, of environments) over which one thing limits the rate.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ScalingRegime<P> {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) limit: Limit<P>,
    /// The largest rate in it.
    pub(super) rate: f64,
}

/// The limit of a rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Limit<P> {
    /// The fixed cost of a pass.
    Overhead,
    /// A limit that is independent of the number.
    Plateau(P),
}

impl<P> ScalingRegime<P> {
    /// Whether more of the same would be faster.
    pub(super) fn is_overhead(&self) -> bool {
        matches!(self.limit, Limit::Overhead)
    }

    fn reach(&mut self, count: f64, rate: f64) {
        self.to = count;
        self.rate = self.rate.max(rate);
    }
}

/// Divides one curve: first where many more have a higher rate, then into plateaus; what limits a plateau is told by its
/// last number and that one's rate.
pub(super) fn regimes<P: Copy>(
    counts: &[f64],
    rates: &[f64],
    plateau: impl Fn(f64, f64) -> P,
) -> Vec<ScalingRegime<P>> {
    let mut all: Vec<ScalingRegime<P>> = Vec::new();
    for (i, (&count, &rate)) in counts.iter().zip(rates).enumerate() {
        let best = rates[i..].iter().copied().fold(0.0, f64::max);
        let limit = match best >= OVERHEAD * rate {
            true => Limit::Overhead,
            false => Limit::Plateau(plateau(count, rate)),
        };
        let near = |best: f64| best.max(rate) < PLATEAU * best.min(rate);
        match (all.last_mut(), limit) {
            (Some(last), Limit::Overhead) if last.is_overhead() => last.reach(count, rate),
            (Some(last), Limit::Plateau(_)) if !last.is_overhead() && near(last.rate) => {
                last.reach(count, rate);
                // A plateau that reaches further is not limited by what limited its beginning.
                last.limit = limit;
            }
            _ => all.push(ScalingRegime { from: count, to: count, limit, rate }),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_cut_where_it_stops_growing_and_where_it_falls() {
        let counts = [1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6];
        let rates = [1.0, 10.0, 90.0, 500.0, 480.0, 510.0, 100.0];
        let held = |count: f64, _| (count < 3e5).then_some(if count < 5e3 { 1 } else { 2 });
        let regime = |from, to, limit, rate| ScalingRegime { from, to, limit, rate };
        assert_eq!(
            regimes(&counts, &rates, held),
            [
                regime(1.0, 100.0, Limit::Overhead, 90.0),
                regime(1e3, 1e5, Limit::Plateau(Some(2)), 510.0),
                regime(1e6, 1e6, Limit::Plateau(None), 100.0),
            ]
        );
    }

    #[test]
    fn numbers_that_lie_close_or_far_apart_are_told_by_their_rates() {
        let all = regimes(&[1e3, 1.001e3, 1e6], &[5.0, 7.0, 6.0], |_, _| None::<u32>);
        assert!(all.iter().all(|regime| regime.limit == Limit::Plateau(None)), "{all:?}");
        let all = regimes(&[3.0, 4.0, 1e6], &[0.2, 0.3, 9.0], |_, _| None::<u32>);
        assert_eq!((all[0].to, all[0].limit), (4.0, Limit::Overhead), "{all:?}");
    }

    #[test]
    fn a_flat_curve_is_one_plateau() {
        let all = regimes(&[1.0, 10.0, 100.0], &[5.0, 5.1, 4.9], |_, _| Some(1));
        assert_eq!(all.len(), 1);
        assert_eq!((all[0].from, all[0].to), (1.0, 100.0));
    }
}
