//! Systems whose degrees of freedom all move as one oscillator.

use libration::analysis::{jacobian, oscillator_windows};
use libration::equations::Degree;
use libration::number::Wide;
use libration::system::DampedOscillator;
use libration::{AnyMethod, Elementary, Scalar};
use libration_settings::equations::EquationSystem;

/// `q″ = −ω²q − γq′ + c` of each degree of freedom, none of which depends on another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CommonOscillator {
    /// ω² in s⁻².
    pub(crate) omega2: f64,
    /// γ in s⁻¹.
    pub(crate) gamma: f64,
}

impl CommonOscillator {
    /// The oscillator that all degrees of freedom of a system are; none of other systems.
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
        is_isotropic.then_some(CommonOscillator { omega2, gamma })
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
}
