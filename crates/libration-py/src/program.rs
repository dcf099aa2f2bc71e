//! A step of an integrator as a list of array operations, for accelerations from Python.

use std::cell::RefCell;
use std::ops::{Add, Mul, Neg, Sub};

use libration::{Integrator, Scalar, State, System, with_method};
use pyo3::prelude::*;

use crate::request::method;

/// An operation: its name, and the places of what it is done with. `ratio` has two whole numbers after its operand, and `constant`
/// stands in the list of constants.
type Operation = (&'static str, usize, i64, i64);

thread_local! {
    /// Everything that has been done since somebody began to take note.
    static NOTED: RefCell<Noted> = const { RefCell::new(Noted { operations: Vec::new(), constants: Vec::new() }) };
}

struct Noted {
    operations: Vec<Operation>,
    constants: Vec<f64>,
}

/// A number that is known by what makes it: the place of an operation in the list.
#[derive(Clone, Copy, Debug)]
struct Place(usize);

fn note(name: &'static str, a: usize, b: i64, c: i64) -> Place {
    NOTED.with_borrow_mut(|noted| {
        noted.operations.push((name, a, b, c));
        Place(noted.operations.len() - 1)
    })
}

impl Add for Place {
    type Output = Place;

    fn add(self, other: Place) -> Place {
        note("add", self.0, other.0 as i64, 0)
    }
}

impl Sub for Place {
    type Output = Place;

    fn sub(self, other: Place) -> Place {
        note("subtract", self.0, other.0 as i64, 0)
    }
}

impl Mul for Place {
    type Output = Place;

    fn mul(self, other: Place) -> Place {
        note("multiply", self.0, other.0 as i64, 0)
    }
}

impl Neg for Place {
    type Output = Place;

    fn neg(self) -> Place {
        note("negative", self.0, 0, 0)
    }
}

impl Scalar for Place {
    fn from_f64(c: f64) -> Self {
        let at = NOTED.with_borrow_mut(|noted| {
            noted.constants.push(c);
            noted.constants.len() - 1
        });
        note("constant", at, 0, 0)
    }

    fn ratio(self, num: i32, den: i32) -> Self {
        note("ratio", self.0, num.into(), den.into())
    }
}

/// Whatever it is, Python knows its force.
struct Unknown;

impl System<Place, 1> for Unknown {
    fn acceleration(&self, state: &State<Place, 1>) -> [Place; 1] {
        [note("acceleration", state.q[0].0, state.v[0].0 as i64, 0)]
    }
}

/// The operations of a step, its constants, and the places of the next position and velocity. The first three operations are the
/// position, the velocity and the time step.
#[pyfunction]
pub(crate) fn _program(integrator: &str) -> PyResult<(Vec<Operation>, Vec<f64>, [usize; 2])> {
    let method = method(integrator)?;
    NOTED.set(Noted { operations: Vec::new(), constants: Vec::new() });
    let [q, v, dt] = [0, 1, 2].map(|i| note("input", i, 0, 0));
    let state = State { q: [q], v: [v] };
    let next = with_method!(method, |integrator| integrator.step(&Unknown, state, dt));
    let Noted { operations, constants } =
        NOTED.replace(Noted { operations: Vec::new(), constants: Vec::new() });
    Ok((operations, constants, [next.q[0].0, next.v[0].0]))
}
