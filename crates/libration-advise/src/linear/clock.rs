//! The clock of a controller.

use libration::linear::ClockedController;
use libration_settings::linear_loop::{Design, Part};
use libration_settings::{Fault, suggestions};

/// The controller with its filters of samples that measures time, if `clock` says so.
pub(super) fn clocked(
    clock: &str,
    design: &Design,
    parts: &[Part],
    period: f64,
) -> Result<Option<ClockedController>, Fault> {
    match clock {
        "nominal" => return Ok(None),
        "measured" if design.cascade.is_some() => {
            let message = "`clock` is \"measured\", but the controller is a cascade, whose outer controller would measure several periods; expected \"nominal\"";
            return Err(Fault::new("loop.clock", message));
        }
        "measured" => {}
        other => {
            let fault = Fault::new("loop.clock", format!("unknown value `{other}` of `clock`"));
            let known = ["nominal", "measured"];
            return Err(fault.help(suggestions::suggest("values", other, known)));
        }
    }
    if design.clocked.is_none() && !parts.iter().any(Part::counts_seconds) {
        let message = "`clock` is \"measured\", but nothing in the controller depends on the length of a period; expected \"nominal\"";
        return Err(Fault::new("loop.clock", message));
    }
    let (own, nominal) = (design.clocked.clone(), design.controllers.clone());
    let (plant, parts) = (design.plant.clone(), parts.to_vec());
    let of_length = move |seconds| {
        let own = own.as_ref().map_or_else(|| nominal.clone(), |own| own.at(seconds).into());
        Part::filtered(&parts, &own, &plant, seconds).at(0).clone()
    };
    Ok(Some(ClockedController::new(period, of_length)))
}
