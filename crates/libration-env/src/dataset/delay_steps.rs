//! Delays in steps of the integrator.

use libration::rl::Delays;
use libration_settings::Fault;
use libration_settings::duration::Duration;

use super::tables::LatencyRange;

/// The most steps of a delay.
const MOST: f64 = 4096.0;

/// Parts of a step by which a latency may miss whole ones: the quotient of two doubles is accurate to some 1e-16, and 1e-9 of a step is no
/// intended fraction.
const NEAR: f64 = 1e-9;

/// A range of latencies in steps of `dt` seconds.
pub(super) fn delay_steps(
    key: &'static str,
    range: LatencyRange,
    dt: f64,
) -> Result<[u32; 2], Fault> {
    let ends = match range {
        LatencyRange::One(one) => [one; 2],
        LatencyRange::Ends(ends) => ends,
    };
    let [least, most] = ends.map(|Duration(seconds)| whole_steps(key, seconds, dt));
    let (least, most) = (least?, most?);
    if least > most {
        let [Duration(low), Duration(high)] = ends;
        let message = format!("`{key}` is from {low} s to {high} s, but it must rise");
        return Err(Fault::new(key, message));
    }
    Ok([least, most])
}

fn whole_steps(key: &'static str, seconds: f64, dt: f64) -> Result<u32, Fault> {
    let exact = seconds / dt;
    let whole = exact.round();
    // Six decimals are enough to see how much is missing.
    let shown = (exact * 1e6).round() / 1e6;
    let wrong = if !(seconds >= 0.0 && seconds.is_finite()) {
        "but it must be finite and at least 0".to_owned()
    } else if whole > MOST {
        format!("{shown} steps of {dt} s, but it must be at most {MOST} of them")
    } else if (exact - whole).abs() > NEAR * exact.max(1.0) {
        format!("{shown} steps of {dt} s, but it must be whole steps")
    } else {
        return Ok(whole as u32);
    };
    Err(Fault::new(key, format!("`{key}` is {seconds} s, {wrong}")))
}

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
