//! Weakly hard constraints: how many deadlines are missed at most.

use std::collections::HashMap;

use crate::Transition;

/// A weakly hard constraint: of any `window` consecutive deadlines at most `misses` are missed (G. Bernat, A. Burns, A. Llamosí,
/// *Weakly hard real-time systems*, IEEE Transactions on Computers 50, 2001). At most m consecutive misses are m of m + 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MissConstraint {
    misses: u32,
    window: u32,
}

/// Most nodes of the graph of a constraint.
const MOST_NODES: usize = 1000;

impl MissConstraint {
    /// The constraint; none unless `misses` is below `window`, and the graph of its sequences is small enough: it has as many nodes as
    /// there are choices of `misses` of `window`, at most 1000.
    pub fn new(misses: u32, window: u32) -> Option<Self> {
        let constraint = MissConstraint { misses, window };
        let allowed = misses < window && constraint.nodes().is_some();
        allowed.then_some(constraint)
    }

    /// The most misses in a window.
    pub fn misses(self) -> u32 {
        self.misses
    }

    /// The number of deadlines of a window.
    pub fn window(self) -> u32 {
        self.window
    }

    /// The number of nodes, the binomial coefficient; none if there are too many.
    fn nodes(self) -> Option<usize> {
        let fewer = self.misses.min(self.window - self.misses);
        let mut count = 1_usize;
        for k in 0..fewer {
            count = count.checked_mul((self.window - k) as usize)? / (k + 1) as usize;
            if count > MOST_NODES {
                return None;
            }
        }
        Some(count)
    }

    /// The graph of all allowed sequences, with its number of nodes. `outcomes` has the numbers of the matrices of a period, from
    /// whether the deadline before it and its own are missed.
    pub(crate) fn graph(
        self,
        outcomes: impl Fn(bool, bool) -> Vec<usize>,
    ) -> (usize, Vec<Transition>) {
        // A node is the ages of those misses, latest first, that may still forbid another one. At first there are none.
        let mut nodes = HashMap::from([(Vec::new(), 0)]);
        let mut open = vec![Vec::new()];
        let mut transitions = Vec::new();
        while let Some(ages) = open.pop() {
            let from = nodes[&ages];
            for missed in [false, true] {
                let Some(next) = self.next(&ages, missed) else { continue };
                let count = nodes.len();
                let to = *nodes.entry(next.clone()).or_insert(count);
                if to == count {
                    open.push(next);
                }
                let before = ages.first() == Some(&1);
                for matrix in outcomes(before, missed) {
                    transitions.push(Transition { from, to, matrix });
                }
            }
        }
        (nodes.len(), transitions)
    }

    /// The ages of misses after another deadline; none if it may not be missed.
    fn next(self, ages: &[u32], missed: bool) -> Option<Vec<u32>> {
        let MissConstraint { misses, window } = self;
        if missed && ages.len() == misses as usize {
            return None;
        }
        let latest = missed.then_some(1);
        let ages = latest.into_iter().chain(ages.iter().map(|age| age + 1));
        // The j-th last miss forbids a further one only together with misses − j that come first, one a period.
        let matters = |(age, j): &(u32, u32)| *age < window - misses + j;
        Some(ages.zip(1..).take_while(matters).map(|(age, _)| age).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_walks_of_the_graph_are_the_sequences_that_every_window_allows() {
        for (misses, window) in [(0, 3), (1, 2), (1, 4), (2, 3), (2, 5), (3, 5), (4, 5), (3, 7)] {
            let constraint = MissConstraint::new(misses, window).unwrap();
            let (nodes, transitions) = constraint.graph(|_, missed| vec![usize::from(missed)]);
            assert_eq!(Some(nodes), constraint.nodes());
            for word in 0..1_u32 << 12 {
                let missed: Vec<bool> = (0..12).map(|i| word >> i & 1 == 1).collect();
                let allowed = missed
                    .windows(window as usize)
                    .all(|window| window.iter().filter(|x| **x).count() <= misses as usize);
                let walk = missed.iter().try_fold(0, |node, &missed| {
                    let fits = |t: &&Transition| t.from == node && t.matrix == usize::from(missed);
                    transitions.iter().find(fits).map(|transition| transition.to)
                });
                assert_eq!(walk.is_some(), allowed, "{misses} of {window}: {missed:?}");
            }
        }
    }

    #[test]
    fn a_period_knows_whether_the_deadline_before_it_was_missed() {
        let constraint = MissConstraint::new(2, 5).unwrap();
        let number = |before, missed| vec![2 * usize::from(before) + usize::from(missed)];
        let (_, transitions) = constraint.graph(number);
        for first in &transitions {
            for second in transitions.iter().filter(|second| second.from == first.to) {
                assert_eq!(second.matrix / 2, first.matrix % 2);
            }
        }
    }

    #[test]
    fn constraints_that_forbid_nothing_or_have_too_many_sequences_are_refused() {
        assert_eq!(MissConstraint::new(3, 3), None);
        assert_eq!(MissConstraint::new(0, 0), None);
        assert!(MissConstraint::new(1, 1000).is_some() && MissConstraint::new(999, 1000).is_some());
        assert_eq!(MissConstraint::new(1, 1001), None);
        assert_eq!(MissConstraint::new(20, 40), None);
    }
}
