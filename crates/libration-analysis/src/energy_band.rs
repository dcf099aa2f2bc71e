//! The range of energies of an orbit of a linear step.

use libration_core::number::Wide;
use libration_core::{Elementary, Hamiltonian, Model, Scalar, State};

use super::{QuadraticForm, UpdateMatrix};

/// The band of energies of the orbits of a linear step in one dimension.
///
/// Every `2 × 2` matrix `M` carries a quadratic form along: `Q(y) = −yᵀJMy` has
/// `Q(My) = det M · Q(y)`, because `MᵀJM = det M · J`. For a symplectic step it is the modified
/// Hamiltonian. Where `Q` is definite, an orbit is caught between two multiples of it, and so
/// `E_n/E₀` lies between `det Mⁿ · r₋/r₀` and `det Mⁿ · r₊/r₀`, with `r = E/Q` and its extremes
/// `r₋ ≤ r₊` over all states.
#[derive(Clone, Copy, Debug)]
pub struct EnergyBand {
    growth: Wide,
    energy: QuadraticForm<Wide>,
    invariant: QuadraticForm<Wide>,
    lowest: Wide,
    highest: Wide,
}

impl EnergyBand {
    /// The band of `step` on `model`; none where no form is definite, so that orbits escape.
    pub fn new(model: impl Model<1>, step: &UpdateMatrix<Wide>) -> Option<Self> {
        let system = model.on::<Wide>();
        let energy = QuadraticForm::of(|state| system.energy(state));
        let form = QuadraticForm::carried_by(step);
        // A step that turns by more than half a turn carries a negative form; its negative serves.
        let invariant = if form.vv.is_negative() { form.map(|c| -c) } else { form };
        let a = invariant.determinant();
        if a.is_zero() || a.is_negative() {
            return None;
        }
        // det(E − rQ) = a·r² − 2b·r + c, with two real roots since both forms are definite.
        let b = energy.mixed(&invariant);
        let discriminant = b * b - a * energy.determinant();
        let root = if discriminant.is_negative() { Wide::ZERO } else { discriminant.sqrt() };
        Some(EnergyBand {
            growth: step.determinant(),
            energy,
            invariant,
            lowest: (b - root) / a,
            highest: (b + root) / a,
        })
    }

    /// The lowest and highest relative energy drift that an orbit from `start` can have after `n`
    /// steps. Far outside the range of `f64` it is infinite.
    pub fn drift_after(&self, start: &State<f64, 1>, n: u64) -> (f64, f64) {
        let start = start.map(Wide::from_f64);
        let scale = self.growth.powi(n) * self.invariant.at(&start) / self.energy.at(&start);
        let drift = |r: Wide| (scale * r - Wide::one()).to_f64();
        (drift(self.lowest), drift(self.highest))
    }

    /// The largest drift of `|E_n − E₀|/E₀` over all starts, after `n` steps.
    pub fn worst_drift_after(&self, n: u64) -> f64 {
        let growth = self.growth.powi(n);
        let up = (growth * self.highest / self.lowest - Wide::one()).to_f64();
        let down = (Wide::one() - growth * self.lowest / self.highest).to_f64();
        up.max(down)
    }

    /// The start from which the energy rises most, with `q² + v²/ω² = 1` for the oscillator's `ω`;
    /// none if all starts are alike.
    pub fn worst_start(&self) -> Option<State<f64, 1>> {
        let r = self.lowest;
        let singular = self.energy.plus(-r, &self.invariant);
        let alike = (self.highest - self.lowest).to_f64() <= 1e-100 * self.highest.to_f64();
        // The null vector of a singular 2 × 2 form, from its larger row.
        let (q, v) = if singular.qq.abs() > singular.vv.abs() {
            (-singular.qv, singular.qq)
        } else {
            (singular.vv, -singular.qv)
        };
        let size = (q * q + v * v * self.energy.vv / self.energy.qq).sqrt();
        (!alike).then(|| State { q: [(q / size).to_f64()], v: [(v / size).to_f64()] })
    }

    /// Points on the curve `Q = const` through `start`, once round: what an area-preserving orbit
    /// fills.
    pub fn curve(&self, start: &State<f64, 1>, points: usize) -> Vec<State<f64, 1>> {
        let [qq, qv, vv] = [self.invariant.qq, self.invariant.qv, self.invariant.vv]
            .map(|x| (x / self.invariant.vv).to_f64());
        let level = qq * start.q[0] * start.q[0]
            + 2.0 * qv * start.q[0] * start.v[0]
            + vv * start.v[0] * start.v[0];
        // Q = (v + qv·q)² + (qq − qv²)·q², in units of vv.
        let stiffness = (qq - qv * qv).sqrt();
        let radius = level.sqrt();
        (0..=points)
            .map(|i| {
                let angle = core::f64::consts::TAU * i as f64 / points as f64;
                let (sin, cos) = (Elementary::sin(angle), Elementary::cos(angle));
                let q = radius * cos / stiffness;
                State { q: [q], v: [radius * sin - qv * q] }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use libration_core::system::Oscillator;
    use libration_core::{Method, with_method};

    use super::*;

    /// ω² = 10 and Δt = 0.1, so that z² = 0.1.
    fn band(method: Method) -> EnergyBand {
        let model = Oscillator { omega2: 10.0 };
        let start = State { q: [1.0], v: [0.0] };
        let step = with_method!(method, |m| UpdateMatrix::of_step(m, model, &start, 0.1));
        EnergyBand::new(model, &step).unwrap()
    }

    fn close((low, high): (f64, f64), expected: (f64, f64)) {
        // ω² and Δt are rounded to 10⁻¹⁶ of themselves.
        assert!(
            (low - expected.0).abs() < 1e-15 && (high - expected.1).abs() < 1e-15,
            "{low} {high}"
        );
    }

    #[test]
    fn bands_are_those_of_the_modified_hamiltonians() {
        let (rest, z) = (State { q: [1.0], v: [0.0] }, 0.1_f64.sqrt());
        close(band(Method::VelocityVerlet).drift_after(&rest, 7), (-z * z / 4.0, 0.0));
        let (low, high) = (1.0 / (1.0 + z / 2.0) - 1.0, 1.0 / (1.0 - z / 2.0) - 1.0);
        close(band(Method::SymplecticEuler).drift_after(&rest, 7), (low, high));
        let loss = (1.0 - z.powi(6) / 72.0 + z.powi(8) / 576.0_f64).powi(7) - 1.0;
        close(band(Method::Rk4).drift_after(&rest, 7), (loss, loss));
    }

    #[test]
    fn the_worst_start_of_verlet_is_at_the_equilibrium_and_of_rk4_anywhere() {
        let worst = band(Method::VelocityVerlet);
        let State { q: [q], v: [v] } = worst.worst_start().unwrap();
        assert!(q.abs() < 1e-15 && (v.abs() - 10.0_f64.sqrt()).abs() < 1e-14);
        let z2: f64 = 0.1;
        let expected = (z2 / 4.0) / (1.0 - z2 / 4.0);
        assert!((worst.worst_drift_after(1_000_000) - expected).abs() < 1e-15);
        assert!(band(Method::Rk4).worst_start().is_none());
    }

    #[test]
    fn an_orbit_stays_on_its_curve() {
        let start = State { q: [1.0], v: [0.0] };
        let band = band(Method::SymplecticEuler);
        for State { q: [q], v: [v] } in band.curve(&start, 12) {
            // v² + ω²q² − ω²Δt·q·v = ω² for kick first.
            let form = v * v + 10.0 * q * q - 10.0 * 0.1 * q * v;
            assert!((form - 10.0).abs() < 1e-13, "{form}");
        }
    }
}
