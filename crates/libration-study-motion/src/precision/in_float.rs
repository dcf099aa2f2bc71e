//! An integrator on the oscillator, in one float type.

use std::f64::consts::TAU;

use libration::analysis::{EnergyBand, LocalRounding, QuadraticForm, Spectrum, UpdateMatrix};
use libration::number::{TwoFloat, Wide};
use libration::system::Oscillator;
use libration::{Float, Integrator, Model, Scalar, State};
use libration_study::Config;

/// Steps of the longest stretch over which roundings are summed up: a turn, where that is no longer.
const LONGEST_STRETCH: u64 = 10_000;

/// Stretches that there are at least, so that their scatter is known to a fifth.
const STRETCHES: u64 = 64;

/// A step of an integrator on the oscillator: parameters, step and start are numbers of the float `F`.
#[derive(Clone, Copy)]
pub(super) struct InFloat<I, F> {
    method: I,
    system: Oscillator<F>,
    pub(super) dt: F,
    pub(super) start: State<F, 1>,
    /// The oscillator with the parameters that the float has.
    pub(super) model: Oscillator<f64>,
    /// The step without rounding.
    pub(super) matrix: UpdateMatrix<Wide>,
    /// The quadratic form of that step; conserved if the determinant is one.
    form: QuadraticForm<TwoFloat>,
    band: EnergyBand,
    /// Angle in rad by which an orbit turns in a step.
    pub(super) angle: f64,
}

impl<I: Integrator, F: Float> InFloat<I, F> {
    /// None where the float does not hold the setting, or where the step has no bounded orbits.
    pub(super) fn new(method: I, config: &Config, dt: f64) -> Option<Self> {
        InFloat::with_force_in::<F>(method, config, dt)
    }

    /// Returns this step with the parameter of the force rounded to another float.
    pub(super) fn with_force_in<G: Float>(method: I, config: &Config, dt: f64) -> Option<Self> {
        let rounded = |x: f64| F::from_f64(x).to_f64();
        let omega2 = config.oscillator.system().omega2;
        let model = Oscillator { omega2: G::from_f64(omega2).to_f64() };
        let at = State { q: [config.start.q], v: [config.start.v] }.map(rounded);
        let sound = |x: f64| x.is_finite() && x != 0.0;
        let energy = model.omega2 * at.q[0] * at.q[0] + at.v[0] * at.v[0];
        if ![model.omega2, rounded(dt), energy].into_iter().all(sound) {
            return None;
        }
        let matrix = UpdateMatrix::of_step(method, model, &at, rounded(dt));
        Some(InFloat {
            method,
            system: Model::<1>::on::<F>(&model),
            dt: F::from_f64(dt),
            start: at.map(F::from_f64),
            model,
            matrix,
            form: QuadraticForm::carried_by(&matrix).map(TwoFloat::from),
            band: EnergyBand::new(model, &matrix)?,
            angle: Spectrum::new(&matrix).angle().to_f64(),
        })
    }

    /// One step.
    #[inline(always)]
    pub(super) fn step(&self, state: State<F, 1>) -> State<F, 1> {
        self.method.step(&self.system, state, self.dt)
    }

    /// `z = ωΔt`.
    pub(super) fn z(&self) -> f64 {
        self.model.omega2.sqrt() * self.dt.to_f64()
    }

    /// Whether the roundings of a run have little to do with each other, in units in the last place of `2u`.
    ///
    /// Increments of neighbouring steps must differ by eight units, or they round alike: `z² ≥ 16u`. And a turn must
    /// have a dozen steps at least: an orbit that closes after a few rounds alike every time.
    pub(super) fn rounds_at_random(&self, u: f64) -> bool {
        (4.0 * u.sqrt()..=0.5).contains(&self.z())
    }

    /// The largest drift that the error of the method makes of the configured start.
    pub(super) fn truncation(&self) -> f64 {
        let (low, high) = self.band.drift_after(&self.start.map(F::to_f64), 0);
        low.abs().max(high.abs())
    }

    /// Returns the invariant of the step relative to its value at another state, minus one.
    pub(super) fn change(&self, from: &State<F, 1>, to: &State<F, 1>) -> f64 {
        let at = |state: &State<F, 1>| self.form.at(&state.map(|x| TwoFloat::from_f64(x.to_f64())));
        let before = at(from);
        (at(to) - before).to_f64() / before.to_f64()
    }

    /// A state in coordinates in which the unrounded step turns clockwise, along circles.
    pub(super) fn normal(&self, state: &State<F, 1>) -> (f64, f64) {
        let QuadraticForm { qq, qv, vv } = self.form.map(|x| x.to_f64());
        let State { q: [q], v: [v] } = state.map(F::to_f64);
        // vv·Q = (vv·v + qv·q)² + (qq·vv − qv²)·q²
        ((qq * vv - qv * qv).sqrt() * q, vv.signum() * (vv * v + qv * q))
    }

    /// `count` starts round the orbit of the configured one, and up to a thousandth within it: their roundings have
    /// nothing to do with each other.
    pub(super) fn starts(&self, count: usize) -> Vec<State<F, 1>> {
        let round = self.band.curve(&self.start.map(F::to_f64), count);
        let scaled = |(i, point): (usize, State<f64, 1>)| {
            // Multiples of the golden ratio fill an interval evenly in any order.
            let size = 1.0 - 1e-3 * (0.618_033_988_749_895 * i as f64).fract();
            point.map(|x| F::from_f64(size * x))
        };
        round.into_iter().skip(1).enumerate().map(scaled).collect()
    }

    /// The rounding of single steps, from about as many as are asked for; `W` is a much wider number.
    pub(super) fn rounding<W: Float>(&self, steps: u64) -> Option<LocalRounding> {
        let system = Model::<1>::on::<W>(&self.model);
        let dt = W::from_f64(self.dt.to_f64());
        let exact = |state| self.method.step(&system, state, dt);
        self.rounding_of(steps, |state| self.step(state), exact)
    }

    /// Returns the same for another step, with the same orbits.
    pub(super) fn rounding_of<W: Float>(
        &self,
        steps: u64,
        step: impl Fn(State<F, 1>) -> State<F, 1>,
        exact: impl Fn(State<W, 1>) -> State<W, 1>,
    ) -> Option<LocalRounding> {
        let turn = ((TAU / self.angle).round() as u64).clamp(1, LONGEST_STRETCH);
        let starts = self.starts((steps / turn).max(STRETCHES) as usize);
        let form = self.form.map(|x| W::from_f64(x.hi()) + W::from_f64(x.lo()));
        LocalRounding::over(&starts, turn, step, exact, |state| form.at(state))
    }
}
