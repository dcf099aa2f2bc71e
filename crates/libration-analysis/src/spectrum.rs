//! The eigenvalues of a `2 × 2` matrix, in closed form and without cancellation.

use libration_core::number::Wide;
use libration_core::{Elementary, Scalar};

use super::{SymbolicStep, UpdateMatrix};

/// Differences below this many bits under the leading one are rounding: 1024 bits carry each
/// operation to `2⁻¹⁰²⁰`, and a step takes far fewer than `2¹²⁰` of them.
const ROUNDING_BITS: i64 = 900;

/// The long-term behaviour of a `2 × 2` matrix: its eigenvalues.
#[derive(Clone, Copy, Debug)]
pub struct Spectrum {
    /// Sum of the eigenvalues.
    pub trace: Wide,
    /// Product of the eigenvalues: the factor by which areas grow.
    pub determinant: Wide,
    /// The eigenvalues.
    pub eigenvalues: Eigenvalues,
    /// The determinant minus one, without cancellation where it is known so.
    excess: Wide,
    /// Whether the matrix takes a velocity to a negative position, as a rotation does by more than
    /// half a turn.
    beyond_half_a_turn: bool,
}

/// The two eigenvalues of a real `2 × 2` matrix.
#[derive(Clone, Copy, Debug)]
pub enum Eigenvalues {
    /// `re ± i·im` with `im > 0`: a rotation with growth or decay.
    Complex {
        /// Real part.
        re: Wide,
        /// Imaginary part of the upper one.
        im: Wide,
    },
    /// Two real ones, the larger first: a stretching.
    Real(Wide, Wide),
    /// One real eigenvalue twice.
    Double {
        /// The eigenvalue.
        value: Wide,
        /// Whether it has but one eigenvector, so that powers grow linearly on top of `|λ|ⁿ`.
        defective: bool,
    },
}

impl Eigenvalues {
    /// `half ± √discriminant`, whose product is `determinant`.
    fn new(half: Wide, discriminant: Wide, determinant: Wide, defective: bool) -> Self {
        if discriminant.is_zero() {
            return Eigenvalues::Double { value: half, defective };
        }
        if discriminant.is_negative() {
            return Eigenvalues::Complex { re: half, im: (-discriminant).sqrt() };
        }
        let root = discriminant.sqrt();
        // The sum does not cancel for the one of the larger size; the other follows from the product.
        if half.is_negative() {
            let smaller = half - root;
            Eigenvalues::Real(determinant / smaller, smaller)
        } else {
            let larger = half + root;
            Eigenvalues::Real(larger, determinant / larger)
        }
    }
}

impl Spectrum {
    /// The spectrum of `matrix`.
    pub fn new(matrix: &UpdateMatrix<Wide>) -> Self {
        let (trace, determinant) = (matrix.trace(), matrix.determinant());
        let half = trace.ratio(1, 2);
        let unless_rounding = |x: Wide, scale| if negligible(x, scale) { Wide::ZERO } else { x };
        let discriminant = unless_rounding(half * half - determinant, half * half);
        let off_diagonal = [matrix.entry(0, 1), matrix.entry(1, 0)];
        let defective = off_diagonal.iter().any(|x| !x.is_zero());
        Spectrum {
            trace,
            determinant,
            eigenvalues: Eigenvalues::new(half, discriminant, determinant, defective),
            excess: unless_rounding(determinant - Wide::one(), Wide::one()),
            beyond_half_a_turn: matrix.entry(0, 1).is_negative(),
        }
    }

    /// The spectrum of a step on the oscillator at `z = ωΔt`, from its polynomials: what cancels at
    /// very small or large `z` has cancelled exactly, before anything is rounded.
    pub fn of_polynomials(step: &SymbolicStep, z: Wide) -> Option<Self> {
        let (trace, determinant) = (step.trace(), step.determinant());
        let discriminant = ((trace * trace).ratio(1, 4) - determinant).checked()?.eval_wide(z);
        let excess = (determinant - Scalar::one()).checked()?.eval_wide(z);
        let (trace, determinant) = (trace.eval_wide(z), excess + Wide::one());
        let off_diagonal =
            [step.matrix.entry(0, 1), step.matrix.entry(1, 0)].map(|p| p.eval_wide(z));
        let defective = off_diagonal.iter().any(|x| !x.is_zero());
        let half = trace.ratio(1, 2);
        let eigenvalues = Eigenvalues::new(half, discriminant, determinant, defective);
        let beyond_half_a_turn = off_diagonal[0].is_negative();
        Some(Spectrum { trace, determinant, eigenvalues, excess, beyond_half_a_turn })
    }

    /// The angle in rad by which the matrix turns the plane of `(q, v)` from `v` towards `q`, as the
    /// flow of an oscillator does: of those that differ by whole turns, the one nearest to `near`.
    pub fn turn(&self, near: Wide) -> Wide {
        let angle = self.angle();
        let angle = if self.beyond_half_a_turn { -angle } else { angle };
        let whole = Wide::pi().scaled(1);
        let turns = ((near - angle) / whole).to_f64().round();
        angle + whole * Wide::from_f64(turns)
    }

    /// The determinant minus one; zero where it differs from one by rounding only.
    pub fn determinant_minus_one(&self) -> Wide {
        self.excess
    }

    /// The largest absolute value of an eigenvalue.
    pub fn radius(&self) -> Wide {
        match self.eigenvalues {
            Eigenvalues::Complex { .. } => self.determinant.sqrt(),
            Eigenvalues::Real(larger, smaller) => {
                if larger.abs() > smaller.abs() {
                    larger.abs()
                } else {
                    smaller.abs()
                }
            }
            Eigenvalues::Double { value, .. } => value.abs(),
        }
    }

    /// The spectral radius minus one; zero where it differs from one by rounding only.
    pub fn radius_minus_one(&self) -> Wide {
        if let Eigenvalues::Complex { .. } = self.eigenvalues {
            // √(1 + e) − 1
            return self.excess / (self.determinant.sqrt() + Wide::one());
        }
        let difference = self.radius() - Wide::one();
        if negligible(difference, Wide::one()) { Wide::ZERO } else { difference }
    }

    /// Whether powers of the matrix stay bounded: no eigenvalue outside the unit circle, and none
    /// on it that is defective.
    pub fn is_bounded(&self) -> bool {
        let excess = self.radius_minus_one();
        let defective = matches!(self.eigenvalues, Eigenvalues::Double { defective: true, .. });
        excess.is_negative() || (excess.is_zero() && !defective)
    }

    /// The angle of the upper eigenvalue, in `[0, π]` rad.
    pub fn angle(&self) -> Wide {
        match self.eigenvalues {
            Eigenvalues::Complex { re, im } => im.atan2(re),
            Eigenvalues::Real(x, _) | Eigenvalues::Double { value: x, .. } => {
                if x.is_negative() {
                    Wide::pi()
                } else {
                    Wide::ZERO
                }
            }
        }
    }
}

/// Whether `x` is nothing but rounding beside `scale`.
pub(super) fn negligible(x: Wide, scale: Wide) -> bool {
    match (x.exponent(), scale.exponent()) {
        (None, _) => true,
        (Some(x), Some(scale)) => x < scale - ROUNDING_BITS,
        (Some(_), None) => false,
    }
}
