//! Loops around systems by equations.

use libration::{AnyMethod, Method};
use libration_analyze::linear_trajectory::LinearRequest;
use libration_analyze::trajectory::FloatType;
use libration_analyze::{Stepping, Timing};

use super::equation_file;
use crate::args::{SimulateArgs, SystemArgs};
use crate::error::Failure;

/// Steps in a period where `--dt` is not given.
const STEPS: f64 = 10.0;

/// The request for the loop of `--system FILE` with `--lqr` or `--gain`; none without them.
pub(super) fn request(args: &SimulateArgs) -> Option<Result<LinearRequest, Failure>> {
    let (path, system) = (args.looped_file()?, args.system.as_ref()?);
    Some(of_file(args, path, system))
}

fn of_file(
    args: &SimulateArgs,
    path: &std::path::Path,
    options: &SystemArgs,
) -> Result<LinearRequest, Failure> {
    let unsupported = [
        ("--q", options.q.is_some()),
        ("--v", options.v.is_some()),
        ("--start", !options.start.is_empty()),
        ("--time-stamps", args.time_stamps.is_some()),
        ("--dtype", args.dtype != FloatType::F64),
        ("--feedback and --skew", {
            let Timing { feedback, skew, .. } = args.timing.timing();
            feedback.is_some() || skew.is_some()
        }),
    ];
    if let Some((flag, _)) = unsupported.iter().find(|(_, given)| *given) {
        return Err(Failure::usage(format!(
            "{flag} cannot be combined with --system FILE and --lqr or --gain: the loop runs from the `start` of the file, in f64, on an even clock or with --jitter"
        )));
    }
    let (looped, request) = args.loop_around(path, options)?;
    let system = equation_file::read(path, &options.set)?;
    let Some(point) = looped.operating_point() else {
        return Err(Failure::usage("the plant of the file has no operating point"));
    };
    let (method, longest_step) = match &args.step {
        None => (AnyMethod::from(Method::Rk4), request.linear.period() / STEPS),
        Some(step) => match step.integrator {
            Stepping::Method(method) => (AnyMethod::from(method), step.dt),
            Stepping::Implicit(method) => (method.into(), step.dt),
            Stepping::Exact => {
                return Err(Failure::usage(
                    "--integrator exact: exact steps are those of the linearised plant: --plant FILE",
                ));
            }
        },
    };
    request.around_system(&system, point, method, longest_step).map_err(Failure::usage)
}
