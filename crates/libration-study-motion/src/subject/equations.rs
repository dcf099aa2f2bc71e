//! Systems by the equations of a file as subjects of studies.

use libration::analysis::jacobian;
use libration::linear::{Matrix, eigenvalues};
use libration_settings::equations::EquationSystem;
use libration_settings::linear_loop::linearised_equations;

use super::{Problem, StudiedState};

/// The angle in rad by which the fastest mode must turn in a turn of the motion.
const NO_LINEAR_PART: f64 = 1e-6;

/// Part of the fastest rate below which a real part is rounding.
const ROUNDING: f64 = 1e-9;

impl Problem {
    /// A system by its equations, from its start and with inputs that are zero.
    ///
    /// A turn is 2π over the largest eigenvalue of the equations, linearised at the start and at the equilibrium nearest to it. Where
    /// all are zero it is the time in which the state changes by its own size, or 1 s.
    pub fn of_equations(system: &EquationSystem) -> Self {
        let dynamics = system.equations.dynamics().clone();
        let start: Vec<f64> = system.q.iter().chain(&system.v).copied().collect();
        let states = system.states.iter().map(|state| StudiedState {
            place: state.place,
            name: state.name.clone(),
            unit: state.unit.clone(),
        });
        let at_start = system.state_matrix(&jacobian(&dynamics, &system.start()));
        let equilibrium = linearised_equations(system).ok();
        let at_rest = equilibrium.as_ref().and_then(|(plant, _)| fastest(&plant.a));
        let rate = [fastest(&at_start), at_rest].into_iter().flatten().reduce(f64::max);
        let rate = rate.filter(|&rate| rate > 0.0).or_else(|| rate_of_motion(system));
        let turn = rate.map_or(1.0, |rate| std::f64::consts::TAU / rate);
        let turn = if turn.is_normal() { turn } else { 1.0 };
        let mut problem =
            Problem::of_program(&system.name, dynamics, start, turn, states.collect());
        problem.equilibrium = equilibrium
            .filter(|(plant, _)| problem.has_linear_part(&plant.a) && is_undamped(&plant.a))
            .map(|(_, point)| point.state_of(system))
            .map(|mut state| {
                state.truncate(problem.start.len());
                state
            });
        problem
    }

    /// Whether equations with these derivatives have a linear part at an equilibrium, beside what Newton's method leaves of others.
    pub fn has_linear_part(&self, a: &Matrix) -> bool {
        fastest(a).is_some_and(|rate| rate * self.turn > NO_LINEAR_PART)
    }
}

/// The largest eigenvalue by size; none if none is finite.
fn fastest(matrix: &Matrix) -> Option<f64> {
    let values = eigenvalues(matrix).unwrap_or_default();
    values.iter().map(|value| value.norm()).filter(|size| size.is_finite()).reduce(f64::max)
}

/// The largest rate of a state, over the largest state; none if nothing moves.
fn rate_of_motion(system: &EquationSystem) -> Option<f64> {
    let start = system.start();
    let degrees = system.equations.degrees().len();
    let accelerations: Vec<f64> =
        system.equations.dynamics().accelerations().on::<f64>().run(&start).collect();
    let rate = |place: usize| match place.checked_sub(degrees) {
        Some(i) => accelerations[i],
        None => start[degrees + place],
    };
    let largest = |of: &dyn Fn(usize) -> f64| {
        system.states.iter().map(|state| of(state.place).abs()).fold(0.0, f64::max)
    };
    let (rates, sizes) = (largest(&rate), largest(&|place| start[place]));
    Some(rates / sizes).filter(|rate| rate.is_finite() && *rate > 0.0)
}

/// Whether all modes about an equilibrium oscillate, and none grows, decays or depends on velocities: there the stability limit of
/// an integrator is that of the fastest mode.
fn is_undamped(a: &Matrix) -> bool {
    let n = a.rows() / 2;
    let is_mechanical = a.rows().is_multiple_of(2)
        && (0..n).all(|i| (0..2 * n).all(|j| a[(i, j)] == f64::from(u8::from(j == n + i))));
    let is_positional = || (n..2 * n).all(|i| (n..2 * n).all(|j| a[(i, j)] == 0.0));
    let oscillate = || {
        let values = eigenvalues(a).unwrap_or_default();
        let fastest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let is_slow = |x: f64| x.abs() <= ROUNDING * fastest;
        values.iter().all(|value| is_slow(value.re) && !is_slow(value.im))
    };
    n > 0 && is_mechanical && is_positional() && oscillate()
}

#[cfg(test)]
mod tests {
    use libration::Method;

    use super::*;

    fn problem(system: &str) -> Problem {
        let text = format!("[system]\nname = \"own\"\n{system}\n");
        Problem::of_equations(&EquationSystem::parse(&text, "own.toml", &[]).unwrap())
    }

    fn names(problem: &Problem) -> Vec<&str> {
        problem.states().iter().map(|state| state.name.as_str()).collect()
    }

    #[test]
    fn a_turn_is_that_of_the_fastest_mode_at_the_start_or_at_the_equilibrium() {
        // Eigenvalues ±3i at the equilibrium; at the start, where the spring stiffens, ±√(9 + 3·4)·i.
        let own =
            problem("coordinates = [\"x\"]\nacceleration.x = \"-9*x - x^3\"\nstart = { x = 2 }");
        assert!((own.turn() - std::f64::consts::TAU / 21_f64.sqrt()).abs() < 1e-12);
        assert!((own.frequency().unwrap() - 3.0).abs() < 1e-12);
        // Nothing is linear in a free fall: the state of 2 changes at a rate of 10.
        let fall = problem("coordinates = [\"x\"]\nacceleration.x = \"-10\"\nstart = { x = 2 }");
        assert!((fall.turn() - std::f64::consts::TAU / 5.0).abs() < 1e-12);
        assert_eq!(fall.frequency(), None);
    }

    #[test]
    fn time_and_the_integral_of_a_state_of_first_order_are_no_states_under_study() {
        let own =
            problem("coordinates = [\"x\"]\nacceleration.x = \"-x + i + cos(t)\"\nrate.i = \"-i\"");
        assert_eq!(names(&own), ["x", "x'", "i"]);
        let law = own.law();
        assert!(law.velocity_dependent && !law.has_potential);
    }

    #[test]
    fn friction_leaves_no_small_orbits_and_lowers_the_order_of_kicks() {
        let own =
            problem("coordinates = [\"x\"]\nacceleration.x = \"-x - 0.1*x'\"\nstart = { x = 1 }");
        assert_eq!(own.frequency(), None);
        assert_eq!(own.derived_order(Method::VelocityVerlet), Some(1));
        assert_eq!(own.derived_order(Method::Rk4), Some(4));
    }

    #[test]
    fn masses_that_differ_leave_the_form_of_positions_and_velocities() {
        let chain = |mass: f64| {
            problem(&format!(
                "coordinates = [\"x\", \"y\"]\nparameters = {{ m = {mass} }}\n\
                 acceleration.x = \"y - 2*x\"\nacceleration.y = \"(x - 2*y)/m\"\nstart = {{ x = 1 }}"
            ))
        };
        assert!(chain(1.0).law().has_potential);
        assert!(!chain(2.0).law().has_potential);
    }

    #[test]
    fn an_orbit_in_one_degree_of_freedom_closes_if_it_comes_back() {
        let own = |force: &str, v: f64| {
            problem(&format!(
                "coordinates = [\"x\"]\nacceleration.x = \"{force}\"\nstart = {{ x = 0.5, \"x'\" = {v} }}"
            ))
        };
        assert!(own("-sin(x)", 1.0).closes());
        // Over the top it turns for ever, and a throw falls.
        assert!(!own("-sin(x)", 3.0).closes());
        assert!(!own("-10", 5.0).closes());
        // Beyond the barrier at 1 nothing comes back.
        assert!(!own("-x + x^3", 1.0).closes());
    }
}
