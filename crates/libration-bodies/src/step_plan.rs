//! The step of an integrator as a list of actions on a few vectors.

use libration_core::{Method, with_method};
use libration_equations::{VectorId, VectorOperation, VectorStep};

/// The index of a vector in memory.
pub(crate) type Register = usize;

/// The vectors in which a step begins and ends.
pub(crate) const POSITIONS: Register = 0;
/// See [`POSITIONS`].
pub(crate) const VELOCITIES: Register = 1;
/// See [`POSITIONS`]; of a step that carries them.
pub(crate) const ACCELERATIONS: Register = 2;

/// Writes a vector. No action reads the vector that it writes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Action {
    /// `x + factor·y`.
    Increment {
        x: Register,
        factor: f64,
        y: Register,
    },
    Sum(Register, Register),
    Difference(Register, Register),
    Multiple(f64, Register),
    Ratio(Register, i32, i32),
    Accelerations(Register),
}

/// The actions of one step.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StepPlan {
    /// Each with the vector that it writes.
    pub(crate) actions: Vec<(Action, Register)>,
    /// Exchanges of vectors, after which the step ends where it began.
    pub(crate) exchanges: Vec<(Register, Register)>,
    /// The number of vectors.
    pub(crate) registers: usize,
    /// Whether the step begins with known accelerations.
    pub(crate) carries: bool,
    /// Accelerations that a step evaluates.
    pub(crate) evaluations: usize,
}

/// An operand of an operation.
#[derive(Clone, Copy)]
enum Value {
    Number(f64),
    Vector,
}

impl StepPlan {
    /// The plan of a step of length `dt`.
    pub(crate) fn new(method: Method, dt: f64) -> Self {
        let (step, carries) = with_method!(method, |integrator| {
            VectorStep::carrying(integrator, Some(dt))
                .map_or_else(|| (VectorStep::new(integrator, Some(dt)), false), |step| (step, true))
        });
        StepPlan::of(&step, carries)
    }

    fn of(step: &VectorStep, carries: bool) -> Self {
        let operations = fused(step);
        let mut last_use: Vec<usize> = (0..operations.len()).collect();
        for (number, operation) in operations.iter().enumerate() {
            operation.operands().into_iter().flatten().for_each(|id| last_use[id] = number);
        }
        step.ends().iter().for_each(|&end| last_use[end] = usize::MAX);
        let mut plan = StepPlan {
            actions: Vec::new(),
            exchanges: Vec::new(),
            registers: if carries { 3 } else { 2 },
            carries,
            evaluations: 0,
        };
        let mut register_of: Vec<Register> = vec![0; operations.len()];
        let mut free: Vec<Register> = Vec::new();
        for (number, operation) in operations.iter().enumerate() {
            let action = match *operation {
                Fused::None => continue,
                Fused::Input(register) => {
                    register_of[number] = register;
                    continue;
                }
                Fused::Action(action) => action.with_registers(&register_of),
            };
            let register = free.pop().unwrap_or_else(|| {
                plan.registers += 1;
                plan.registers - 1
            });
            register_of[number] = register;
            plan.evaluations += usize::from(matches!(action, Action::Accelerations(_)));
            plan.actions.push((action, register));
            let mut dead: Vec<VectorId> = operation.operands().into_iter().flatten().collect();
            dead.retain(|&id| last_use[id] == number);
            dead.dedup();
            free.extend(dead.into_iter().map(|id| register_of[id]));
        }
        let mut ends: Vec<Register> = step.ends().iter().map(|&end| register_of[end]).collect();
        for place in 0..ends.len() {
            let from = ends[place];
            if from != place {
                plan.exchanges.push((place, from));
                // The vector that was in this place is now where the other came from.
                ends.iter_mut().filter(|end| **end == place).for_each(|end| *end = from);
            }
        }
        plan
    }
}

/// An operation with numbers folded in. Its registers are indices of operations.
#[derive(Clone, Copy)]
enum Fused {
    /// A number, or part of a later operation.
    None,
    Input(Register),
    Action(Action),
}

impl Fused {
    fn operands(&self) -> [Option<VectorId>; 2] {
        match *self {
            Fused::None | Fused::Input(_) => [None; 2],
            Fused::Action(action) => match action {
                Action::Increment { x, y, .. } => [Some(x), Some(y)],
                Action::Sum(a, b) | Action::Difference(a, b) => [Some(a), Some(b)],
                Action::Multiple(_, a) | Action::Ratio(a, ..) | Action::Accelerations(a) => {
                    [Some(a), None]
                }
            },
        }
    }
}

impl Action {
    fn with_registers(self, of: &[Register]) -> Action {
        match self {
            Action::Increment { x, factor, y } => Action::Increment { x: of[x], factor, y: of[y] },
            Action::Sum(a, b) => Action::Sum(of[a], of[b]),
            Action::Difference(a, b) => Action::Difference(of[a], of[b]),
            Action::Multiple(factor, a) => Action::Multiple(factor, of[a]),
            Action::Ratio(a, num, den) => Action::Ratio(of[a], num, den),
            Action::Accelerations(at) => Action::Accelerations(of[at]),
        }
    }
}

/// Numbers become parts of the operations on vectors, and a multiple that is added once becomes an increment: the same roundings.
fn fused(step: &VectorStep) -> Vec<Fused> {
    let operations = step.operations();
    let mut uses = vec![0; operations.len()];
    for operation in operations {
        match *operation {
            VectorOperation::Sum(a, b)
            | VectorOperation::Difference(a, b)
            | VectorOperation::Product(a, b) => [a, b].into_iter().for_each(|id| uses[id] += 1),
            VectorOperation::Negative(a) | VectorOperation::Ratio(a, ..) => uses[a] += 1,
            VectorOperation::AccelerationsAt(q, _) => uses[q] += 1,
            _ => {}
        }
    }
    step.ends().iter().for_each(|&end| uses[end] += 1);
    let value = |id: VectorId| match operations[id] {
        VectorOperation::Constant(c) => Value::Number(c),
        _ => Value::Vector,
    };
    let mut fused: Vec<Fused> = Vec::with_capacity(operations.len());
    for operation in operations {
        let next = match *operation {
            VectorOperation::Positions => Fused::Input(POSITIONS),
            VectorOperation::Velocities => Fused::Input(VELOCITIES),
            VectorOperation::Accelerations => Fused::Input(ACCELERATIONS),
            VectorOperation::AccelerationsAt(q, _) => Fused::Action(Action::Accelerations(q)),
            VectorOperation::Sum(a, b) => {
                let multiple = |id: VectorId| match fused[id] {
                    Fused::Action(Action::Multiple(factor, y)) if uses[id] == 1 => {
                        Some((factor, y))
                    }
                    _ => None,
                };
                let (x, of, found) = match (multiple(b), multiple(a)) {
                    (Some(found), _) => (a, b, found),
                    (None, Some(found)) => (b, a, found),
                    (None, None) => {
                        fused.push(Fused::Action(Action::Sum(a, b)));
                        continue;
                    }
                };
                fused[of] = Fused::None;
                let (factor, y) = found;
                Fused::Action(Action::Increment { x, factor, y })
            }
            VectorOperation::Difference(a, b) => Fused::Action(Action::Difference(a, b)),
            VectorOperation::Product(a, b) => match (value(a), value(b)) {
                (Value::Number(factor), _) => Fused::Action(Action::Multiple(factor, b)),
                (_, Value::Number(factor)) => Fused::Action(Action::Multiple(factor, a)),
                // A step of fixed length multiplies vectors by numbers alone.
                _ => Fused::None,
            },
            VectorOperation::Negative(a) => Fused::Action(Action::Multiple(-1.0, a)),
            VectorOperation::Ratio(a, num, den) => Fused::Action(Action::Ratio(a, num, den)),
            VectorOperation::Constant(_)
            | VectorOperation::TimeStep
            | VectorOperation::Number(_)
            | VectorOperation::Noise(_)
            | VectorOperation::AccelerationDerivative(_)
            | VectorOperation::Solution(..)
            | VectorOperation::StageSolutions(_)
            | VectorOperation::StageSolution(..) => Fused::None,
        };
        fused.push(next);
    }
    fused
}
