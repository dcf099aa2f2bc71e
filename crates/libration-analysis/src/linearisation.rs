//! One step as a matrix, in 1024 bits.

use libration_core::number::{Dual, Wide};
use libration_core::system::DynSystem;
use libration_core::{Integrator, Model, State, System};

use super::UpdateMatrix;
use super::exponential::exponential;

/// A system and one step of an integrator on it, linearised about a state.
///
/// For a linear system the matrices are the maps themselves, whatever the state. They carry 1024
/// bits, so that differences such as `det M − 1` have all the digits of an `f64` left.
#[derive(Clone, Copy, Debug)]
pub struct Linearisation<const D: usize> {
    /// The Jacobian `A` of the rate of change `(q̇, v̇)`.
    pub generator: UpdateMatrix<Wide, D>,
    /// The Jacobian `M` of one step.
    pub step: UpdateMatrix<Wide, D>,
    /// The Jacobian of a step of `−Δt` from where the step ends.
    pub back: UpdateMatrix<Wide, D>,
    /// The time step in seconds.
    pub dt: Wide,
}

/// The rate of change of a state, or any other map of phase space.
type Rate<'a, const D: usize> = dyn Fn(State<Dual<Wide>, D>) -> State<Dual<Wide>, D> + 'a;

/// One step from a state, of the given size.
pub type StepFunction<'a, const D: usize> =
    dyn Fn(State<Dual<Wide>, D>, Dual<Wide>) -> State<Dual<Wide>, D> + 'a;

impl<const D: usize> Linearisation<D> {
    /// `integrator` with a step of `dt` seconds on `model`, about the state `at`.
    pub fn new(
        integrator: impl Integrator,
        model: impl Model<D>,
        at: &State<f64, D>,
        dt: f64,
    ) -> Self {
        let system = model.on::<Dual<Wide>>();
        let rate = |state| system.rate(state);
        // A call is nothing beside numbers so long, and steps of any system are compiled once.
        let acceleration = |state: &_| model.on::<Dual<Wide>>().acceleration(state);
        let chosen = DynSystem(&acceleration);
        let step = |state, h| integrator.step(&chosen, state, h);
        Linearisation::of(&rate, &step, at.map(wide), wide(dt))
    }

    /// A step of `dt` seconds that is given as a function of the state and its length, with the rates of `model`.
    pub fn of_step(
        model: impl Model<D>,
        at: &State<f64, D>,
        dt: f64,
        step: &StepFunction<'_, D>,
    ) -> Self {
        let system = model.on::<Dual<Wide>>();
        Linearisation::of(&|state| system.rate(state), step, at.map(wide), wide(dt))
    }

    /// Exact steps of `dt` seconds, by the exponential of the generator.
    pub fn exact(model: impl Model<D>, at: &State<f64, D>, dt: f64) -> Self {
        let generator = Linearisation::generator_of(model, at);
        let dt = wide(dt);
        let flow = |t: Wide| {
            let rows = exponential(&generator.rows(), t);
            UpdateMatrix::from_map(|e: State<Wide, D>| {
                let e: Vec<Wide> = e.coordinates().collect();
                let image =
                    |i: usize| rows[i].iter().zip(&e).fold(Wide::ZERO, |sum, (&x, &y)| sum + x * y);
                State { q: core::array::from_fn(image), v: core::array::from_fn(|i| image(D + i)) }
            })
        };
        Linearisation { generator, step: flow(dt), back: flow(-dt), dt }
    }

    /// The Jacobian of the rate of change at `at`.
    pub fn generator_of(model: impl Model<D>, at: &State<f64, D>) -> UpdateMatrix<Wide, D> {
        let system = model.on::<Dual<Wide>>();
        jacobian(&|state| system.rate(state), &at.map(wide))
    }

    /// The maps are dynamic, so that the matrices are compiled once for each dimension.
    fn of(rate: &Rate<'_, D>, step: &StepFunction<'_, D>, at: State<Wide, D>, dt: Wide) -> Self {
        let by = |h: Wide| move |state| step(state, Dual::constant(h));
        let end = by(dt)(at.map(Dual::constant)).map(|x| x.re);
        Linearisation {
            generator: jacobian(rate, &at),
            step: jacobian(&by(dt), &at),
            back: jacobian(&by(-dt), &end),
            dt,
        }
    }

    /// `‖M(−Δt)·M(Δt) − 1‖` in the Frobenius norm: zero for a time-reversible method.
    pub fn reversibility_defect(&self) -> Wide {
        self.back.after(&self.step).distance_from_identity()
    }
}

impl Linearisation<1> {
    /// The same in `D` degrees of freedom that do not depend on each other.
    pub fn in_dimensions<const D: usize>(&self) -> Linearisation<D> {
        let each = |one: &UpdateMatrix<Wide, 1>| {
            let row = |i: usize, q: Wide, v: Wide| one.entry(i, 0) * q + one.entry(i, 1) * v;
            UpdateMatrix::from_map(|e: State<Wide, D>| State {
                q: core::array::from_fn(|j| row(0, e.q[j], e.v[j])),
                v: core::array::from_fn(|j| row(1, e.q[j], e.v[j])),
            })
        };
        Linearisation {
            generator: each(&self.generator),
            step: each(&self.step),
            back: each(&self.back),
            dt: self.dt,
        }
    }
}

/// The Jacobian of `f` at `at`, one direction of phase space at a time.
fn jacobian<const D: usize>(f: &Rate<'_, D>, at: &State<Wide, D>) -> UpdateMatrix<Wide, D> {
    UpdateMatrix::from_map(|direction| {
        f(State {
            q: core::array::from_fn(|i| Dual { re: at.q[i], du: direction.q[i] }),
            v: core::array::from_fn(|i| Dual { re: at.v[i], du: direction.v[i] }),
        })
        .map(|x| x.du)
    })
}

fn wide(x: f64) -> Wide {
    libration_core::Scalar::from_f64(x)
}
