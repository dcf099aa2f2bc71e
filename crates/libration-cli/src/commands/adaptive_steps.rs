//! `libration simulate --adaptive`.

use libration::{AnyMethod, Method};
use libration_analyze::adaptive::{AdaptiveRequest, StepControl};
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
    if args.dtype != FloatType::F64 {
        let float = args.dtype.name();
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
    if args.has_duration() {
        return Err(Failure::usage(
            "--duration: the steps of --adaptive have no equal length; expected --steps",
        ));
    }
    let (dt, steps, every) = (step.dt, args.steps_of(step.dt)?, args.every);
    let system = equation_file::any_system(options)?;
    Ok(AdaptiveRequest { system, method, control, dt, steps, every })
}
