//! Checks of delays against the length of an episode.

use libration::rl::Delays;
use libration_settings::Fault;

/// Fails if a delay, in steps of `dt` seconds, is as long as an episode of so many actions, each of `substeps` steps.
pub(super) fn check_delays(
    delays: &Delays,
    limit: Option<u32>,
    substeps: u32,
    dt: f64,
) -> Result<(), Fault> {
    let episode = limit.map(|limit| u64::from(limit) * u64::from(substeps));
    for (key, [least, _]) in
        [("delays.observation", delays.observation), ("delays.action", delays.action)]
    {
        within_episode(key, least, episode, dt)?;
    }
    Ok(())
}

/// Checks that a delay of so many steps of `dt` seconds, the least of its kind, ends within an episode of so many.
fn within_episode(
    key: &'static str,
    steps: u32,
    episode: Option<u64>,
    dt: f64,
) -> Result<(), Fault> {
    match episode {
        Some(episode) if steps > 0 && u64::from(steps) >= episode => {
            let [late, lasts] = [f64::from(steps) * dt, episode as f64 * dt];
            let message = format!(
                "`{key}` is {steps} steps, {late} s, but an episode lasts {episode} steps, {lasts} s; expected less"
            );
            Err(Fault::new(key, message))
        }
        _ => Ok(()),
    }
}
