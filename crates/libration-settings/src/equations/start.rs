//! Another start of a system.

use libration::equations::Degree;

use super::EquationSystem;
use crate::suggestions;

impl EquationSystem {
    /// Begins elsewhere: at these values of the coordinates, of their velocities, and then of states by name, or of time as `t`.
    ///
    /// # Errors
    /// A sentence about the first value that does not fit, with its option.
    pub fn begin_at(
        &mut self,
        q: Option<&[f64]>,
        v: Option<&[f64]>,
        named: &[(String, f64)],
    ) -> Result<(), String> {
        let degrees = self.equations.degrees();
        let is_coordinate = |&i: &usize| matches!(degrees[i], Degree::Coordinate(_));
        let coordinates: Vec<usize> = (0..degrees.len()).filter(is_coordinate).collect();
        for (flag, given, values) in [("--q", q, &mut self.q), ("--v", v, &mut self.v)] {
            let Some(given) = given else { continue };
            if given.len() != coordinates.len() {
                return Err(format!(
                    "{flag} has {} numbers; `{}` has {} coordinates",
                    given.len(),
                    self.name,
                    coordinates.len()
                ));
            }
            coordinates.iter().zip(given).for_each(|(&i, &x)| values[i] = x);
        }
        for (name, x) in named {
            if !x.is_finite() {
                return Err(format!("--start {name}={x}: expected a finite number"));
            }
            let time = degrees.iter().position(|degree| *degree == Degree::Time);
            let state = self.states.iter().find(|state| state.name == *name);
            match (state.map(|state| state.place), time) {
                (Some(place), _) if place < degrees.len() => self.q[place] = *x,
                (Some(place), _) => self.v[place - degrees.len()] = *x,
                (None, Some(time)) if name == "t" => self.q[time] = *x,
                (None, _) => {
                    let known = self.states.iter().map(|state| state.name.as_str());
                    let help = suggestions::suggest("states", name, known);
                    return Err(format!(
                        "--start {name}={x}: unknown state `{name}`; help: {help}"
                    ));
                }
            }
        }
        let count = degrees.len();
        for state in &mut self.states {
            state.start = match state.place.checked_sub(count) {
                None => self.q[state.place],
                Some(i) => self.v[i],
            };
        }
        Ok(())
    }
}
