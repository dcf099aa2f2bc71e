//! A number that records the step of an integrator.

use core::cell::RefCell;
use core::ops::{Add, Mul, Neg, Sub};

use libration_core::system::{ImplicitSystem, StageCoefficients};
use libration_core::{Scalar, State, System};

/// The operations of a step on whole vectors: positions, velocities and accelerations of a system of any size.
///
/// An integrator treats all degrees of freedom alike, so that a step in one dimension has the operations of all of them.
#[derive(Debug, Default)]
pub(crate) struct StepTrace {
    operations: RefCell<Vec<VectorOperation>>,
}

/// The index of a vector of a step.
pub type VectorId = usize;

/// The origin of a vector.
#[derive(Clone, Debug, PartialEq)]
pub enum VectorOperation {
    /// The positions at the start of the step.
    Positions,
    /// The velocities at the start of the step.
    Velocities,
    /// The accelerations at the start of the step.
    Accelerations,
    /// The time step in each entry.
    TimeStep,
    /// A number of the step besides its length, in each entry.
    Number(usize),
    /// A vector of random numbers.
    Noise(usize),
    /// A number in each entry.
    Constant(f64),
    /// Sums, entry by entry.
    Sum(VectorId, VectorId),
    /// Differences, entry by entry.
    Difference(VectorId, VectorId),
    /// Products, entry by entry.
    Product(VectorId, VectorId),
    /// The other sign.
    Negative(VectorId),
    /// A multiple and its quotient, as [`Scalar::ratio`].
    Ratio(VectorId, i32, i32),
    /// The accelerations at these positions and velocities.
    AccelerationsAt(VectorId, VectorId),
    /// The derivative of the accelerations at the first two along the last two.
    AccelerationDerivative([VectorId; 4]),
    /// The solution of linear equations with the derivatives at these positions and velocities, for this time step and right side.
    Solution(Implicit, [VectorId; 4]),
    /// The solutions of the coupled linear equations of several stages, one after the other.
    StageSolutions(StageOperands),
    /// The solution of the stage of this index among them.
    StageSolution(VectorId, usize),
}

/// The operands of the coupled linear equations of several stages.
#[derive(Clone, Debug, PartialEq)]
pub struct StageOperands {
    /// Positions and velocities of each stage, where derivatives are taken.
    pub at: Vec<[VectorId; 2]>,
    /// The coefficients of the derivatives by positions, stages × stages. Each is the same in all entries.
    pub of_q: Vec<VectorId>,
    /// Those of the derivatives by velocities.
    pub of_v: Vec<VectorId>,
    /// The right side of each stage.
    pub right: Vec<VectorId>,
}

/// The forces that linear equations treat implicitly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Implicit {
    /// Those of the velocities.
    Damping,
    /// All of them.
    DampingAndStiffness,
}

impl StepTrace {
    pub(crate) fn record(&self, operation: VectorOperation) -> TracedVector<'_> {
        let mut operations = self.operations.borrow_mut();
        operations.push(operation);
        Recorded { trace: self, id: operations.len() - 1 }
    }

    /// The index of a vector; a constant becomes one.
    pub(crate) fn id(&self, vector: TracedVector<'_>) -> VectorId {
        match vector {
            Recorded { id, .. } => id,
            Constant(c) => {
                let mut operations = self.operations.borrow_mut();
                operations.push(VectorOperation::Constant(c));
                operations.len() - 1
            }
        }
    }

    pub(crate) fn into_operations(self) -> Vec<VectorOperation> {
        self.operations.into_inner()
    }
}

/// A vector of a step, or a number that is the same in every entry.
#[derive(Clone, Copy, Debug)]
pub(crate) enum TracedVector<'t> {
    Constant(f64),
    Recorded { trace: &'t StepTrace, id: VectorId },
}

use TracedVector::{Constant, Recorded};

impl<'t> TracedVector<'t> {
    fn with(
        self,
        other: Self,
        operation: fn(VectorId, VectorId) -> VectorOperation,
        of_constants: fn(f64, f64) -> f64,
    ) -> Self {
        let trace = match (self, other) {
            (Constant(a), Constant(b)) => return Constant(of_constants(a, b)),
            (Recorded { trace, .. }, _) | (_, Recorded { trace, .. }) => trace,
        };
        let (a, b) = (trace.id(self), trace.id(other));
        trace.record(operation(a, b))
    }
}

impl Add for TracedVector<'_> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.with(other, VectorOperation::Sum, |a, b| a + b)
    }
}

impl Sub for TracedVector<'_> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.with(other, VectorOperation::Difference, |a, b| a - b)
    }
}

impl Mul for TracedVector<'_> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.with(other, VectorOperation::Product, |a, b| a * b)
    }
}

impl Neg for TracedVector<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        match self {
            Constant(c) => Constant(-c),
            Recorded { trace, id } => trace.record(VectorOperation::Negative(id)),
        }
    }
}

impl Scalar for TracedVector<'_> {
    fn from_f64(c: f64) -> Self {
        Constant(c)
    }

    fn ratio(self, num: i32, den: i32) -> Self {
        match self {
            Constant(c) => Constant(c * f64::from(num) / f64::from(den)),
            Recorded { trace, id } => trace.record(VectorOperation::Ratio(id, num, den)),
        }
    }
}

/// A system of any size, whose accelerations are recorded.
pub(crate) struct TracedSystem<'t>(pub(crate) &'t StepTrace);

impl<'t> System<TracedVector<'t>, 1> for TracedSystem<'t> {
    const POSITIONAL: bool = true;

    fn acceleration(&self, state: &State<TracedVector<'t>, 1>) -> [TracedVector<'t>; 1] {
        let TracedSystem(trace) = self;
        let (q, v) = (trace.id(state.q[0]), trace.id(state.v[0]));
        [trace.record(VectorOperation::AccelerationsAt(q, v))]
    }
}

impl<'t> TracedSystem<'t> {
    /// An operation on positions and velocities and two more vectors.
    fn record(
        &self,
        at: &State<TracedVector<'t>, 1>,
        others: [TracedVector<'t>; 2],
        operation: impl FnOnce([VectorId; 4]) -> VectorOperation,
    ) -> [TracedVector<'t>; 1] {
        let TracedSystem(trace) = self;
        let operands = [at.q[0], at.v[0], others[0], others[1]].map(|vector| trace.id(vector));
        [trace.record(operation(operands))]
    }
}

impl<'t> ImplicitSystem<TracedVector<'t>, 1> for TracedSystem<'t> {
    fn acceleration_derivative(
        &self,
        at: &State<TracedVector<'t>, 1>,
        direction: &State<TracedVector<'t>, 1>,
    ) -> [TracedVector<'t>; 1] {
        let along = [direction.q[0], direction.v[0]];
        self.record(at, along, VectorOperation::AccelerationDerivative)
    }

    fn solve_damping(
        &self,
        at: &State<TracedVector<'t>, 1>,
        h: TracedVector<'t>,
        [right]: [TracedVector<'t>; 1],
    ) -> [TracedVector<'t>; 1] {
        let solution = |operands| VectorOperation::Solution(Implicit::Damping, operands);
        self.record(at, [h, right], solution)
    }

    fn solve_damping_and_stiffness(
        &self,
        at: &State<TracedVector<'t>, 1>,
        h: TracedVector<'t>,
        [right]: [TracedVector<'t>; 1],
    ) -> [TracedVector<'t>; 1] {
        let solution =
            |operands| VectorOperation::Solution(Implicit::DampingAndStiffness, operands);
        self.record(at, [h, right], solution)
    }

    fn solve_stage_accelerations<const N: usize>(
        &self,
        at: &[State<TracedVector<'t>, 1>; N],
        of: StageCoefficients<'_, TracedVector<'t>, N>,
        right: [[TracedVector<'t>; 1]; N],
    ) -> [[TracedVector<'t>; 1]; N] {
        let TracedSystem(trace) = self;
        let id = |&vector: &TracedVector<'t>| trace.id(vector);
        let operands = StageOperands {
            at: at.iter().map(|state| [id(&state.q[0]), id(&state.v[0])]).collect(),
            of_q: of.of_q.iter().flatten().map(id).collect(),
            of_v: of.of_v.iter().flatten().map(id).collect(),
            right: right.iter().flatten().map(id).collect(),
        };
        let all = trace.id(trace.record(VectorOperation::StageSolutions(operands)));
        core::array::from_fn(|i| [trace.record(VectorOperation::StageSolution(all, i))])
    }
}
