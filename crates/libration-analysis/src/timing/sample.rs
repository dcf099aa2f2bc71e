//! Plants for tests.

use libration_core::integrator::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
use libration_core::{Method, Model, State, with_method};

use super::Plant;

pub(super) const ORIGIN: State<f64, 1> = State { q: [0.0], v: [0.0] };

/// `model` in steps of each method that has a table in theory, and in exact ones.
pub(super) fn textbook(
    model: impl Model<1> + 'static,
    dt: f64,
) -> Vec<(&'static str, Plant<'static>)> {
    vec![
        ("explicit Euler", Plant::new(ExplicitEuler, model, ORIGIN, dt)),
        ("symplectic Euler", Plant::new(SymplecticEuler, model, ORIGIN, dt)),
        ("velocity Verlet", Plant::new(VelocityVerlet, model, ORIGIN, dt)),
        ("RK4", Plant::new(Rk4, model, ORIGIN, dt)),
        ("exact", Plant::exact(model, ORIGIN, dt)),
    ]
}

/// `model` in steps of every method, and in exact ones.
pub(super) fn all(model: impl Model<1> + 'static, dt: f64) -> Vec<(String, Plant<'static>)> {
    let of = |method: &Method| {
        let plant = with_method!(*method, |m| Plant::new(m, model, ORIGIN, dt));
        (format!("{method:?}"), plant)
    };
    let exact = ("exact".to_owned(), Plant::exact(model, ORIGIN, dt));
    Method::ALL.iter().map(of).chain([exact]).collect()
}
