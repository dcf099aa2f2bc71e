//! Bounds of the joint spectral radius: the worst order of steps of different lengths.

use libration_core::Scalar;
use libration_core::control::Feedback;
use libration_core::number::Wide;

use super::Plant;
use super::circular_coordinates::{CircularCoordinates, Matrix, largest_norm, norm};

/// Bounds on the growth per step of a loop whose steps have some lengths in the worst of all orders: on the joint
/// spectral radius of its steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Switching {
    /// At least this: what `word` over and over grows by. The loop can be made unstable where it is above 1.
    pub lower: f64,
    /// At most this. The loop is stable in any order where it is below 1.
    pub upper: f64,
    /// The worst order that was found: numbers of ratios, the first step first.
    pub word: Vec<usize>,
}

/// Error of the bounds.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SwitchingError {
    /// There is nothing to switch between.
    #[error("there are no step lengths to switch between")]
    Empty,
    /// A ratio is none.
    #[error("a step length is {0} of the time step; it must be a number above 0")]
    Ratio(f64),
    /// Orders of no steps, or of too many.
    #[error("the longest order has {0} steps; it must have from 1 to {MOST_STEPS}")]
    Length(u32),
    /// There are more products than can be tried.
    #[error(
        "orders of up to {length} steps of {ratios} lengths are more than {MOST_PRODUCTS}; take fewer \
         steps"
    )]
    Products {
        /// The number of step lengths.
        ratios: usize,
        /// The number of steps of the longest order.
        length: u32,
    },
    /// The steps are beyond the range of floats.
    #[error("the steps of the loop are beyond the range of floats")]
    Range,
}

/// Steps of the longest order: as many as there can be of two lengths.
const MOST_STEPS: u32 = MOST_PRODUCTS.ilog2();

/// Products that are tried at most; they take a second.
const MOST_PRODUCTS: usize = 1 << 22;

/// Above what rounding moves the size of a product by: 22 steps of four roundings each, of 10⁻¹⁶, where steps do not
/// cancel by more than a factor of a thousand.
const ROUNDING: f64 = 1e-11;

impl Plant<'_> {
    /// Bounds on the growth of the loop that `feedback` closes at once, where each step is `Δt·ratio` with any of
    /// `ratios`, from all orders of up to `length` steps.
    ///
    /// From below the largest root of a spectral radius, from above the root of the largest norm of all products of as
    /// many steps (I. Daubechies, J. C. Lagarias, *Sets of matrices all infinite products of which converge*, Linear
    /// Algebra and its Applications 161, 1992), in the elliptic norm in which the largest step is smallest.
    ///
    /// # Errors
    /// [`SwitchingError`]: ratios that are none, or too many products.
    pub fn switching(
        &self,
        feedback: Feedback,
        ratios: &[f64],
        length: u32,
    ) -> Result<Switching, SwitchingError> {
        checked(ratios, length)?;
        let step = |&ratio: &f64| {
            let step = self.closed(feedback, self.dt * Wide::from_f64(ratio));
            [0, 1].map(|i| [0, 1].map(|j| step.entry(i, j).to_f64()))
        };
        let steps: Vec<Matrix> = ratios.iter().map(step).collect();
        if !steps.iter().flatten().flatten().all(|x| x.is_finite()) {
            return Err(SwitchingError::Range);
        }
        let circle = CircularCoordinates::smallest(&steps, self.dt.to_f64());
        let steps: Vec<Matrix> = steps.into_iter().map(|step| circle.turned(step)).collect();
        let scale = largest_norm(&steps);
        if scale.is_infinite() {
            return Err(SwitchingError::Range);
        }
        if scale == 0.0 {
            return Ok(Switching { lower: 0.0, upper: 0.0, word: vec![0] });
        }
        // In units of the largest, no product is beyond the range of floats.
        let steps: Vec<Matrix> =
            steps.iter().map(|step| step.map(|row| row.map(|x| x / scale))).collect();
        let mut search = Search::new(&steps, length as usize);
        search.extend([[1.0, 0.0], [0.0, 1.0]]);
        let worst: Vec<f64> = search.word.iter().map(|&i| ratios[i]).collect();
        let lower = self.periodic_radius(feedback, &worst).to_f64();
        let roots = (1..).zip(&search.norms).map(|(n, norm)| norm.powf(1.0 / f64::from(n)));
        let upper = scale * roots.fold(f64::INFINITY, f64::min) * (1.0 + ROUNDING);
        Ok(Switching { lower, upper, word: search.word })
    }
}

fn checked(ratios: &[f64], length: u32) -> Result<(), SwitchingError> {
    if ratios.is_empty() {
        return Err(SwitchingError::Empty);
    }
    if let Some(&ratio) = ratios.iter().find(|ratio| !(ratio.is_finite() && **ratio > 0.0)) {
        return Err(SwitchingError::Ratio(ratio));
    }
    if !(1..=MOST_STEPS).contains(&length) {
        return Err(SwitchingError::Length(length));
    }
    let few = ratios.len().checked_pow(length).is_some_and(|n| n <= MOST_PRODUCTS);
    few.then_some(()).ok_or(SwitchingError::Products { ratios: ratios.len(), length })
}

/// A depth-first search over all products of up to `length` steps.
struct Search<'a> {
    steps: &'a [Matrix],
    /// The numbers of the steps that the walk has taken.
    path: Vec<usize>,
    /// The largest norm of products of each length.
    norms: Vec<f64>,
    /// The largest spectral radius to the power of one over the length, and the steps that have it.
    radius: f64,
    word: Vec<usize>,
}

impl<'a> Search<'a> {
    fn new(steps: &'a [Matrix], length: usize) -> Self {
        Search { steps, path: Vec::new(), norms: vec![0.0; length], radius: -1.0, word: Vec::new() }
    }

    fn extend(&mut self, product: Matrix) {
        let depth = self.path.len();
        for (i, step) in self.steps.iter().enumerate() {
            let longer = after(step, &product);
            self.path.push(i);
            self.norms[depth] = self.norms[depth].max(norm(&longer));
            let radius = radius(&longer).powf(1.0 / (depth as f64 + 1.0));
            // The shorter of two that are alike: a word twice over is no other.
            let shorter = self.path.len() < self.word.len();
            let margin = if shorter { -ROUNDING } else { ROUNDING };
            if radius > self.radius + margin {
                (self.radius, self.word) = (radius, self.path.clone());
            }
            if depth + 1 < self.norms.len() {
                self.extend(longer);
            }
            self.path.pop();
        }
    }
}

fn after(a: &Matrix, b: &Matrix) -> Matrix {
    [0, 1].map(|i| [0, 1].map(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

/// The spectral radius.
fn radius([[a, b], [c, d]]: &Matrix) -> f64 {
    let (half, determinant) = (0.5 * (a + d), a * d - b * c);
    // Without cancellation where the eigenvalues are close together.
    let discriminant = 0.25 * (a - d) * (a - d) + b * c;
    if discriminant < 0.0 { determinant.sqrt() } else { half.abs() + discriminant.sqrt() }
}

#[cfg(test)]
mod tests {
    use libration_batch::ensemble::{All, Execution, Loops, Setup};
    use libration_core::State;
    use libration_core::control::clock::Recorded;
    use libration_core::control::controller::StateFeedback;
    use libration_core::integrator::Rk4;
    use libration_core::system::{BaselineOnly, DampedOscillator, Oscillator};
    use proptest::prelude::*;

    use super::super::sample::{ORIGIN, all};
    use super::*;

    const MODEL: Oscillator<f64> = Oscillator { omega2: 10.0 };

    #[test]
    fn steps_that_are_stable_each_can_be_unstable_together_and_a_simulation_shows_it() {
        let feedback = Feedback { position: 40.0, velocity: 6.5 };
        let (dt, ratios) = (0.06, [1.0, 4.75]);
        let plant = Plant::new(Rk4, MODEL, ORIGIN, dt);
        for ratio in ratios {
            assert!(plant.periodic_radius(feedback, &[ratio]).to_f64() < 0.95);
        }
        let Switching { lower, upper, word } = plant.switching(feedback, &ratios, 12).unwrap();
        assert_eq!(word, [0, 1, 1]);
        assert!(1.29 < lower && lower < upper && upper < 1.294, "{lower} {upper}");
        let steps: Vec<f64> = word.iter().map(|&i| ratios[i]).collect();
        let setup = Setup::new(All(BaselineOnly(MODEL)), Rk4)
            .controller(StateFeedback::to_origin(feedback))
            .clock(Recorded::repeated(&steps));
        let start = State { q: [1.0], v: [0.0] };
        let mut simulated = Loops::new(setup, dt, 0, [0.0], &[start], Execution::serial()).unwrap();
        let mut sizes = Vec::new();
        for _ in 0..400 {
            simulated.advance(word.len() as u64).unwrap();
            sizes.push(simulated.state(0).unwrap().q[0].abs().ln());
        }
        // One real eigenvalue is the largest: behind the start the growth is even, to rounding over 600 steps.
        let rate = (sizes[399] - sizes[199]) / 600.0;
        assert!((rate - lower.ln()).abs() < 1e-13, "{rate} {}", lower.ln());
    }

    #[test]
    fn steps_that_are_stable_in_any_order_have_both_bounds_below_one() {
        let feedback = Feedback { position: 10.0, velocity: 2.0 };
        for (name, plant) in all(MODEL, 0.02) {
            let Switching { lower, upper, .. } =
                plant.switching(feedback, &[0.5, 1.0, 2.0], 6).unwrap();
            assert!(upper < 1.0, "{name} {upper}");
            // The shortest step is the slowest, and no order is slower.
            let shortest = plant.periodic_radius(feedback, &[0.5]).to_f64();
            assert!(
                (lower - shortest).abs() < 1e-10 && upper - lower < 1e-3,
                "{name} {lower} {upper}"
            );
        }
    }

    #[test]
    fn what_cannot_be_bounded_is_refused_in_words() {
        let plant = Plant::new(Rk4, MODEL, ORIGIN, 0.1);
        let refused = |ratios: &[f64], length| {
            plant.switching(Feedback::default(), ratios, length).unwrap_err().to_string()
        };
        assert!(refused(&[], 3).contains("no step lengths"));
        assert!(refused(&[1.0, -0.5], 3).contains("-0.5"));
        assert!(refused(&[1.0, f64::NAN], 3).contains("NaN"));
        assert!(refused(&[1.0], 0).contains("from 1 to 22"));
        assert!(refused(&[1.0, 2.0, 3.0], 22).contains("more than 4194304"));
        assert!(refused(&[1e200], 1).contains("range of floats"));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn any_order_grows_by_what_is_between_the_bounds(
            omega2 in 0.0..30.0_f64,
            gamma in -0.5..1.5_f64,
            dt in 0.002..0.4_f64,
            position in -3.0..40.0_f64,
            velocity in -1.0..8.0_f64,
            ratios in prop::collection::vec(0.2..4.0_f64, 1..4),
            order in prop::collection::vec(0..3_usize, 1..40),
            which in 0..10_usize,
        ) {
            let plants = all(DampedOscillator { omega2, gamma }, dt);
            let (_, plant) = &plants[which % plants.len()];
            let feedback = Feedback { position, velocity };
            let of = |length| plant.switching(feedback, &ratios, length).unwrap();
            let (short, long) = (of(2), of(6));
            for Switching { lower, upper, word } in [&short, &long] {
                prop_assert!(lower <= upper, "{} {}", lower, upper);
                let worst: Vec<f64> = word.iter().map(|&i| ratios[i]).collect();
                prop_assert_eq!(plant.periodic_radius(feedback, &worst).to_f64(), *lower);
            }
            // Longer orders see more. Of two words that rounding does not tell apart the shorter is taken.
            prop_assert!(long.upper <= short.upper && long.lower >= short.lower * (1.0 - 1e-9));
            let order: Vec<f64> = order.iter().map(|i| ratios[i % ratios.len()]).collect();
            prop_assert!(plant.periodic_radius(feedback, &order).to_f64() <= long.upper);
        }
    }
}
