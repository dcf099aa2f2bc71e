//! A method on the configured oscillator, with a time step and its jitter.

use libration::analysis::{Plant, QuadraticForm, Resonance, StepNoise, UpdateMatrix};
use libration::control::{Feedback, Jitter};
use libration::number::Wide;
use libration::system::Oscillator;
use libration::{Method, State};
use libration_report::notation::{number, seconds};
use libration_study::Config;

use crate::loop_ensemble::FASTEST;

/// Nobody commands.
pub(super) const FREE: Feedback = Feedback { position: 0.0, velocity: 0.0 };

/// Below this, sums of floats leave no digits of an exponent; the formula for weak noise then is exact enough.
const TINY: f64 = 1e-9;

/// One setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Setting {
    pub(super) method: Method,
    pub(super) model: Oscillator<f64>,
    pub(super) dt: f64,
    /// The standard deviation of a step, as a part of it.
    pub(super) rms: f64,
}

/// Predictions for a setting.
#[derive(Clone, Copy, Debug)]
pub(super) struct Theory {
    pub(super) resonance: Resonance,
    /// `γ`: the mean growth of `ln |y|` in a step.
    pub(super) rate: f64,
    /// The same for weak jitter.
    pub(super) weak: f64,
    /// The invariant ellipse of the step without jitter.
    pub(super) form: QuadraticForm<f64>,
    /// By how much a longer step changes `ln det M`, for each part of its length.
    damping: f64,
}

impl Setting {
    pub(super) fn new(config: &Config, method: Method, dt: f64, rms: f64) -> Self {
        Setting { method, model: config.oscillator.system(), dt, rms }
    }

    pub(super) fn id(&self, what: &str) -> String {
        let Setting { method, dt, rms, .. } = self;
        format!("jitter.{}.dt-{dt}.rms-{rms}.{what}", method.name())
    }

    pub(super) fn text(&self, what: &str) -> String {
        let Setting { method, dt, .. } = self;
        let (dt, percent) = (seconds(*dt, 3), self.percent());
        format!("{}, Δt = {dt}, σ = {percent}: {what}", method.title())
    }

    pub(super) fn percent(&self) -> String {
        format!("{} %", number(100.0 * self.rms, 3))
    }

    pub(super) fn law(&self) -> Jitter {
        Jitter::Gaussian(self.rms)
    }

    pub(super) fn plant(&self) -> Plant<'static> {
        Plant::new(self.method, self.model, State::origin(), self.dt)
    }

    /// None where the step of mean length does not turn the state, or where that grows too fast to be followed.
    pub(super) fn theory(&self) -> Option<Theory> {
        let plant = self.plant();
        let resonance = plant.resonance(FREE)?;
        let weak = resonance.weak_growth(StepNoise::white(self.rms));
        let rate = match weak.abs() < TINY {
            true => weak,
            false => plant.lyapunov_exponent(FREE, self.law())?,
        };
        let (form, damping) = (self.form()?, self.damping());
        (rate.abs() < FASTEST).then_some(Theory { resonance, rate, weak, form, damping })
    }

    /// The derivative of `ln det M` by the part by which a step is longer.
    fn damping(&self) -> f64 {
        // What is left out is the square of this.
        let off = 1.0 / 1024.0;
        let at = |part: f64| {
            let dt = self.dt * (1.0 + part);
            UpdateMatrix::of_step(self.method, self.model, &State::origin(), dt).determinant()
        };
        (at(off) / at(-off)).ln().to_f64() / (2.0 * off)
    }

    /// The ellipse that a steady step carries along, if it does.
    pub(super) fn form(&self) -> Option<QuadraticForm<f64>> {
        let step = UpdateMatrix::of_step(self.method, self.model, &State::origin(), self.dt);
        let form = QuadraticForm::carried_by(&step);
        let form = form.map(|x: Wide| (x / form.vv).to_f64());
        (form.determinant() > 0.0).then_some(form)
    }
}

impl Theory {
    /// The variance of `ln |y|` that noise of this spectrum leaves in a step, where it is weak.
    pub(super) fn variance(&self, noise: StepNoise) -> f64 {
        let [coupling, angle] = [self.resonance.coupling, self.resonance.angle].map(Wide::to_f64);
        0.5 * coupling * coupling * noise.spectrum(2.0 * angle)
    }

    /// The standard deviation that white jitter leaves in `ln E` after a step; it grows with the root of their number.
    pub(super) fn deviation(&self, rms: f64) -> f64 {
        let walk = 4.0 * self.variance(StepNoise::white(rms));
        (walk + (self.damping * rms).powi(2)).sqrt()
    }

    /// What the terms of second order in the jitter may add to the logarithm of the energy, beside its mean: they swing
    /// with twice the angle, and are up to three times the coupling (that of velocity Verlet is `z³(1 + ε)³/4`).
    pub(super) fn unturned(&self, rms: f64) -> f64 {
        let [coupling, angle] = [self.resonance.coupling, self.resonance.angle].map(Wide::to_f64);
        3.0 * coupling.abs() * rms * rms / angle.sin()
    }

    /// By which part weak-noise theory is off.
    pub(super) fn beyond_weak(&self) -> f64 {
        (self.rate / self.weak - 1.0).abs()
    }

    /// The angle of a state on the ellipse, rising with time.
    pub(super) fn angle(&self, &State { q: [q], v: [v] }: &State<f64, 1>) -> f64 {
        let QuadraticForm { qq, qv, .. } = self.form;
        (-(v + qv * q)).atan2((qq - qv * qv).sqrt() * q)
    }

    /// By how much the logarithm of the energy swings along the ellipse.
    pub(super) fn swing(&self, omega2: f64) -> f64 {
        let ratio = |i: u32| {
            let (v, q) = (std::f64::consts::PI * f64::from(i) / 1000.0).sin_cos();
            let q = q / omega2.sqrt();
            (omega2 * q * q + v * v) / self.form.at(&State { q: [q], v: [v] })
        };
        let ratios = (0..1000).map(ratio);
        let (low, high) = ratios.fold((f64::INFINITY, 0.0_f64), |(a, b), r| (a.min(r), b.max(r)));
        (high / low).ln()
    }
}
