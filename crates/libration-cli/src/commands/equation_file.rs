//! Files of equations.

use std::fmt::Display;
use std::path::Path;

use libration_analyze::equation_trajectory::EquationRequest;
use libration_analyze::{Stepping, Timing};
use libration_settings::equations::EquationSystem;

use crate::args::SimulateArgs;
use crate::error::Failure;

/// Reads the system of the equations in a file, with other values of some parameters.
pub(super) fn read(path: &Path, set: &[(String, f64)]) -> Result<EquationSystem, Failure> {
    let wrong = |why: &dyn Display| {
        Failure::usage(format!("cannot read `{}` (--system): {why}", path.display()))
    };
    let text = libration_settings::read_text(path).map_err(|error| wrong(&error))?;
    EquationSystem::parse(&text, &path.to_string_lossy(), set)
        .map_err(|error| Failure::Shown(error.render_styled()))
}

/// The request for a system by the equations of a file.
pub(super) fn simulation(args: &SimulateArgs, file: &Path) -> Result<EquationRequest, Failure> {
    let (Some(options), Some(step)) = (&args.system, &args.step) else {
        return Err(Failure::usage("--integrator and --dt are required with --system"));
    };
    let system = read(file, &options.set)?;
    let Stepping::Method(method) = step.integrator else {
        return Err(Failure::usage(
            "--integrator exact: exact steps require a linear system of the catalogue or --plant",
        ));
    };
    let unsupported = [
        ("--time-stamps", args.time_stamps.is_some()),
        ("--q", options.q.is_some()),
        ("--v", options.v.is_some()),
        ("a control loop", args.timing.timing() != Timing::default()),
    ];
    if let Some(flag) = unsupported.iter().find(|(_, given)| *given).map(|(flag, _)| *flag) {
        return Err(Failure::usage(format!("{flag} requires a system of the catalogue")));
    }
    Ok(EquationRequest {
        system,
        method,
        float: args.float,
        dt: step.dt,
        steps: args.steps,
        every: args.every,
        ensemble: args.ensemble()?,
    })
}
