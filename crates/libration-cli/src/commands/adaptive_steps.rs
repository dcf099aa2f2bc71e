//! `libration simulate --adaptive`.

use libration::ensemble::dynamics_of;
use libration::{AnyMethod, Method};
use libration_analyze::adaptive::{AdaptiveRequest, AdaptiveState, StepControl};
use libration_analyze::trajectory::FloatType;

use super::equation_file;
use crate::args::SimulateArgs;
use crate::error::Failure;

/// The request of the options.
pub(super) fn request(
    args: &SimulateArgs,
    control: StepControl,
) -> Result<AdaptiveRequest, Failure> {
    let (Some(options), Some(step)) = (&args.system, &args.step) else {
        return Err(Failure::usage("--adaptive requires --system, --integrator and --dt"));
    };
    if args.float != FloatType::F64 {
        let float = args.float.name();
        return Err(Failure::usage(format!("--dtype {float}: --adaptive has f64 only")));
    }
    let method: Method = match step.integrator.any_method() {
        Some(AnyMethod::Explicit(method)) => method,
        _ => {
            let name = step.integrator.name();
            return Err(Failure::usage(format!(
                "--integrator {name}: --adaptive requires an explicit integrator"
            )));
        }
    };
    let (dt, steps, every) = (step.dt, args.steps, args.every);
    match equation_file::system(options) {
        Some(system) => {
            let system = system?;
            let states = system.states.iter().map(|state| AdaptiveState {
                place: state.place,
                name: state.name.clone(),
                unit: state.unit.clone(),
            });
            Ok(AdaptiveRequest {
                dynamics: system.equations.dynamics().clone(),
                start: system.q.iter().chain(&system.v).copied().collect(),
                states: states.collect(),
                energy_unit: system.energy_unit.clone(),
                system: system.name,
                method,
                control,
                dt,
                steps,
                every,
            })
        }
        None => {
            let problem = options.resolve()?;
            let degrees = problem.q.len();
            let dynamics = dynamics_of(problem.system, degrees)
                .ok_or_else(|| Failure::usage(problem.system.entry().wrong_dimension(degrees)))?;
            let state = |place: usize| AdaptiveState {
                place,
                name: match place.checked_sub(degrees) {
                    Some(velocity) => format!("v{velocity}"),
                    None => format!("q{place}"),
                },
                unit: String::new(),
            };
            Ok(AdaptiveRequest {
                dynamics,
                start: problem.q.iter().chain(&problem.v).copied().collect(),
                states: (0..2 * degrees).map(state).collect(),
                energy_unit: String::new(),
                system: problem.system.name().to_owned(),
                method,
                control,
                dt,
                steps,
                every,
            })
        }
    }
}
