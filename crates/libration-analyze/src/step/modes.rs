//! Eigenvalues of a step, and phase errors of its modes.

use core::f64::consts::PI;

use libration::analysis::{
    Complex, Eigenvalues, Linearisation, Spectrum, UpdateMatrix, determinant, eigenvalues,
};
use libration::number::Wide;
use libration::{Elementary, Scalar};

/// Differences from one below this are rounding of the 1024 bits, amplified by a double root.
const ROUNDING: f64 = 1e-50;

/// The eigenvalues of one step, and numbers derived from them.
pub(crate) struct Modes {
    values: Vec<Complex>,
    pub(crate) determinant: Wide,
    pub(crate) determinant_minus_one: Wide,
    pub(crate) radius: Wide,
    pub(crate) radius_minus_one: Wide,
    /// Whether powers of the matrix stay bounded; unknown for coupled, marginal modes.
    pub(crate) bounded: Option<bool>,
    /// The largest phase error of a mode, in rad; none if no mode oscillates.
    pub(crate) phase_error: Option<Wide>,
    /// The Frobenius norm of `MᵀJM − J`.
    pub(crate) symplecticity_defect: Wide,
}

impl Modes {
    /// The modes of a step; `exact` is the spectrum of each, if it is known without cancellation.
    pub(crate) fn new(linear: &Linearisation, exact: Option<Spectrum>) -> Self {
        let spectrum = |block: UpdateMatrix<Wide>| exact.unwrap_or_else(|| Spectrum::new(&block));
        match linear.step.decoupled() {
            Some(blocks) => {
                let spectra: Vec<Spectrum> = blocks.into_iter().map(spectrum).collect();
                Modes::decoupled(linear, &spectra)
            }
            None => Modes::coupled(linear),
        }
    }

    /// The modes of decoupled degrees of freedom, in closed form.
    fn decoupled(linear: &Linearisation, spectra: &[Spectrum]) -> Self {
        let excess = largest(spectra.iter().map(Spectrum::radius_minus_one));
        let frequency = |block: &UpdateMatrix<Wide>| match Spectrum::new(block).eigenvalues {
            Eigenvalues::Complex { im, .. } => Some(im),
            _ => None,
        };
        let blocks = linear.generator.decoupled().unwrap_or_default();
        let errors = spectra.iter().zip(blocks.iter().map(frequency));
        let excesses = || spectra.iter().map(Spectrum::determinant_minus_one);
        // (1 + a)(1 + b) − 1; and MᵀJM − J of a block is its excess times J.
        let difference = excesses().fold(Wide::ZERO, |a, b| a + b + a * b);
        let defect = excesses().fold(Wide::ZERO, |sum, e| sum + (e * e).scaled(1)).sqrt();
        Modes {
            values: spectra.iter().flat_map(pair).collect(),
            determinant: spectra.iter().fold(Wide::one(), |product, s| product * s.determinant),
            determinant_minus_one: difference,
            symplecticity_defect: defect,
            radius: largest(spectra.iter().map(Spectrum::radius)),
            radius_minus_one: excess,
            bounded: Some(spectra.iter().all(Spectrum::is_bounded)),
            phase_error: errors
                .filter_map(|(s, omega)| {
                    let exact = omega? * linear.dt;
                    let turns = !matches!(s.eigenvalues, Eigenvalues::Real(..));
                    turns.then(|| difference_of(s.turn(exact), exact))
                })
                .reduce(larger_size),
        }
    }

    /// The modes of coupled degrees of freedom.
    fn coupled(linear: &Linearisation) -> Self {
        let values = eigenvalues(&linear.step);
        let radius = largest(values.iter().map(|z| z.abs()));
        let radius_minus_one = unless_rounding(radius - Wide::one());
        let turning = |angles: Vec<Wide>| {
            let mut angles: Vec<Wide> =
                angles.into_iter().filter(|a| a.to_f64() > ROUNDING).collect();
            angles.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
            angles
        };
        let numeric = turning(values.iter().map(|z| z.arg()).collect());
        let exact =
            turning(eigenvalues(&linear.generator).iter().map(|z| z.im * linear.dt).collect());
        // Modes correspond by the order of their frequencies.
        let comparable = numeric.len() == exact.len();
        let errors = numeric.iter().zip(&exact).map(|(&n, &e)| n - e);
        let product = determinant(&linear.step);
        let values: Vec<Complex> =
            values.iter().map(|z| Complex { re: z.re, im: unless_rounding(z.im) }).collect();
        Modes {
            determinant: product,
            determinant_minus_one: unless_rounding(product - Wide::one()),
            symplecticity_defect: linear.step.symplecticity_defect(),
            radius,
            radius_minus_one,
            bounded: (!radius_minus_one.is_zero()).then(|| radius_minus_one.is_negative()),
            phase_error: if comparable { errors.reduce(larger_size) } else { None },
            values,
        }
    }

    /// The phase error in rad, of steps that follow the oscillation.
    pub(crate) fn followed_phase_error(&self) -> Option<f64> {
        self.phase_error.map(Wide::to_f64).filter(|_| !self.loses_oscillation())
    }

    /// Whether the phase error is more than half a turn, or no number: beyond the digits of a step, nothing is left of an angle.
    pub(crate) fn loses_oscillation(&self) -> bool {
        self.phase_error.map(Wide::to_f64).is_some_and(|error| error.is_nan() || error.abs() > PI)
    }

    /// The eigenvalues as pairs of real and imaginary part.
    pub(crate) fn eigenvalues(&self) -> Vec<[f64; 2]> {
        self.values.iter().map(|z| [z.re.to_f64(), z.im.to_f64()]).collect()
    }
}

/// The spectral radius of an exact step minus one, `exp(max Re λ·Δt) − 1` of the generator's eigenvalues `λ`.
pub(crate) fn flow_radius_minus_one(linear: &Linearisation) -> f64 {
    let rates = largest(eigenvalues(&linear.generator).iter().map(|z| z.re));
    unless_rounding(rates * linear.dt).to_f64().exp_m1()
}

fn pair(spectrum: &Spectrum) -> [Complex; 2] {
    match spectrum.eigenvalues {
        Eigenvalues::Complex { re, im } => [Complex { re, im }, Complex { re, im: -im }],
        Eigenvalues::Real(a, b) => [a, b].map(real),
        Eigenvalues::Double { value, .. } => [real(value); 2],
    }
}

fn real(re: Wide) -> Complex {
    Complex { re, im: Wide::ZERO }
}

/// `a − b`, or zero if the difference is below the rounding of 1024 bits. A phase error is at least of third
/// order, and below every `f64` if its ratio to the angle is below 2⁻⁹⁰⁰.
fn difference_of(a: Wide, b: Wide) -> Wide {
    let difference = a - b;
    match (difference.exponent(), b.exponent()) {
        (Some(left), Some(of)) if left < of - 900 => Wide::ZERO,
        _ => difference,
    }
}

/// A difference from one, or zero if it is rounding.
pub(crate) fn unless_rounding(x: Wide) -> Wide {
    if x.abs().to_f64() < ROUNDING { Wide::ZERO } else { x }
}

fn larger_size(a: Wide, b: Wide) -> Wide {
    if b.abs() > a.abs() { b } else { a }
}

fn largest(values: impl Iterator<Item = Wide>) -> Wide {
    values.reduce(|a, b| if b > a { b } else { a }).unwrap_or(Wide::ZERO)
}
