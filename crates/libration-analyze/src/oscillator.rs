//! Systems whose degrees of freedom all move as one oscillator.

use libration::analysis::{QuadraticForm, jacobian, oscillator_windows};
use libration::equations::Degree;
use libration::number::Wide;
use libration::system::DampedOscillator;
use libration::{AnyMethod, Elementary, Scalar, State};
use libration_settings::equations::EquationSystem;

/// `q″ = −ω²q − γq′ + c` of each degree of freedom, none of which depends on another, with `ω² ≥ 0` and `γ ≥ 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CommonOscillator {
    /// ω² in s⁻².
    pub(crate) omega2: f64,
    /// γ in s⁻¹.
    pub(crate) gamma: f64,
}

impl CommonOscillator {
    /// The oscillator that all degrees of freedom of a system are; none of other systems, nor where exact motions grow exponentially.
    pub(crate) fn of(system: &EquationSystem) -> Option<Self> {
        let is_coordinate = |degree: &Degree| matches!(degree, Degree::Coordinate(_));
        if !(system.is_linear() && system.equations.degrees().iter().all(is_coordinate)) {
            return None;
        }
        let jacobian = jacobian(system.equations.dynamics(), &system.start());
        let n = system.equations.degrees().len();
        let [omega2, gamma] = [-jacobian[(0, 0)], -jacobian[(0, n)]];
        let is_own = |i: usize, j: usize| {
            let own = if i == j { [omega2, gamma] } else { [0.0; 2] };
            [-jacobian[(i, j)], -jacobian[(i, n + j)]] == own
        };
        let is_isotropic = (0..n).all(|i| (0..n).all(|j| is_own(i, j)));
        let decays = omega2 >= 0.0 && gamma >= 0.0;
        (is_isotropic && decays).then_some(CommonOscillator { omega2, gamma })
    }

    /// Whether no force acts but a constant one, so that exact motions grow as powers of time.
    pub(crate) fn is_free(self) -> bool {
        self.omega2 == 0.0 && self.gamma == 0.0
    }

    /// The angular frequency in rad/s; none where there is damping or no force towards the origin.
    pub(crate) fn frequency(self) -> Option<Wide> {
        (self.gamma == 0.0 && self.omega2 > 0.0).then(|| Wide::from_f64(self.omega2).sqrt())
    }

    /// The stability windows in s: those in which no motion grows that does not grow in exact steps. Each step moves a free mass exactly.
    pub(crate) fn stability_windows(self, method: AnyMethod) -> Option<Vec<[Option<f64>; 2]>> {
        if self.is_free() {
            return Some(vec![[Some(0.0), None]]);
        }
        let CommonOscillator { omega2, gamma } = self;
        // In powers of z for an oscillator of any stiffness, and of Δt where there is damping.
        let (scaled, unit) = match self.frequency() {
            Some(omega) => (DampedOscillator { omega2: 1.0, gamma: 0.0 }, omega.recip()),
            None => (DampedOscillator { omega2, gamma }, Wide::one()),
        };
        let in_seconds = |z: Wide| (z * unit).to_f64();
        let windows = oscillator_windows(method, &scaled)?;
        let ends = windows.iter().map(|w| [Some(in_seconds(w.from)), w.to.map(in_seconds)]);
        // A window between two neighbouring floats holds no time step.
        Some(ends.filter(|[from, to]| from != to).collect())
    }

    /// The form `v² + ω²q²` times a factor that the energy of the system is in each degree of freedom. None if it is another, or if the
    /// oscillator does not rest at the origin.
    pub(crate) fn energy_of(self, system: &EquationSystem) -> Option<QuadraticForm<Wide>> {
        let dynamics = system.equations.dynamics();
        let (degrees, start) = (dynamics.degrees(), system.start());
        let inputs = &start[2 * degrees..];
        let mut origin = vec![0.0; 2 * degrees];
        origin.extend_from_slice(inputs);
        let mut forces = dynamics.accelerations().on::<f64>();
        if forces.run(&origin).any(|force| force != 0.0) {
            return None;
        }
        let program = dynamics.energy()?;
        let energy = QuadraticForm::of(|state: &State<Wide, 1>| {
            let mut all: Vec<Wide> = origin.iter().map(|&x| Wide::from_f64(x)).collect();
            (all[0], all[degrees]) = (state.q[0], state.v[0]);
            program.on().run(&all).next().unwrap_or(Wide::ZERO)
        });
        let [qq, qv, vv] = [energy.qq, energy.qv, energy.vv].map(Wide::to_f64);
        if (qq - self.omega2 * vv).abs() > SAME * qq.abs() || qv.abs() > SAME * vv.abs() {
            return None;
        }
        let mut own = program.on::<f64>();
        let is_sum = |scale: f64| {
            let state: Vec<f64> = (0..2 * degrees).map(|i| scale + (i as f64).sin()).collect();
            let all: Vec<f64> = state.iter().chain(inputs).copied().collect();
            let parts = (0..degrees).map(|i| {
                let at = State { q: [state[i]], v: [state[degrees + i]] };
                energy.at(&at.map(Wide::from_f64)).to_f64()
            });
            let (sum, own) = (parts.sum::<f64>(), own.run(&all).next().unwrap_or(f64::NAN));
            (own - sum).abs() <= SAME * sum.abs()
        };
        // A polynomial that is another differs at one of three points that have nothing to do with it.
        [1.3, -0.7, 2.9].into_iter().all(is_sum).then_some(energy)
    }
}

/// Roundings of a sum of a few products.
const SAME: f64 = 1e-12;
