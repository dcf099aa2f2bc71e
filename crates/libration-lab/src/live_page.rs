//! The settings of the live section of a report.

use libration::catalog;
use libration::live::Setting;
use libration_report::live::LiveSetting;
use libration_settings::equations::EquationSystem;
use libration_settings::live_settings;
use libration_study::Config;

use crate::results::StudiedSystem;

/// The system of a reader alone; the oscillator of the report, and behind it all examples.
pub(crate) fn settings(config: &Config, system: Option<&StudiedSystem>) -> Vec<LiveSetting> {
    let all: Vec<Setting> = match system {
        Some(system) => vec![system.live.clone()],
        None => oscillator(config).into_iter().chain(live_settings::examples()).collect(),
    };
    let shown = |own: Setting| LiveSetting { title: own.system.clone(), text: own.to_string() };
    all.into_iter().map(shown).collect()
}

/// The oscillator of a configuration, whose commands are forces.
fn oscillator(config: &Config) -> Option<Setting> {
    let (spring, start) = (config.oscillator, config.start);
    let values = [("m", spring.m), ("k", spring.k)];
    let built = catalog::build("oscillator", &values).ok()?;
    let system = EquationSystem::of_catalogue(built, Some(&[start.q]), Some(&[start.v])).ok()?;
    let mut setting = live_settings::of_system(&system);
    setting.system = "oscillator of this report".into();
    Some(setting)
}
