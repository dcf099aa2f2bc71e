//! The implicit integrators as a value, and all integrators as one value.

use crate::integrator::{
    BackwardEuler, DampingImplicit, DampingStiffnessImplicit, GaussLegendre4, GaussLegendre6,
    ImplicitIntegrator, ImplicitMidpoint, Integrator, Iterated, NEWTON_STEPS, StablePd, Trapezoid,
};
use crate::system::ImplicitSystem;
use crate::{Method, Scalar, State};

/// Every built-in implicit integrator.
///
/// They are no variants of [`Method`], whose kernels are compiled for each of them: implicit steps run as programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ImplicitMethod {
    /// [`DampingImplicit`].
    DampingImplicit,
    /// [`DampingStiffnessImplicit`].
    DampingStiffnessImplicit,
    /// [`StablePd`].
    StablePd,
    /// [`BackwardEuler`].
    BackwardEuler,
    /// [`ImplicitMidpoint`].
    ImplicitMidpoint,
    /// [`Trapezoid`].
    Trapezoid,
    /// [`GaussLegendre4`].
    GaussLegendre4,
    /// [`GaussLegendre6`].
    GaussLegendre6,
}

impl ImplicitMethod {
    /// All of them, by rising order.
    pub const ALL: [ImplicitMethod; 8] = [
        ImplicitMethod::DampingImplicit,
        ImplicitMethod::DampingStiffnessImplicit,
        ImplicitMethod::StablePd,
        ImplicitMethod::BackwardEuler,
        ImplicitMethod::ImplicitMidpoint,
        ImplicitMethod::Trapezoid,
        ImplicitMethod::GaussLegendre4,
        ImplicitMethod::GaussLegendre6,
    ];

    /// Name on the command line and in configurations.
    pub const fn name(self) -> &'static str {
        match self {
            ImplicitMethod::DampingImplicit => "damping-implicit",
            ImplicitMethod::DampingStiffnessImplicit => "damping-stiffness-implicit",
            ImplicitMethod::StablePd => "stable-pd",
            ImplicitMethod::BackwardEuler => "backward-euler",
            ImplicitMethod::ImplicitMidpoint => "implicit-midpoint",
            ImplicitMethod::Trapezoid => "trapezoid",
            ImplicitMethod::GaussLegendre4 => "gauss-legendre-4",
            ImplicitMethod::GaussLegendre6 => "gauss-legendre-6",
        }
    }

    /// Name in running text.
    pub const fn title(self) -> &'static str {
        match self {
            ImplicitMethod::DampingImplicit => "Euler with implicit damping",
            ImplicitMethod::DampingStiffnessImplicit => "linearly implicit Euler",
            ImplicitMethod::StablePd => "stable PD",
            ImplicitMethod::BackwardEuler => "backward Euler",
            ImplicitMethod::ImplicitMidpoint => "implicit midpoint",
            ImplicitMethod::Trapezoid => "trapezoid",
            ImplicitMethod::GaussLegendre4 => "Gauss-Legendre 4",
            ImplicitMethod::GaussLegendre6 => "Gauss-Legendre 6",
        }
    }

    /// A description in one line.
    pub const fn summary(self) -> &'static str {
        match self {
            ImplicitMethod::DampingImplicit => {
                "order 1; symplectic Euler with implicit damping, as MuJoCo's Euler and implicitfast"
            }
            ImplicitMethod::DampingStiffnessImplicit => {
                "order 1; linearly implicit Euler: damping and stiffness implicit, one linear solve"
            }
            ImplicitMethod::StablePd => {
                "order 1; stable PD of Tan, Liu and Turk: forces of the next position, damping implicit"
            }
            ImplicitMethod::BackwardEuler => {
                "order 1; stable for every step on decaying modes of linear systems; takes energy away; 5 Newton steps"
            }
            ImplicitMethod::ImplicitMidpoint => {
                "order 2; symplectic, time-reversible; no limit of the step on linear systems; 5 Newton steps"
            }
            ImplicitMethod::Trapezoid => {
                "order 2; implicit-midpoint on linear systems, conjugate to it on others; 5 Newton steps"
            }
            ImplicitMethod::GaussLegendre4 => {
                "order 4; 2 coupled stages; symplectic, time-reversible; no limit of the step on linear systems; 5 Newton steps"
            }
            ImplicitMethod::GaussLegendre6 => {
                "order 6; 3 coupled stages; symplectic, time-reversible; no limit of the step on linear systems; 5 Newton steps"
            }
        }
    }

    /// Classical order of consistency.
    pub const fn order(self) -> u32 {
        match self {
            ImplicitMethod::ImplicitMidpoint | ImplicitMethod::Trapezoid => 2,
            ImplicitMethod::GaussLegendre4 => 4,
            ImplicitMethod::GaussLegendre6 => 6,
            _ => 1,
        }
    }

    /// The number of coupled stages whose equations a step solves together.
    pub const fn coupled_stages(self) -> usize {
        match self {
            ImplicitMethod::GaussLegendre4 => 2,
            ImplicitMethod::GaussLegendre6 => 3,
            _ => 1,
        }
    }

    /// The method with one more Newton step than [`NEWTON_STEPS`]: what it changes is the error that the iteration leaves. None for a
    /// method that solves linear equations, once.
    pub const fn refined(self) -> Option<Iterated> {
        const COUNT: u32 = NEWTON_STEPS + 1;
        match self {
            ImplicitMethod::DampingImplicit
            | ImplicitMethod::DampingStiffnessImplicit
            | ImplicitMethod::StablePd => None,
            ImplicitMethod::BackwardEuler => Some(Iterated::BackwardEuler(COUNT)),
            ImplicitMethod::ImplicitMidpoint => Some(Iterated::ImplicitMidpoint(COUNT)),
            ImplicitMethod::Trapezoid => Some(Iterated::Trapezoid(COUNT)),
            ImplicitMethod::GaussLegendre4 => Some(Iterated::GaussLegendre4(COUNT)),
            ImplicitMethod::GaussLegendre6 => Some(Iterated::GaussLegendre6(COUNT)),
        }
    }

    /// The method of that name, if there is one.
    pub fn from_name(name: &str) -> Option<ImplicitMethod> {
        ImplicitMethod::ALL.into_iter().find(|m| m.name() == name)
    }
}

impl ImplicitIntegrator for ImplicitMethod {
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl ImplicitSystem<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        match self {
            ImplicitMethod::DampingImplicit => DampingImplicit.step(system, state, dt),
            ImplicitMethod::DampingStiffnessImplicit => {
                DampingStiffnessImplicit.step(system, state, dt)
            }
            ImplicitMethod::StablePd => StablePd.step(system, state, dt),
            ImplicitMethod::BackwardEuler => BackwardEuler.step(system, state, dt),
            ImplicitMethod::ImplicitMidpoint => ImplicitMidpoint.step(system, state, dt),
            ImplicitMethod::Trapezoid => Trapezoid.step(system, state, dt),
            ImplicitMethod::GaussLegendre4 => GaussLegendre4.step(system, state, dt),
            ImplicitMethod::GaussLegendre6 => GaussLegendre6.step(system, state, dt),
        }
    }
}

/// Every built-in integrator, explicit or implicit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum AnyMethod {
    /// An explicit one.
    Explicit(Method),
    /// An implicit one.
    Implicit(ImplicitMethod),
}

impl AnyMethod {
    /// Those with code of their own, the explicit ones first.
    pub fn all() -> impl Iterator<Item = AnyMethod> {
        let explicit = Method::ALL.into_iter().map(AnyMethod::Explicit);
        explicit.chain(ImplicitMethod::ALL.into_iter().map(AnyMethod::Implicit))
    }

    /// The [published methods](Method::tables) whose coefficients are tables.
    pub fn tables() -> impl Iterator<Item = AnyMethod> {
        Method::tables().map(AnyMethod::Explicit)
    }

    /// Name on the command line and in configurations.
    pub const fn name(self) -> &'static str {
        match self {
            AnyMethod::Explicit(method) => method.name(),
            AnyMethod::Implicit(method) => method.name(),
        }
    }

    /// Name in running text.
    pub const fn title(self) -> &'static str {
        match self {
            AnyMethod::Explicit(method) => method.title(),
            AnyMethod::Implicit(method) => method.title(),
        }
    }

    /// A description in one line.
    pub const fn summary(self) -> &'static str {
        match self {
            AnyMethod::Explicit(method) => method.summary(),
            AnyMethod::Implicit(method) => method.summary(),
        }
    }

    /// Authors, year and place of the coefficients of a table; none for others.
    pub const fn source(self) -> Option<&'static str> {
        match self {
            AnyMethod::Explicit(Method::Splitting(table)) => Some(table.source),
            AnyMethod::Explicit(Method::RungeKutta(table)) => Some(table.source),
            AnyMethod::Explicit(_) | AnyMethod::Implicit(_) => None,
        }
    }

    /// Classical order of consistency.
    pub const fn order(self) -> u32 {
        match self {
            AnyMethod::Explicit(method) => method.order(),
            AnyMethod::Implicit(method) => method.order(),
        }
    }

    /// The method of that name, if there is one.
    pub fn from_name(name: &str) -> Option<AnyMethod> {
        AnyMethod::all().chain(AnyMethod::tables()).find(|method| method.name() == name)
    }
}

impl From<Method> for AnyMethod {
    fn from(method: Method) -> Self {
        AnyMethod::Explicit(method)
    }
}

impl From<ImplicitMethod> for AnyMethod {
    fn from(method: ImplicitMethod) -> Self {
        AnyMethod::Implicit(method)
    }
}

/// An explicit method solves no equations.
impl ImplicitIntegrator for AnyMethod {
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl ImplicitSystem<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        match self {
            AnyMethod::Explicit(method) => Integrator::step(method, system, state, dt),
            AnyMethod::Implicit(method) => method.step(system, state, dt),
        }
    }
}
