//! Published splitting methods: their coefficients as data.

use super::Integrator;
use super::table_comparison::compared_by_name;
use crate::{Scalar, State, System};

/// A published splitting method: a word of kicks and drifts, with its source.
///
/// All of them share one step, so that a further method adds no code.
pub struct SplittingTable {
    /// Name on the command line and in configurations.
    pub name: &'static str,
    /// Name in running text.
    pub title: &'static str,
    /// A description in one line.
    pub summary: &'static str,
    /// Authors, year, and place of the coefficients.
    pub source: &'static str,
    /// Classical order of consistency.
    pub order: u32,
    /// The systems for which it has its order.
    pub scope: SplittingScope,
    /// The coefficients.
    pub coefficients: SplittingCoefficients,
}

/// The systems for which a splitting method has its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SplittingScope {
    /// Sums of any two parts, each of which is solved exactly.
    General,
    /// Forces of positions, and a kinetic energy that is quadratic in the velocities (Runge–Kutta–Nyström).
    Nystrom,
    /// Sums of any two parts, with smaller errors where the kicks are weak.
    NearlyIntegrable {
        /// The order of the errors that are linear in the strength of the kicks.
        weak: u32,
    },
}

/// Fractions of the time step, in the order of time.
#[derive(Clone, Copy, Debug)]
pub enum SplittingCoefficients {
    /// A kick, a drift, a kick, and so on.
    KickFirst(&'static [f64]),
    /// A drift, a kick, a drift, and so on.
    DriftFirst(&'static [f64]),
    /// As [`KickFirst`](SplittingCoefficients::KickFirst), the same forwards and backwards: the first half, with the letter in the middle.
    SymmetricKickFirst(&'static [f64]),
    /// As [`DriftFirst`](SplittingCoefficients::DriftFirst), the same forwards and backwards: the first half, with the letter in the middle.
    SymmetricDriftFirst(&'static [f64]),
    /// Steps of [`Leapfrog`](super::Leapfrog), the same forwards and backwards: the first half, with the step in the middle.
    SymmetricLeapfrogs(&'static [f64]),
}

use SplittingCoefficients::{
    DriftFirst, KickFirst, SymmetricDriftFirst, SymmetricKickFirst, SymmetricLeapfrogs,
};

impl SplittingCoefficients {
    /// The numbers of the table.
    pub const fn numbers(&self) -> &'static [f64] {
        match self {
            KickFirst(all)
            | DriftFirst(all)
            | SymmetricKickFirst(all)
            | SymmetricDriftFirst(all)
            | SymmetricLeapfrogs(all) => all,
        }
    }

    /// The same with other numbers.
    pub const fn with_numbers(&self, numbers: &'static [f64]) -> Self {
        match self {
            KickFirst(_) => KickFirst(numbers),
            DriftFirst(_) => DriftFirst(numbers),
            SymmetricKickFirst(_) => SymmetricKickFirst(numbers),
            SymmetricDriftFirst(_) => SymmetricDriftFirst(numbers),
            SymmetricLeapfrogs(_) => SymmetricLeapfrogs(numbers),
        }
    }

    /// Whether a step back undoes a step.
    pub const fn is_symmetric(&self) -> bool {
        !matches!(self, KickFirst(_) | DriftFirst(_))
    }

    /// The number of letters, or of leapfrogs.
    const fn count(&self) -> usize {
        let count = self.numbers().len();
        if self.is_symmetric() { 2 * count - 1 } else { count }
    }

    /// The fraction of letter or leapfrog `i`.
    fn fraction(&self, i: usize) -> f64 {
        self.numbers()[if self.is_symmetric() { i.min(self.count() - 1 - i) } else { i }]
    }

    /// The larger sum of the sizes of the fractions of kicks or drifts: more than one where a step goes back and forth.
    pub fn path(&self) -> f64 {
        let sum = |every: usize, first: usize| -> f64 {
            (first..self.count()).step_by(every).map(|i| self.fraction(i).abs()).sum()
        };
        match self {
            SymmetricLeapfrogs(_) => sum(1, 0),
            _ => sum(2, 0).max(sum(2, 1)),
        }
    }

    /// Force evaluations of a step, where a kick at the end shares its force with the kick at the beginning of the next.
    pub const fn stages(&self) -> usize {
        let ends_in_kicks = match self {
            KickFirst(all) => all.len() % 2 == 1,
            SymmetricKickFirst(_) => true,
            DriftFirst(_) | SymmetricDriftFirst(_) | SymmetricLeapfrogs(_) => false,
        };
        if ends_in_kicks && self.kicks() > 1 { self.kicks() - 1 } else { self.kicks() }
    }

    /// The number of kicks of a step.
    pub const fn kicks(&self) -> usize {
        match self {
            KickFirst(_) | SymmetricKickFirst(_) => self.count().div_ceil(2),
            DriftFirst(_) | SymmetricDriftFirst(_) => self.count() / 2,
            SymmetricLeapfrogs(_) => self.count(),
        }
    }
}

impl Integrator for &'static SplittingTable {
    // The loop over the fractions, and a step of symplectic Euler.
    const REGISTERS: usize = 10;

    // A loop in the loop over the lanes leaves no vectors; programs of these steps have none, and are vectors.
    const BASELINE_ONLY: bool = true;

    fn evaluations(&self) -> usize {
        self.coefficients.kicks()
    }

    #[inline]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        mut state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        let coefficients = self.coefficients;
        let parity = match coefficients {
            KickFirst(_) | SymmetricKickFirst(_) => 0,
            DriftFirst(_) | SymmetricDriftFirst(_) => 1,
            SymmetricLeapfrogs(_) => return leapfrogs(coefficients, system, state, dt),
        };
        for i in 0..coefficients.count() {
            let part = dt * S::from_f64(coefficients.fraction(i));
            state = if i % 2 == parity { state.kick(system, part) } else { state.drift(part) };
        }
        state
    }
}

/// Leapfrogs one after the other; a drift between two kicks is taken at once.
fn leapfrogs<S: Scalar, const D: usize>(
    coefficients: SplittingCoefficients,
    system: &impl System<S, D>,
    mut state: State<S, D>,
    dt: S,
) -> State<S, D> {
    let mut before = 0.0;
    for i in 0..coefficients.count() {
        let fraction = coefficients.fraction(i);
        let drift = (dt * S::from_f64(before + fraction)).ratio(1, 2);
        state = state.drift(drift).kick(system, dt * S::from_f64(fraction));
        before = fraction;
    }
    state.drift((dt * S::from_f64(before)).ratio(1, 2))
}

compared_by_name!(SplittingTable);
