//! Linear systems that switch between matrices along a graph.

use thiserror::Error;

use crate::Matrix;

/// A linear system `x' = M x` whose matrix changes from step to step. The allowed sequences of matrices are the walks in a graph.
#[derive(Clone, Debug)]
pub struct SwitchedSystem {
    matrices: Vec<Matrix>,
    nodes: usize,
    transitions: Vec<Transition>,
    /// The transitions that leave each node.
    leaving: Vec<Vec<usize>>,
}

/// An edge of the graph of a switched system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transition {
    /// The node before the step.
    pub from: usize,
    /// The node after it.
    pub to: usize,
    /// The number of the matrix of the step.
    pub matrix: usize,
}

/// Error of a switched system.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SwitchedSystemError {
    /// There is no matrix.
    #[error("a switched system has no matrices; expected at least one")]
    Empty,
    /// Matrices have different shapes or entries that are not finite.
    #[error(
        "matrix {0} of a switched system is not square, not finite or not as large as the first"
    )]
    Matrix(usize),
    /// A transition has a node or a matrix that does not exist.
    #[error("transition {0} of a switched system has an unknown node or matrix")]
    Transition(usize),
    /// A walk ends.
    #[error("no transition leaves node {0} of a switched system; expected at least one")]
    DeadEnd(usize),
}

impl SwitchedSystem {
    /// A system of square matrices of one size, with a graph of `nodes` nodes.
    ///
    /// # Errors
    /// [`SwitchedSystemError`]: matrices that do not fit, or a graph in which a walk ends.
    pub fn new(
        matrices: Vec<Matrix>,
        nodes: usize,
        transitions: Vec<Transition>,
    ) -> Result<Self, SwitchedSystemError> {
        let Some(first) = matrices.first() else { return Err(SwitchedSystemError::Empty) };
        let n = first.rows();
        let fits = |m: &Matrix| [m.rows(), m.columns()] == [n, n] && m.is_finite();
        if let Some(i) = matrices.iter().position(|matrix| !fits(matrix)) {
            return Err(SwitchedSystemError::Matrix(i));
        }
        let exists = |t: &Transition| t.from < nodes && t.to < nodes && t.matrix < matrices.len();
        if let Some(i) = transitions.iter().position(|transition| !exists(transition)) {
            return Err(SwitchedSystemError::Transition(i));
        }
        let mut leaving = vec![Vec::new(); nodes];
        for (i, transition) in transitions.iter().enumerate() {
            leaving[transition.from].push(i);
        }
        match leaving.iter().position(Vec::is_empty) {
            Some(node) => Err(SwitchedSystemError::DeadEnd(node)),
            None => Ok(SwitchedSystem { matrices, nodes, transitions, leaving }),
        }
    }

    /// A system whose matrices follow each other in any order.
    ///
    /// # Errors
    /// As for [`SwitchedSystem::new`].
    pub fn unconstrained(matrices: Vec<Matrix>) -> Result<Self, SwitchedSystemError> {
        let transition = |matrix| Transition { from: 0, to: 0, matrix };
        let transitions = (0..matrices.len()).map(transition).collect();
        Self::new(matrices, 1, transitions)
    }

    /// The size of the state.
    pub(crate) fn size(&self) -> usize {
        self.matrices[0].rows()
    }

    /// The number of nodes.
    pub(crate) fn nodes(&self) -> usize {
        self.nodes
    }

    /// All transitions.
    pub fn transitions(&self) -> &[Transition] {
        &self.transitions
    }

    /// The matrix of a transition.
    pub(crate) fn matrix(&self, transition: usize) -> &Matrix {
        &self.matrices[self.transitions[transition].matrix]
    }

    /// All matrices.
    pub(crate) fn matrices(&self) -> &[Matrix] {
        &self.matrices
    }

    /// The transitions that leave a node.
    pub(crate) fn leaving(&self, node: usize) -> &[usize] {
        &self.leaving[node]
    }

    /// The same system with a node for each transition, that by which a walk came.
    pub(crate) fn refined(&self) -> Self {
        let mut transitions = Vec::new();
        let mut leaving = vec![Vec::new(); self.transitions.len()];
        for (from, before) in self.transitions.iter().enumerate() {
            for &to in &self.leaving[before.to] {
                leaving[from].push(transitions.len());
                transitions.push(Transition { from, to, matrix: self.transitions[to].matrix });
            }
        }
        let nodes = self.transitions.len();
        SwitchedSystem { matrices: self.matrices.clone(), nodes, transitions, leaving }
    }

    /// The product of the matrices of a walk, the first step first.
    pub(crate) fn product(&self, walk: &[usize]) -> Matrix {
        let identity = Matrix::identity(self.size());
        walk.iter().fold(identity, |product, &transition| self.matrix(transition) * &product)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn systems_that_do_not_fit_are_refused_in_words() {
        let refused = |matrices: Vec<Matrix>, nodes, edges: &[[usize; 3]]| {
            let transition = |&[from, to, matrix]: &[usize; 3]| Transition { from, to, matrix };
            let transitions = edges.iter().map(transition).collect();
            SwitchedSystem::new(matrices, nodes, transitions).unwrap_err().to_string()
        };
        let one = || vec![Matrix::identity(2)];
        assert!(refused(vec![], 1, &[]).contains("no matrices"));
        let shapes = vec![Matrix::identity(2), Matrix::identity(3)];
        assert!(refused(shapes, 1, &[[0, 0, 0]]).contains("matrix 1"));
        assert!(refused(vec![Matrix::diagonal(&[f64::NAN])], 1, &[[0, 0, 0]]).contains("matrix 0"));
        assert!(refused(one(), 1, &[[0, 0, 0], [0, 0, 1]]).contains("transition 1"));
        assert!(refused(one(), 2, &[[0, 1, 0]]).contains("leaves node 1"));
    }
}
