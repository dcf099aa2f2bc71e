//! Calls of a black box, counted and checked.

use libration::linear::Matrix;

use crate::{BlackBox, BlackBoxError, Subject};

/// The help for a result that is not finite at the given state.
const ELSEWHERE: &str = "choose a state and an action at which the step is defined (state, action)";
/// The help for one near it.
const CLOSER: &str =
    "smaller typical deviations (state_scale) keep the audit where the step is defined";

/// A black box at work: each result has the right shape and is free of earlier calls.
pub(crate) struct Prober<'a> {
    black_box: &'a mut dyn BlackBox,
    pub(crate) subject: &'a Subject,
    /// Calls with the same values after which a result no longer depends on what was before.
    pub(crate) memory: usize,
    /// The rounding of results relative to them, where it is far above that of `f64`; else 0.
    pub(crate) coarseness: f64,
    /// The actions of the last call, and the number of calls in a row that had them.
    held: (Matrix, usize),
    /// Whether results depend on earlier states.
    pub(crate) has_state_memory: bool,
    /// Rows that were stepped.
    pub(crate) calls: u64,
}

impl<'a> Prober<'a> {
    pub(crate) fn new(black_box: &'a mut dyn BlackBox, subject: &'a Subject) -> Self {
        Prober {
            black_box,
            subject,
            memory: 0,
            coarseness: 0.0,
            held: (Matrix::zeros(0, 0), 0),
            has_state_memory: false,
            calls: 0,
        }
    }

    pub(crate) fn is_batched(&self) -> bool {
        self.black_box.is_batched()
    }

    pub(crate) fn set_gains(&mut self, kp: &[f64], kv: &[f64]) -> Result<bool, BlackBoxError> {
        self.black_box.set_gains(kp, kv)
    }

    pub(crate) fn restart(&mut self) -> Result<bool, BlackBoxError> {
        self.black_box.restart()
    }

    /// One call with all rows, whatever the black box remembers. A result may be infinite or NaN.
    pub(crate) fn call(
        &mut self,
        states: &Matrix,
        actions: &Matrix,
        dt: f64,
    ) -> Result<Matrix, BlackBoxError> {
        self.calls += states.rows() as u64;
        if self.held.0 == *actions {
            self.held.1 += 1;
        } else {
            self.held = (actions.clone(), 1);
        }
        let next = self.black_box.step(states, actions, dt)?;
        let expected = (states.rows(), self.subject.state.len());
        check_shape("next states", states.rows(), (next.rows(), next.columns()), expected)?;
        Ok(next)
    }

    /// [`Prober::call`] with one state and one action.
    pub(crate) fn call_one(
        &mut self,
        state: &[f64],
        action: &[f64],
        dt: f64,
    ) -> Result<Vec<f64>, BlackBoxError> {
        let next = self.call(&row(state), &row(action), dt)?;
        Ok(next.entries().to_vec())
    }

    /// The states a step later, each as if its state and action had never changed before.
    pub(crate) fn step(
        &mut self,
        states: &Matrix,
        actions: &Matrix,
        dt: f64,
    ) -> Result<Matrix, BlackBoxError> {
        let memory = self.memory_at(dt);
        if memory == 0 || self.is_batched() {
            for _ in self.known_calls(actions)..memory {
                self.call(states, actions, dt)?;
            }
            return self.call(states, actions, dt);
        }
        let mut next = Matrix::zeros(states.rows(), states.columns());
        for i in 0..states.rows() {
            let (state, action) = (row(states.row(i)), row(actions.row(i)));
            let alone = |prober: &mut Self| prober.call(&state, &action, dt);
            for _ in self.known_calls(&action)..memory {
                alone(self)?;
            }
            next.row_mut(i).copy_from_slice(alone(self)?.row(0));
        }
        Ok(next)
    }

    /// Calls in a row that had these actions, and need no repetition: none if earlier states count.
    fn known_calls(&self, actions: &Matrix) -> usize {
        if self.held.0 == *actions && !self.has_state_memory { self.held.1 } else { 0 }
    }

    /// Calls of `dt` seconds after which earlier ones are forgotten: a memory may last calls or seconds.
    fn memory_at(&self, dt: f64) -> usize {
        let longer = (self.subject.dt / dt).max(1.0);
        (self.memory as f64 * longer).ceil() as usize
    }

    /// The finite state a step after `state` of a run under a constant action, which needs no repeated calls.
    pub(crate) fn advance(
        &mut self,
        state: &[f64],
        action: &[f64],
        dt: f64,
    ) -> Result<Vec<f64>, BlackBoxError> {
        if self.has_state_memory {
            return self.step_one(state, action, dt);
        }
        let next = self.call_one(state, action, dt)?;
        self.finite(state, dt, next)
    }

    /// The finite state a step after `state`.
    pub(crate) fn step_one(
        &mut self,
        state: &[f64],
        action: &[f64],
        dt: f64,
    ) -> Result<Vec<f64>, BlackBoxError> {
        let next = self.step(&row(state), &row(action), dt)?.entries().to_vec();
        self.finite(state, dt, next)
    }

    fn finite(&self, state: &[f64], dt: f64, next: Vec<f64>) -> Result<Vec<f64>, BlackBoxError> {
        match next.iter().position(|x| !x.is_finite()) {
            None => Ok(next),
            Some(i) => {
                let from: Vec<String> = state.iter().map(|x| format!("{x:.6e}")).collect();
                Err(BlackBoxError::NotFinite {
                    dt,
                    from: from.join(", "),
                    value: next[i],
                    state: self.subject.states[i].name.clone(),
                    help: if state == self.subject.state { ELSEWHERE } else { CLOSER },
                })
            }
        }
    }

    pub(crate) fn observe(&mut self, state: &[f64]) -> Result<Option<Vec<f64>>, BlackBoxError> {
        let observed = self.black_box.observe(&row(state))?;
        Ok(observed.map(|y| y.entries().to_vec()))
    }

    pub(crate) fn energy(&mut self, state: &[f64]) -> Result<Option<f64>, BlackBoxError> {
        let energies = self.black_box.energies(&row(state))?;
        let Some(energies) = energies else { return Ok(None) };
        check_shape("energies", 1, (energies.len(), 1), (1, 1))?;
        Ok(energies.first().copied())
    }
}

/// A matrix of one row.
pub(crate) fn row(values: &[f64]) -> Matrix {
    Matrix::from_fn(1, values.len(), |_, j| values[j])
}

fn check_shape(
    what: &'static str,
    rows: usize,
    found: (usize, usize),
    expected: (usize, usize),
) -> Result<(), BlackBoxError> {
    let shape = |(rows, columns)| format!("{rows} × {columns}");
    match found == expected {
        true => Ok(()),
        false => {
            let (found, expected) = (shape(found), shape(expected));
            Err(BlackBoxError::Shape { what, rows, found, expected })
        }
    }
}
