//! The setting of the live section of a page about a simulator.

use libration::AnyMethod;
use libration::live::{MOST_DEGREES, Setting};
use libration_report::live::LiveSetting;
use libration_report::verdict::Outcome;

use crate::ProbeReport;
use crate::noise_free_matrix::without_noise;

/// Why the page of an unknown verdict has no live section.
pub(crate) const NO_LIVE_SECTION: &str = "The page has no live section: its verdict would be that of the matrices, and that of the step is unknown.";

/// The linearised simulator in steps of its length, from which a reader may change gains and timing; none of a simulator whose steps have
/// one length only, that is too large, or of which the verdict is unknown.
pub(crate) fn live_settings(audit: &ProbeReport) -> Vec<LiveSetting> {
    // The live section has a verdict of its own, on the matrices.
    if audit.verdict.outcome == Outcome::Unknown {
        return Vec::new();
    }
    let Some(flow) = audit.flow.as_ref().filter(|flow| flow.a.rows() <= MOST_DEGREES) else {
        return Vec::new();
    };
    let names = |given: &[String]| {
        given.iter().map(|name| name.split(' ').next().unwrap_or_default().to_owned()).collect()
    };
    let names = [names(&audit.states), names(&audit.inputs)];
    let a = without_noise(&flow.a, &flow.a_errors);
    let mut setting = Setting::of_plant("the simulator, linearised", &a, &flow.b, names);
    // Its own integrator, where it is known and this form of the plant has positions and velocities.
    let recognised = audit.recognition.as_ref().and_then(|own| own.by_results.methods.first());
    let mechanical = !setting.definitions.coordinates.is_empty();
    if let Some(method) =
        recognised.and_then(|name| AnyMethod::from_name(name)).filter(|_| mechanical)
    {
        setting.integrator = method;
    }
    setting.dt = audit.dt;
    setting.horizon = setting.horizon.max(100.0 * audit.dt);
    vec![LiveSetting { title: setting.system.clone(), text: setting.to_string() }]
}
