//! The oscillator itself, before any step.

use libration::analysis::{Eigenvalues, Spectrum, UpdateMatrix};
use libration::{Float, State};
use libration_report::record::{Finding, Record, Tolerance};
use libration_study::Config;

/// The eigenvalues of the rate of change, which duals read off the shipped force.
pub(super) fn eigenvalues(config: &Config, record: &mut Record) {
    let start = State { q: [config.start.q], v: [config.start.v] };
    let oscillator = config.oscillator.system();
    let rates = UpdateMatrix::of_rates(oscillator, &start);
    let (re, im) = match Spectrum::new(&rates).eigenvalues {
        Eigenvalues::Complex { re, im } => (re.to_f64(), im.to_f64()),
        Eigenvalues::Real(larger, _) => (larger.to_f64(), 0.0),
        Eigenvalues::Double { value, .. } => (value.to_f64(), 0.0),
    };
    record.find(Finding::predicted(
        "spectrum.oscillator.growth",
        "the oscillator itself: real part of its eigenvalues, from duals through the shipped force",
        "1/s",
        0.0,
        re,
        Tolerance::exact("nothing is rounded"),
    ));
    record.find(Finding::predicted(
        "spectrum.oscillator.frequency",
        "the oscillator itself: imaginary part of its eigenvalues, beside √(k/m)",
        "rad/s",
        (config.oscillator.k / config.oscillator.m).sqrt(),
        im,
        Tolerance::relative(2.0 * f64::UNIT_ROUNDOFF, "one rounding of k/m and one of the root"),
    ));
}
