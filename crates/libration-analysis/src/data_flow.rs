//! The data-flow graph of a step: its operations and their dependencies.

use libration_core::elementary::sine32;
use libration_core::{Integrator, Model, State, System};

use super::operation_trace::{OperationTrace, TracedScalar};

/// An operation of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Operation {
    /// `a · b`.
    Multiplication,
    /// `a + b` or `a − b`.
    Addition,
    /// `a / b`.
    Division,
    /// A square root or another function of [`Elementary`](libration_core::Elementary) but the reciprocal.
    Function,
}

/// The operations that one step of an integrator takes, by running the step on a number that takes
/// note of them.
///
/// What does not depend on the state is not counted, nor is a change of sign, nor the same operation
/// on the same operands a second time: a compiler takes the first out of the loop, makes the second
/// a subtraction and the third a copy. More it may not do, since it would change bits.
#[derive(Clone, Debug, PartialEq)]
pub struct DataFlow {
    nodes: Vec<Node>,
    /// The next value of each coordinate of the state; none where it is constant.
    outputs: Vec<Option<usize>>,
}

/// A value that depends on the state.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    /// A coordinate of the state.
    Input,
    /// The result of an operation on other values.
    Result(Operation, Vec<usize>),
}

impl Node {
    fn operation(&self) -> Option<Operation> {
        match self {
            Node::Input => None,
            Node::Result(operation, _) => Some(*operation),
        }
    }
}

impl DataFlow {
    /// The operations of one step of `dt` seconds on `model`, after another and before the next.
    ///
    /// Where the method [hands its acceleration on](Integrator::CARRIES), that belongs to the state.
    pub fn of_step<M: Model<D>, const D: usize>(
        integrator: impl Integrator,
        model: &M,
        dt: f64,
    ) -> Self {
        let trace = OperationTrace::default();
        let input = |_| trace.input();
        let state = State { q: [(); D].map(input), v: [(); D].map(input) };
        let flow = step(
            integrator,
            model.on::<TracedScalar<'_>>(),
            state,
            TracedScalar::Constant(dt),
            input,
        );
        let outputs = flow.into_iter().map(TracedScalar::node).collect();
        DataFlow { nodes: trace.into_nodes(), outputs }
    }

    /// The arithmetic of [`sine32::sin`]; what it does with bits is not counted.
    pub fn of_sine32() -> Self {
        let trace = OperationTrace::default();
        // The integer is among the outputs: with its bits one of the other two is chosen.
        let (integer, [sine, cosine]) = sine32::arithmetic(trace.input());
        let outputs = [integer, sine, cosine].map(TracedScalar::node).into();
        DataFlow { nodes: trace.into_nodes(), outputs }
    }

    /// The number of operations of this kind in a step.
    pub fn count(&self, operation: Operation) -> usize {
        let mut needed = vec![false; self.nodes.len()];
        self.outputs.iter().flatten().for_each(|&output| needed[output] = true);
        for (i, node) in self.nodes.iter().enumerate().rev() {
            if let (true, Node::Result(_, operands)) = (needed[i], node) {
                operands.iter().for_each(|&operand| needed[operand] = true);
            }
        }
        let is_it = |node: &Node| matches!(node, Node::Result(op, _) if *op == operation);
        self.nodes.iter().zip(needed).filter(|(node, needed)| *needed && is_it(node)).count()
    }

    /// The time between two steps of a lone trajectory on a processor that has units to spare: the
    /// longest chain of operations from a state to the next, on the average over many steps.
    ///
    /// `latency(before, operation)` is the time that `operation` takes from an operand that `before` made to
    /// its result, in any unit: processors hand some results on faster than others.
    ///
    /// It is the largest mean of a cycle in the graph from coordinates to coordinates (R. M. Karp,
    /// *A characterization of the minimum cycle mean in a digraph*, Discrete Mathematics 23, 1978).
    pub fn recurrence(&self, latency: impl Fn(Operation, Operation) -> f64) -> f64 {
        let size = self.outputs.len();
        let chains: Vec<Vec<f64>> = (0..size).map(|input| self.chains(input, &latency)).collect();
        // longest[k][j] is the longest walk of k steps that ends in coordinate j.
        let mut longest = vec![vec![0.0; size]];
        for k in 0..size {
            let next = |j: usize| {
                let through = |i: usize| longest[k][i] + chains[i][j];
                (0..size).map(through).fold(f64::NEG_INFINITY, f64::max)
            };
            let row = (0..size).map(next).collect();
            longest.push(row);
        }
        let mean = |j: usize| {
            let of = |k: usize| (longest[size][j] - longest[k][j]) / (size - k) as f64;
            (0..size).map(of).fold(f64::INFINITY, f64::min)
        };
        let means = (0..size).filter(|&j| longest[size][j].is_finite()).map(mean);
        means.fold(0.0, f64::max)
    }

    /// The longest chains from one coordinate to each of them a step later; −∞ where there is none.
    fn chains(&self, from: usize, latency: &impl Fn(Operation, Operation) -> f64) -> Vec<f64> {
        let mut inputs = 0;
        let mut ready: Vec<f64> = Vec::with_capacity(self.nodes.len());
        // What made each value; a coordinate was made by the step before.
        let mut made: Vec<Option<Operation>> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let (operation, at) = match node {
                Node::Input => {
                    inputs += 1;
                    let before = self.outputs.get(inputs - 1).copied().flatten();
                    let before = before.and_then(|output| self.nodes[output].operation());
                    (before, if inputs - 1 == from { 0.0 } else { f64::NEG_INFINITY })
                }
                Node::Result(operation, operands) => {
                    let through = |&operand: &usize| {
                        ready[operand] + latency(made[operand].unwrap_or(*operation), *operation)
                    };
                    let last = operands.iter().map(through).fold(f64::NEG_INFINITY, f64::max);
                    (Some(*operation), last)
                }
            };
            ready.push(at);
            made.push(operation);
        }
        self.outputs.iter().map(|o| o.map_or(f64::NEG_INFINITY, |output| ready[output])).collect()
    }
}

/// The state after a step, coordinate by coordinate, with its acceleration where that is handed on.
fn step<'a, I: Integrator, Sys: System<TracedScalar<'a>, D>, const D: usize>(
    integrator: I,
    system: Sys,
    state: State<TracedScalar<'a>, D>,
    dt: TracedScalar<'a>,
    input: impl Fn(()) -> TracedScalar<'a>,
) -> Vec<TracedScalar<'a>> {
    if I::CARRIES && Sys::POSITIONAL {
        let (state, acceleration) = integrator.carried(&system, state, [(); D].map(input), dt);
        state.coordinates().chain(acceleration).collect()
    } else {
        integrator.step(&system, state, dt).coordinates().collect()
    }
}

#[cfg(test)]
mod tests {
    use libration_core::integrator::{ExplicitEuler, Rk4, SymplecticEuler, VelocityVerlet};
    use libration_core::system::Oscillator;

    use super::*;

    const OSCILLATOR: Oscillator<f64> = Oscillator { omega2: 10.0 };

    fn counts(integrator: impl Integrator) -> [usize; 2] {
        let flow = DataFlow::of_step::<_, 1>(integrator, &OSCILLATOR, 1e-3);
        [Operation::Multiplication, Operation::Addition].map(|operation| flow.count(operation))
    }

    fn recurrence(integrator: impl Integrator) -> f64 {
        DataFlow::of_step::<_, 1>(integrator, &OSCILLATOR, 1e-3).recurrence(|_, _| 1.0)
    }

    #[test]
    fn operations_are_those_that_one_counts_by_hand() {
        // a = −ω²q; v += Δt·a; q += Δt·v.
        assert_eq!(counts(SymplecticEuler), [3, 2]);
        assert_eq!(counts(ExplicitEuler), [3, 2]);
        // Two half kicks with one new force, and a drift.
        assert_eq!(counts(VelocityVerlet), [4, 3]);
        // Four forces, three stages of two sums, and k₁ + 2k₂ + 2k₃ + k₄ twice.
        assert_eq!(counts(Rk4), [4 + 3 * 2 + 2, 3 * 2 + 2 * 5 + 2]);
    }

    #[test]
    fn a_sine_takes_as_many_operations_as_one_counts_by_hand() {
        // To reduce the argument 20; on the rest both functions share 3, the sine takes 9 more and the cosine 12.
        let flow = DataFlow::of_sine32();
        assert_eq!(flow.count(Operation::Multiplication), 7 + 2 + 5 + 5);
        assert_eq!(flow.count(Operation::Addition), 13 + 1 + 4 + 7);
    }

    #[test]
    fn in_several_dimensions_there_is_as_much_for_each() {
        let flow = DataFlow::of_step::<_, 3>(SymplecticEuler, &OSCILLATOR, 1e-3);
        assert_eq!(flow.count(Operation::Multiplication), 9);
        assert_eq!(flow.recurrence(|_, _| 1.0), 5.0);
    }

    #[test]
    fn a_chain_takes_as_long_as_its_pairs_of_operations() {
        use Operation::{Addition, Multiplication};
        let flow = DataFlow::of_step::<_, 1>(VelocityVerlet, &OSCILLATOR, 1e-3);
        let time = |before, operation| match (before, operation) {
            (Addition, Addition) => 10.0,
            (Multiplication, Multiplication) => 100.0,
            _ => 1.0,
        };
        // q → −ω²q → ½Δt·a → + v → + (second kick) … → Δt·v → + q: one sum upon a sum, one product upon a product.
        assert_eq!(flow.recurrence(time), 114.0);
    }

    #[test]
    fn the_longest_chain_is_the_one_that_one_finds_by_hand() {
        // From q through the force to v, and on to q: 3 + 2.
        assert_eq!(recurrence(SymplecticEuler), 5.0);
        // q to v in 3, v to q in 2, but in different steps: 5 in two.
        assert_eq!(recurrence(ExplicitEuler), 2.5);
        // From q to the force in 1, to v in two half kicks, to q in 2; the second kick waits for the
        // force alone.
        assert_eq!(recurrence(VelocityVerlet), 6.0);
    }
}
