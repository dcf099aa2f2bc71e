//! The settings of the live sections of pages.

use libration::AnyMethod;
use libration::control::Jitter;
use libration::live::{Control as LiveControl, Setting, answer};
use libration_report::live::LiveSetting;
use libration_report::page::Page;
use libration_report::verdict::Outcome;
use libration_settings::live_settings;

use super::advice::Advice;
use super::control::{Control, Law};
use super::request::Request;

/// The system of a request, with its loop; none where the loop is no feedback of position and velocity around an equilibrium.
pub(super) fn of_request(request: &Request) -> Option<Setting> {
    let mut setting = live_settings::of_system(&request.system);
    setting.horizon = request.horizon;
    let names = setting.definitions.coordinates.clone();
    let Some(control) = &request.control else { return Some(setting) };
    let Control { law, period, latency, jitter, skew, loss, record, deviation, .. } = control;
    let (Law::Pd(gains), None) = (law, record) else { return None };
    setting.start = vec![(names.first()?.clone(), request.system.q.first()? + deviation)];
    setting.dt = *period;
    setting.control = Some(LiveControl {
        gain: vec![vec![gains.position, gains.velocity]],
        period: *period,
        latency: *latency,
        jitter: gaussian(*jitter)?,
        skew: *skew,
        loss: *loss,
        ..LiveControl::default()
    });
    Some(setting)
}

/// The rms of a Gaussian law within what a page draws; none of other laws.
pub(super) fn gaussian(law: Jitter) -> Option<f64> {
    match law {
        law if law.rms() == 0.0 => Some(0.0),
        Jitter::Gaussian(rms) => Some(rms).filter(|rms| *rms <= law.largest_rms()),
        Jitter::Uniform(_) => None,
    }
}

/// The setting of a page about this advice, in the advised steps; none where the loop has none.
pub(super) fn of_advice(advice: &Advice) -> Option<Setting> {
    let mut setting = advice.live.clone()?;
    let chosen = advice
        .chosen()
        .and_then(|(choice, dt)| Some((AnyMethod::from_name(choice.integrator)?, dt)));
    if let Some((method, dt)) = chosen {
        (setting.integrator, setting.dt) = (method, dt);
    }
    Some(setting)
}

/// Why a page about a loop without a setting has no live section.
const NO_LIVE_SECTION: &str = "This page cannot run the loop itself: a live section requires feedback of all states around an equilibrium without commands, the \
     same latency for all commands and none for measurements, and jitter that is Gaussian with an rms of at most 1/3. `libration serve` \
     shows the system with such a loop.";

/// Why a page with an unknown verdict has no live section, which has a verdict of its own.
const UNKNOWN: &str = "This page has no live section, as its verdict is unknown.";

/// Adds a live section to a page with this verdict, or a note with the reason why there is none.
pub(super) fn add_live_section(page: &mut Page, setting: Option<Setting>, outcome: Outcome) {
    let Some(setting) = setting.filter(|_| outcome != Outcome::Unknown) else {
        let is_unknown = outcome == Outcome::Unknown;
        page.note(if is_unknown { UNKNOWN } else { NO_LIVE_SECTION });
        return;
    };
    // The engine in the page would refuse what this one refuses.
    match answer(&format!("view\n{setting}")).get_text("error") {
        "" => {
            page.live =
                vec![LiveSetting { title: setting.system.clone(), text: setting.to_string() }];
        }
        why => page.note(format!("This page has no live section: {why}.")),
    }
}
