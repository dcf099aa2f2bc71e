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

/// The widths, in lanes, at which a mix may be fastest: with enough vectors to hide the latency of an operation,
/// and no more than the registers hold beside what is multiplied by and added.
pub(crate) fn widths<T>(set: InstructionSet) -> impl Iterator<Item = usize> {
    let lanes = set.vector_bytes() / size_of::<T>();
    [12, 14].into_iter().map(move |vectors| vectors * lanes)
}

/// One value for each of `L·V` lanes, which is multiplied `M` times and added to `A` times in every round. The operands
/// come as `L` equal numbers.
struct Independent<T, const M: usize, const A: usize, const L: usize, const V: usize> {
    factor: [T; L],
    term: [T; L],
    rounds: u64,
}

impl<T: Float, const M: usize, const A: usize, const L: usize, const V: usize> Loop
    for Independent<T, M, A, L, V>
{
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let Independent { factor, term, rounds } = self;
        let mut values = [[T::one(); L]; V];
        for _ in 0..rounds {
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

fn on_width<T: Float, const M: usize, const A: usize>(
    set: InstructionSet,
    width: usize,
    rounds: u64,
) -> f64 {
    // Numbers that stay what they are, but that the compiler does not know.
    let factor = std::hint::black_box(T::one());
    let term = std::hint::black_box(T::zero());
    macro_rules! widths {
        ($($w:literal = $l:literal x $v:literal)*) => {
            match width {
                $($w => set.vectorize(Independent::<T, M, A, $l, $v> {
                    factor: [factor; $l],
                    term: [term; $l],
                    rounds,
                }),)*
                _ => f64::NAN,
            }
        };
    }
    // One operand for all lanes becomes a vector by itself, but not where two lanes are one.
    widths!(24 = 2 x 12  28 = 2 x 14  48 = 1 x 48  56 = 1 x 56
        96 = 1 x 96  112 = 1 x 112  192 = 1 x 192  224 = 1 x 224)
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
    fn every_width_that_is_offered_can_be_run() {
        for set in InstructionSet::available() {
            for mix in Mix::KNOWN {
                // All values stay 1, and there is one for each lane.
                for width in widths::<f32>(set) {
                    assert_eq!(mix.run::<f32>(set, width, 10), width as f64, "{set:?} {mix:?}");
                }
                for width in widths::<f64>(set) {
                    assert_eq!(mix.run::<f64>(set, width, 10), width as f64, "{set:?} {mix:?}");
                }
            }
        }
    }
}
