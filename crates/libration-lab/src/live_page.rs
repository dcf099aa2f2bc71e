//! The settings of the live section of a report.

use libration::AnySystem;
use libration::live::Setting;
use libration_report::live::LiveSetting;
use libration_settings::live_settings;
use libration_study::Config;

use crate::results::StudiedSystem;

/// The system of the report first, then all examples.
pub(crate) fn settings(config: &Config, system: Option<&StudiedSystem>) -> Vec<LiveSetting> {
    let own = match system {
        Some(system) => Some(system.live.clone()),
        None => oscillator(config),
    };
    own.into_iter()
        .chain(live_settings::examples())
        .map(|own| LiveSetting { title: own.system.clone(), text: own.to_string() })
        .collect()
}

/// The oscillator of a configuration, whose commands are forces.
fn oscillator(config: &Config) -> Option<Setting> {
    let (spring, start) = (config.oscillator, config.start);
    let values = [("m", spring.m), ("k", spring.k)];
    let system = AnySystem::build("oscillator", &values).ok()?;
    let mut setting = Setting::of_system(system, Some(spring.m));
    setting.system = "oscillator of this report".into();
    setting.start = vec![("q".into(), start.q), ("q'".into(), start.v)];
    Some(setting)
}
