//! Rates of the state at any point, from steps that get shorter and shorter.

use core::cell::RefCell;

use libration::linear::MOST_STATES;
use libration::{State, System};

use crate::BlackBoxError;
use crate::flow::limit_of_halved;
use crate::prober::Prober;

/// Half of the most states: the degrees of freedom in which integrators step.
pub(crate) const HALF: usize = MOST_STATES / 2;
/// The longest step is the subject's by 2 to this power.
const FIRST: i32 = 3;
/// Steps from which a rate is extrapolated.
const LEVELS: i32 = 6;

/// A black box as a system of equations that integrators step: its rates are the limit of `(step(x, h) − x)/h`.
pub(crate) struct NumericalSystem<'p, 'b> {
    prober: RefCell<&'p mut Prober<'b>>,
    /// Positions and velocities; none: all states are of first order.
    pairs: Option<Vec<(usize, usize)>>,
    /// The largest estimated error of a rate, in units of the scales.
    error: RefCell<f64>,
    failure: RefCell<Option<BlackBoxError>>,
}

impl<'p, 'b> NumericalSystem<'p, 'b> {
    pub(crate) fn new(prober: &'p mut Prober<'b>, pairs: Option<Vec<(usize, usize)>>) -> Self {
        NumericalSystem {
            prober: RefCell::new(prober),
            pairs,
            error: RefCell::new(0.0),
            failure: RefCell::new(None),
        }
    }

    /// The largest error of a rate so far, or the failure of the simulator.
    pub(crate) fn outcome(self) -> Result<f64, BlackBoxError> {
        self.failure.into_inner().map_or_else(|| Ok(self.error.into_inner()), Err)
    }

    /// The states as a point of phase space.
    pub(crate) fn state(&self, x: &[f64]) -> State<f64, HALF> {
        let mut state = State::origin();
        for (place, (q, v)) in self.places(x.len()).into_iter().enumerate() {
            state.q[place] = x[q];
            if let Some(v) = v {
                state.v[place] = x[v];
            }
        }
        state
    }

    /// The point of phase space as states.
    pub(crate) fn values(&self, state: &State<f64, HALF>, count: usize) -> Vec<f64> {
        let mut x = vec![0.0; count];
        for (place, (q, v)) in self.places(count).into_iter().enumerate() {
            x[q] = state.q[place];
            if let Some(v) = v {
                x[v] = state.v[place];
            }
        }
        x
    }

    /// The states at each place of phase space. States of first order fill the positions, then the velocities.
    fn places(&self, count: usize) -> Vec<(usize, Option<usize>)> {
        match &self.pairs {
            Some(pairs) => pairs.iter().map(|&(q, v)| (q, Some(v))).collect(),
            None => {
                let half = count.div_ceil(2);
                (0..half).map(|i| (i, Some(half + i).filter(|v| *v < count))).collect()
            }
        }
    }

    fn rates(&self, x: &[f64]) -> Vec<f64> {
        let mut prober = self.prober.borrow_mut();
        match rates(&mut prober, x) {
            Ok((rates, error)) => {
                let largest = self.error.borrow().max(error);
                *self.error.borrow_mut() = largest;
                rates
            }
            Err(error) => {
                self.failure.borrow_mut().get_or_insert(error);
                vec![f64::NAN; x.len()]
            }
        }
    }

    fn count(&self) -> usize {
        self.prober.borrow().subject.state.len()
    }
}

impl System<f64, HALF> for NumericalSystem<'_, '_> {
    const BASELINE_ONLY: bool = true;

    fn acceleration(&self, state: &State<f64, HALF>) -> [f64; HALF] {
        self.state(&self.rates(&self.values(state, self.count()))).v
    }

    fn rate(&self, state: State<f64, HALF>) -> State<f64, HALF> {
        let rates = self.state(&self.rates(&self.values(&state, self.count())));
        // The rate of a position is its velocity, without the error of a difference.
        let q = if self.pairs.is_some() { state.v } else { rates.q };
        State { q, v: rates.v }
    }
}

/// The rates at `x`, and the largest estimated error of one in units of the scales.
fn rates(prober: &mut Prober<'_>, x: &[f64]) -> Result<(Vec<f64>, f64), BlackBoxError> {
    let subject = prober.subject;
    let mut levels: Vec<Vec<(f64, f64)>> = vec![Vec::new(); x.len()];
    for level in 0..LEVELS {
        let h = subject.dt * 2.0_f64.powi(-FIRST - level);
        let next = prober.step_one(x, &subject.action, h)?;
        for (i, levels) in levels.iter_mut().enumerate() {
            levels.push((
                (next[i] - x[i]) / h,
                2.0 * f64::EPSILON * x[i].abs().max(next[i].abs()) / h,
            ));
        }
    }
    let found: Vec<(f64, f64)> = levels.iter().map(|levels| limit_of_halved(levels)).collect();
    let error = found.iter().zip(&subject.state_scale).map(|((_, error), scale)| error / scale);
    Ok((found.iter().map(|(rate, _)| *rate).collect(), error.fold(0.0, f64::max)))
}
