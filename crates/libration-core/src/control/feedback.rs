//! Gains of a feedback and weights of its cost.

/// State feedback `u = −K_p·q − K_d·v`, where `u` is an acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Feedback {
    /// `K_p`, in s⁻².
    pub position: f64,
    /// `K_d`, in s⁻¹.
    pub velocity: f64,
}

impl Feedback {
    /// The feedback of accelerations that does what this one does as a force on `mass`: gains in N/m and
    /// N·s/m, divided by kg.
    pub fn per_mass(self, mass: f64) -> Self {
        Feedback { position: self.position / mass, velocity: self.velocity / mass }
    }

    /// The inverse of [`per_mass`](Feedback::per_mass): gains in N/m and N·s/m.
    pub fn times_mass(self, mass: f64) -> Self {
        Feedback { position: self.position * mass, velocity: self.velocity * mass }
    }
}

/// The weights of the cost of a step, `position·q² + velocity·v² + command·u²`, with state and command at its beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LqrWeights {
    /// The weight of `q²`; with `q` in m it is in m⁻².
    pub position: f64,
    /// The weight of `v²`, in s²/m².
    pub velocity: f64,
    /// The weight of `u²`, in s⁴/m².
    pub command: f64,
}

impl LqrWeights {
    /// The weights of accelerations that cost what these do where the command is a force on `mass`: the
    /// weight of `u²`, in N⁻² times the unit of the cost, is multiplied by kg².
    pub fn per_mass(self, mass: f64) -> Self {
        LqrWeights { command: self.command * mass * mass, ..self }
    }
}
