//! The peak rate of independent multiplications and additions.

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

    /// Runs so many rounds on `vectors` vectors of lanes; what comes out is of no use, but must not be lost.
    pub(crate) fn run<T: Float>(self, set: InstructionSet, vectors: usize, rounds: u64) -> f64 {
        match (self.multiplications, self.additions) {
            (3, 2) => on_vectors::<T, 3, 2>(set, vectors, rounds),
            (4, 3) => on_vectors::<T, 4, 3>(set, vectors, rounds),
            (2, 3) => on_vectors::<T, 2, 3>(set, vectors, rounds),
            _ => on_vectors::<T, 1, 1>(set, vectors, rounds),
        }
    }
}

/// The numbers of vectors at which a mix may be fastest: enough to hide the latency of an operation, and no more than the registers hold
/// beside what is multiplied by and added.
pub(crate) const VECTORS: [usize; 2] = [12, 14];

/// Independent values, which are multiplied `M` times and added to `A` times in every round: one for each lane of `N` vectors.
struct Independent<T, const M: usize, const A: usize, const N: usize> {
    factor: T,
    term: T,
    rounds: u64,
}

impl<T: Float, const M: usize, const A: usize, const N: usize> Loop for Independent<T, M, A, N> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        self.lanes::<1, N>()
    }

    #[inline(always)]
    fn run_on(self, vector_bytes: usize) -> f64 {
        // One operand for all lanes becomes a vector by itself, but not where two lanes are one.
        match (N, vector_bytes / size_of::<T>()) {
            (12, 2) => self.lanes::<2, 12>(),
            (14, 2) => self.lanes::<2, 14>(),
            (12, 4) => self.lanes::<1, 48>(),
            (14, 4) => self.lanes::<1, 56>(),
            (12, 8) => self.lanes::<1, 96>(),
            (14, 8) => self.lanes::<1, 112>(),
            (12, 16) => self.lanes::<1, 192>(),
            (14, 16) => self.lanes::<1, 224>(),
            _ => f64::NAN,
        }
    }
}

impl<T: Float, const M: usize, const A: usize, const N: usize> Independent<T, M, A, N> {
    /// The rounds on `L·V` lanes, whose operands come as `L` equal numbers.
    #[inline(always)]
    fn lanes<const L: usize, const V: usize>(self) -> f64 {
        let (factor, term) = ([self.factor; L], [self.term; L]);
        let mut values = [[T::one(); L]; V];
        for _ in 0..self.rounds {
            for vector in &mut values {
                for l in 0..L {
                    for i in 0..const { if M > A { M } else { A } } {
                        vector[l] = if i < M { vector[l] * factor[l] } else { vector[l] };
                        vector[l] = if i < A { vector[l] + term[l] } else { vector[l] };
                    }
                }
            }
        }
        values.iter().flatten().fold(0.0, |sum, x| sum + x.to_f64())
    }
}

fn on_vectors<T: Float, const M: usize, const A: usize>(
    set: InstructionSet,
    vectors: usize,
    rounds: u64,
) -> f64 {
    // Numbers that stay what they are, but that the compiler does not know.
    let (factor, term) = (std::hint::black_box(T::one()), std::hint::black_box(T::zero()));
    match vectors {
        12 => set.vectorize(Independent::<T, M, A, 12> { factor, term, rounds }),
        14 => set.vectorize(Independent::<T, M, A, 14> { factor, term, rounds }),
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use libration::Integrator;
    use libration::ensemble::InstructionSet;
    use libration::integrator::{Rk4, SymplecticEuler, VelocityVerlet};
    use libration::system::Oscillator;

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
    fn every_number_of_vectors_that_is_offered_can_be_run() {
        for set in InstructionSet::available() {
            for mix in Mix::KNOWN {
                for vectors in VECTORS {
                    // All values stay 1, and there is one for each lane.
                    let bytes = vectors * set.vector_bytes();
                    assert_eq!(
                        mix.run::<f32>(set, vectors, 10),
                        (bytes / 4) as f64,
                        "{set:?} {mix:?}"
                    );
                    assert_eq!(
                        mix.run::<f64>(set, vectors, 10),
                        (bytes / 8) as f64,
                        "{set:?} {mix:?}"
                    );
                }
            }
        }
    }
}
