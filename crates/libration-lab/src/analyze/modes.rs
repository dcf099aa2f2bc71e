//! The eigenvalues of a step, and how its modes turn beside those of the system.

use libration::Scalar;
use libration::analysis::{
    Complex, Eigenvalues, Linearisation, Spectrum, determinant, eigenvalues,
};
use libration::number::Wide;

/// Differences from one below this are rounding of the 1024 bits, amplified by a double root.
const ROUNDING: f64 = 1e-50;

/// What the eigenvalues of one step say.
pub(super) struct Modes {
    values: Vec<Complex>,
    pub(super) determinant_minus_one: Wide,
    pub(super) radius: Wide,
    pub(super) radius_minus_one: Wide,
    /// Whether powers of the matrix stay bounded; unknown where modes are coupled and marginal.
    pub(super) bounded: Option<bool>,
    /// The largest phase error of a mode, in rad; none where nothing oscillates.
    pub(super) phase_error: Option<Wide>,
}

impl Modes {
    pub(super) fn new<const D: usize>(linear: &Linearisation<D>) -> Self {
        match linear.step.decoupled() {
            Some(blocks) => Modes::decoupled(linear, &blocks.map(|block| Spectrum::new(&block))),
            None => Modes::coupled(linear),
        }
    }

    /// Each degree of freedom by itself, in closed form.
    fn decoupled<const D: usize>(linear: &Linearisation<D>, spectra: &[Spectrum; D]) -> Self {
        let excess = largest(spectra.iter().map(Spectrum::radius_minus_one));
        let frequencies = linear.generator.decoupled().map(|blocks| {
            blocks.map(|block| match Spectrum::new(&block).eigenvalues {
                Eigenvalues::Complex { im, .. } => Some(im),
                _ => None,
            })
        });
        let errors = spectra.iter().zip(frequencies.into_iter().flatten());
        let product = spectra.iter().fold(Wide::one(), |product, s| product * s.determinant);
        let difference = match spectra.as_slice() {
            [only] => only.determinant_minus_one(),
            _ => unless_rounding(product - Wide::one()),
        };
        Modes {
            values: spectra.iter().flat_map(pair).collect(),
            determinant_minus_one: difference,
            radius: largest(spectra.iter().map(Spectrum::radius)),
            radius_minus_one: excess,
            bounded: Some(spectra.iter().all(Spectrum::is_bounded)),
            phase_error: errors
                .filter_map(|(s, omega)| Some(s.angle() - omega? * linear.dt))
                .reduce(larger_size),
        }
    }

    /// All degrees of freedom at once.
    fn coupled<const D: usize>(linear: &Linearisation<D>) -> Self {
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
        // Modes are told apart by the order of their frequencies.
        let comparable = numeric.len() == exact.len();
        let errors = numeric.iter().zip(&exact).map(|(&n, &e)| n - e);
        Modes {
            determinant_minus_one: unless_rounding(determinant(&linear.step) - Wide::one()),
            radius,
            radius_minus_one,
            bounded: (!radius_minus_one.is_zero()).then(|| radius_minus_one.is_negative()),
            phase_error: if comparable { errors.reduce(larger_size) } else { None },
            values,
        }
    }

    /// The eigenvalues as pairs of real and imaginary part.
    pub(super) fn eigenvalues(&self) -> Vec<[f64; 2]> {
        let shown = |x: Wide| unless_rounding(x).to_f64();
        self.values.iter().map(|z| [z.re.to_f64(), shown(z.im)]).collect()
    }
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

fn unless_rounding(x: Wide) -> Wide {
    if x.abs().to_f64() < ROUNDING { Wide::ZERO } else { x }
}

fn larger_size(a: Wide, b: Wide) -> Wide {
    if b.abs() > a.abs() { b } else { a }
}

fn largest(values: impl Iterator<Item = Wide>) -> Wide {
    values.reduce(|a, b| if b > a { b } else { a }).unwrap_or(Wide::ZERO)
}
