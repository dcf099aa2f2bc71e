//! A simulator whose action is held.

use libration::linear::Matrix;

use crate::{BlackBox, BlackBoxError, Subject};

/// A black box without actions: that of a simulator under a constant one.
pub(crate) struct HeldAction<'a> {
    pub(crate) black_box: &'a mut dyn BlackBox,
    pub(crate) action: &'a [f64],
}

impl BlackBox for HeldAction<'_> {
    fn step(
        &mut self,
        states: &Matrix,
        _actions: &Matrix,
        dt: f64,
    ) -> Result<Matrix, BlackBoxError> {
        let held = Matrix::from_fn(states.rows(), self.action.len(), |_, j| self.action[j]);
        self.black_box.step(states, &held, dt)
    }

    fn is_batched(&self) -> bool {
        self.black_box.is_batched()
    }

    fn observe(&mut self, states: &Matrix) -> Result<Option<Matrix>, BlackBoxError> {
        self.black_box.observe(states)
    }

    fn energies(&mut self, states: &Matrix) -> Result<Option<Vec<f64>>, BlackBoxError> {
        self.black_box.energies(states)
    }
}

impl Subject {
    /// The same subject under its action, held.
    pub(crate) fn with_held_action(&self) -> Self {
        let mut held = self.clone();
        held.inputs.clear();
        held.action.clear();
        held.action_scale.clear();
        held.stated_delays.clear();
        if let Some(reference) = &mut held.reference {
            reference.b = Matrix::zeros(reference.a.rows(), 0);
        }
        held.notes.push("the actions are held: their effect is not in the matrices".into());
        held
    }
}
