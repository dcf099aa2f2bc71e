//! The setting of the live section of a page about a loop around a linear plant.

use libration::linear::MissingCommand;
use libration::live::{Control, Setting};
use libration_settings::live_settings;

use super::LinearRequest;
use crate::live_setting::gaussian;

/// The plant of a request with its loop; none where the loop is more than a feedback of all states, or its channels differ.
pub(super) fn live_setting(request: &LinearRequest) -> Option<Setting> {
    let LinearRequest { plant, parts, design, timed, .. } = request;
    let gain = design.gain.as_ref().filter(|_| design.filter.is_none() && parts.is_empty())?;
    let timing = &timed.timing;
    let period = timed.linear.period();
    let memoryless = timed.linear.controller().memory() == 0;
    let [first, others @ ..] = &timing.input_latency[..] else { return None };
    let together = others.iter().all(|other| other == first);
    let in_time = timing.output_latency.iter().all(|latency| *latency == 0.0);
    let continuous = plant.sampling_period.is_none();
    let plain = timing.record.is_none() && timing.missing == MissingCommand::Hold;
    if !(memoryless && together && in_time && continuous && plain) {
        return None;
    }
    let names = |signals: &[libration::linear::Signal]| {
        signals.iter().map(|signal| signal.name.clone()).collect::<Vec<_>>()
    };
    let names = [names(&plant.states), names(&plant.inputs)];
    // A loop around the system itself where its equations are known.
    let mut setting = match request.system.as_ref().filter(|_| !request.has_stated_point) {
        Some(system) => live_settings::of_system(system),
        None => Setting::of_plant("plant", &plant.a, &plant.b, names),
    };
    if setting.definitions.inputs.len() != plant.inputs.len() {
        return None;
    }
    setting.dt = setting.dt.min(period);
    setting.control = Some(Control {
        gain: (0..gain.rows()).map(|i| gain.row(i).to_vec()).collect(),
        period,
        latency: *first,
        jitter: gaussian(timing.jitter)?,
        skew: timing.skew,
        loss: timing.loss,
        ..Control::default()
    });
    Some(setting)
}
