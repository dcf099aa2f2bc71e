//! Integrators of servos, also by the names that simulators give them.

use libration::{AnyMethod, ImplicitMethod, Method};

/// An integrator of servos.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ServoIntegrator {
    /// One that treats all forces alike.
    Method(AnyMethod),
    /// Symplectic Euler that treats the damping of joints implicitly, and that of servos explicitly: MuJoCo's `Euler`.
    JointDampingImplicit,
}

/// Names in simulators.
const ALIASES: [(&str, ServoIntegrator); 5] = [
    ("euler", ServoIntegrator::JointDampingImplicit),
    ("semi-implicit-euler", ServoIntegrator::SYMPLECTIC_EULER),
    ("implicit", ServoIntegrator::Method(AnyMethod::Implicit(ImplicitMethod::DampingImplicit))),
    ("implicitfast", ServoIntegrator::Method(AnyMethod::Implicit(ImplicitMethod::DampingImplicit))),
    ("implicit-euler", ServoIntegrator::Method(AnyMethod::Implicit(ImplicitMethod::BackwardEuler))),
];

impl ServoIntegrator {
    /// Kick, then drift, with all forces explicit.
    pub const SYMPLECTIC_EULER: Self =
        ServoIntegrator::Method(AnyMethod::Explicit(Method::SymplecticEuler));

    /// All that differ, MuJoCo's `Euler` first.
    pub fn all() -> impl Iterator<Item = ServoIntegrator> {
        [ServoIntegrator::JointDampingImplicit]
            .into_iter()
            .chain(AnyMethod::all().map(ServoIntegrator::Method))
    }

    /// All names, those of simulators last.
    pub fn names() -> impl Iterator<Item = &'static str> {
        AnyMethod::all().map(AnyMethod::name).chain(ALIASES.into_iter().map(|(name, _)| name))
    }

    /// The integrator of that name, in small or capital letters.
    pub fn from_name(name: &str) -> Option<Self> {
        let name = name.to_lowercase();
        let alias = ALIASES.into_iter().find(|(alias, _)| *alias == name).map(|(_, found)| found);
        alias.or_else(|| AnyMethod::from_name(&name).map(ServoIntegrator::Method))
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            ServoIntegrator::Method(method) => method.name(),
            ServoIntegrator::JointDampingImplicit => "euler",
        }
    }

    /// A name for sentences, beside which is that in MuJoCo, by which users know it.
    pub(super) fn label(name: &str) -> String {
        match name == ImplicitMethod::DampingImplicit.name() {
            true => format!("{name} (implicitfast)"),
            false => name.to_owned(),
        }
    }

    /// Its name in running text, with that in MuJoCo.
    pub fn title(self) -> String {
        use ImplicitMethod::DampingImplicit;
        match self {
            ServoIntegrator::JointDampingImplicit => "MuJoCo's Euler".into(),
            ServoIntegrator::Method(AnyMethod::Implicit(DampingImplicit)) => {
                format!("{}, MuJoCo's implicitfast", DampingImplicit.title())
            }
            ServoIntegrator::Method(method) => method.title().into(),
        }
    }
}
