//! Inner steps of a fixed length: a shorter step of the simulator has no effect, or one that does not depend on its length.

use libration_report::notation::number;
use serde::Serialize;

use crate::BlackBoxError;
use crate::convergence::displaced;
use crate::prober::{Prober, row};

/// Halvings of the step that are tried, of a simulator without memory and of one with it, whose calls are repeated.
const HALVINGS: [i32; 2] = [16, 5];
/// Doublings that are tried where the step itself has no effect.
const DOUBLINGS: i32 = 8;
/// Parts of the scales by which the two starts are displaced.
const DISPLACEMENTS: [f64; 2] = [0.1, -0.07];
/// Changes relative to a state that are far above rounding.
const VISIBLE: f64 = 1e-9;
/// Roundings of coarse results that a change must exceed.
const ROUNDINGS: f64 = 1e3;
/// Lengths of the step in a row that have the same result.
const SAME: usize = 4;

/// The evidence that a simulator divides a step into inner steps of a fixed length, or rounds its length: it has no limit of small steps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InnerStep {
    /// The longest step that was tried without an effect, or with that of shorter ones, in s.
    pub longest_dt: f64,
    /// The state whose change does not depend on the length; none: no state changes.
    pub state: Option<String>,
}

impl InnerStep {
    pub(crate) fn measure(prober: &mut Prober<'_>) -> Result<Option<Self>, BlackBoxError> {
        let mut found: Option<InnerStep> = None;
        for displacement in DISPLACEMENTS {
            // A limit of a state, or an imposed command, may have the same result once: two starts must agree.
            match InnerStep::from(prober, displacement)? {
                None => return Ok(None),
                Some(other) => match &found {
                    Some(first) if first.state != other.state => return Ok(None),
                    _ => found = Some(other),
                },
            }
        }
        Ok(found)
    }

    fn from(prober: &mut Prober<'_>, displacement: f64) -> Result<Option<Self>, BlackBoxError> {
        let subject = prober.subject;
        let start = displaced(prober, displacement);
        let scales = subject.action.iter().zip(&subject.action_scale);
        let action: Vec<f64> = scales.map(|(u, scale)| u + scale / 64.0).collect();
        let length = |halvings: i32| subject.dt * 2.0_f64.powi(-halvings);
        let step = |prober: &mut Prober<'_>, halvings: i32| {
            Ok::<_, BlackBoxError>(
                prober.step(&row(&start), &row(&action), length(halvings))?.entries().to_vec(),
            )
        };
        let whole = step(prober, 0)?;
        if whole == start {
            for doublings in 1..=DOUBLINGS {
                let longer = step(prober, -doublings)?;
                if longer.iter().all(|x| x.is_finite()) && longer != start {
                    return Ok(Some(InnerStep { longest_dt: length(1 - doublings), state: None }));
                }
            }
            return Ok(None);
        }
        let most = HALVINGS[usize::from(prober.memory > 0)];
        // Changes that the step would have in proportion to its length, and that rounding would not hide.
        let is_visible = |halvings: i32| {
            (0..start.len()).any(|i| {
                let change = (whole[i] - start[i]).abs() * 2.0_f64.powi(-halvings);
                let size = start[i].abs().max(0.01 * subject.state_scale[i]);
                change > size * VISIBLE.max(ROUNDINGS * prober.coarseness)
            })
        };
        let visible = (1..=most).take_while(|halvings| is_visible(*halvings)).count() as i32;
        let mut results = vec![whole.clone()];
        for halvings in 1..=visible {
            results.push(step(prober, halvings)?);
        }
        let unchanged = results.iter().rev().take_while(|x| **x == start).count();
        if unchanged > 0 {
            let longest_dt = length((results.len() - unchanged) as i32);
            return Ok(Some(InnerStep { longest_dt, state: None }));
        }
        let last = results.last().unwrap_or(&whole);
        let same = |i: usize| results.iter().rev().take_while(|x| x[i] == last[i]).count();
        let state = (0..start.len()).find(|i| last[*i] != start[*i] && same(*i) >= SAME);
        if state.is_some_and(|i| same(i) == results.len()) && results[0] == *last {
            // A simulator that ignores the length altogether has another finding.
            let mut is_longer = false;
            for doublings in 1..=DOUBLINGS {
                is_longer |= step(prober, -doublings)? != whole;
            }
            if !is_longer {
                return Ok(None);
            }
        }
        let longest = |i| length((results.len() - same(i)) as i32);
        Ok(state.map(|i| InnerStep {
            longest_dt: longest(i),
            state: Some(subject.states[i].name.clone()),
        }))
    }

    /// The evidence, in words.
    pub(crate) fn in_words(&self) -> String {
        let longest = number(self.longest_dt, 4);
        let what = match &self.state {
            None => format!("a step of {longest} s or less changes nothing, and a longer one does"),
            Some(state) => {
                format!("`{state}` changes by the same amount in each step of {longest} s or less")
            }
        };
        format!(
            "{what}: inner steps have a fixed length, or the length is rounded; the system that the step approximates is unknown"
        )
    }
}
