//! The rate of independent multiplications and additions: as fast as this processor computes.

use libration::Float;
use libration::analysis::{DataFlow, Operation};
use libration::ensemble::{InstructionSet, Loop};

/// Multiplications for each so many additions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Mix {
    pub(crate) multiplications: usize,
    pub(crate) additions: usize,
}

impl Mix {
    /// The proportions for which there are loops.
    const KNOWN: [Mix; 4] = [Mix::new(3, 2), Mix::new(4, 3), Mix::new(2, 3), Mix::new(1, 1)];

    const fn new(multiplications: usize, additions: usize) -> Mix {
        Mix { multiplications, additions }
    }

    /// The known proportion that is nearest to that of a step.
    pub(crate) fn of(step: &DataFlow) -> Mix {
        let share = |m: usize, a: usize| m as f64 / (m + a) as f64;
        let [m, a] = [Operation::Multiplication, Operation::Addition].map(|op| step.count(op));
        let off = |mix: &Mix| (share(mix.multiplications, mix.additions) - share(m, a)).abs();
        Mix::KNOWN.into_iter().min_by(|x, y| off(x).total_cmp(&off(y))).unwrap_or(Mix::new(1, 1))
    }

    /// Operations in one round of this mix, for each lane.
    pub(crate) fn operations(self) -> usize {
        self.multiplications + self.additions
    }

    /// Runs so many rounds on `width` lanes; what comes out is of no use, but must not be lost.
    pub(crate) fn run<T: Float>(self, set: InstructionSet, width: usize, rounds: u64) -> f64 {
        match (self.multiplications, self.additions) {
            (3, 2) => on_width::<T, 3, 2>(set, width, rounds),
            (4, 3) => on_width::<T, 4, 3>(set, width, rounds),
            (2, 3) => on_width::<T, 2, 3>(set, width, rounds),
            _ => on_width::<T, 1, 1>(set, width, rounds),
        }
    }
}

/// The widths, in lanes, at which a mix may be fastest: one value for each lane and each operation of the
/// mix, from a vector each up to twice as many as there are registers.
pub(crate) fn widths<T>(set: InstructionSet, mix: Mix) -> impl Iterator<Item = usize> {
    let lanes = set.vector_bytes() / size_of::<T>();
    let most = 2 * set.registers() / mix.operations();
    WIDTHS.into_iter().filter(move |width| width % lanes == 0 && width / lanes <= most)
}

const WIDTHS: [usize; 16] = [4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48, 64, 80, 96, 128, 160];

/// `M` values that are multiplied and `A` that are added to in every round, for each of `W` lanes.
struct Independent<T, const M: usize, const A: usize, const W: usize> {
    factor: T,
    term: T,
    rounds: u64,
}

impl<T: Float, const M: usize, const A: usize, const W: usize> Loop for Independent<T, M, A, W> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let mut products = [[T::one(); W]; M];
        let mut sums = [[T::one(); W]; A];
        for _ in 0..self.rounds {
            for l in 0..W {
                for product in &mut products {
                    product[l] = product[l] * self.factor;
                }
                for sum in &mut sums {
                    sum[l] = sum[l] + self.term;
                }
            }
        }
        let all = products.iter().chain(&sums).flatten();
        all.fold(0.0, |sum, x| sum + x.to_f64())
    }
}

fn on_width<T: Float, const M: usize, const A: usize>(
    set: InstructionSet,
    width: usize,
    rounds: u64,
) -> f64 {
    // Numbers that stay what they are, but that the compiler does not know.
    let factor = std::hint::black_box(T::one());
    let term = std::hint::black_box(T::zero());
    macro_rules! widths {
        ($($w:literal)*) => {
            match width {
                $($w => set.vectorize(Independent::<T, M, A, $w> { factor, term, rounds }),)*
                _ => f64::NAN,
            }
        };
    }
    widths!(4 6 8 10 12 16 20 24 32 40 48 64 80 96 128 160)
}

#[cfg(test)]
mod tests {
    use libration::integrator::{Rk4, SymplecticEuler, VelocityVerlet};
    use libration::system::Oscillator;
    use libration::{Integrator, ensemble::InstructionSet};

    use super::*;

    fn mix(integrator: impl Integrator) -> Mix {
        Mix::of(&DataFlow::of_step::<_, 1>(integrator, &Oscillator { omega2: 10.0 }, 1e-3))
    }

    #[test]
    fn the_methods_that_are_judged_have_loops_of_exactly_their_proportion() {
        assert_eq!(mix(SymplecticEuler), Mix::new(3, 2));
        assert_eq!(mix(VelocityVerlet), Mix::new(4, 3));
        // Twelve and eighteen.
        assert_eq!(mix(Rk4), Mix::new(2, 3));
    }

    #[test]
    fn every_width_that_is_offered_can_be_run() {
        for set in InstructionSet::available() {
            for mix in Mix::KNOWN {
                let offered: Vec<usize> = widths::<f32>(set, mix).collect();
                assert!(!offered.is_empty(), "{set:?} {mix:?}");
                for width in offered {
                    // All values stay 1, and there is one for each lane and operation.
                    let sum = mix.run::<f32>(set, width, 10);
                    assert_eq!(sum, (width * mix.operations()) as f64);
                }
                for width in widths::<f64>(set, mix) {
                    assert_eq!(mix.run::<f64>(set, width, 10), (width * mix.operations()) as f64);
                }
            }
        }
    }
}
