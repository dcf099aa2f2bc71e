//! Many orbits of one step, until they close.

use libration::{Float, State};

/// Orbits that are stepped in turn: each waits for its own last step, and not for those of the others.
const ABREAST: usize = 4;

/// One orbit, seen at some steps.
#[derive(Clone, Debug)]
pub(super) struct Orbit {
    /// Measured values; NaN for an orbit beyond the range of the float.
    pub(super) seen: Vec<f64>,
    /// The step at which it was found to repeat itself, and the period.
    pub(super) repeats: Option<(u64, u64)>,
}

/// Follows the orbits from `starts` up to the last of the steps `sampled`, which rise, and measures there.
///
/// An orbit that has come back to where it was is not followed further: what comes is known (Brent, BIT 20, 176,
/// 1980).
pub(super) fn follow<F: Float>(
    starts: &[State<F, 1>],
    sampled: &[u64],
    step: impl Fn(State<F, 1>) -> State<F, 1> + Copy,
    measure: impl Fn(&State<F, 1>, &State<F, 1>) -> f64,
) -> Vec<Orbit> {
    let mut orbits = Vec::with_capacity(starts.len());
    for starts in starts.chunks(ABREAST) {
        let first = starts[0];
        let block: [State<F, 1>; ABREAST] =
            std::array::from_fn(|i| starts.get(i).copied().unwrap_or(first));
        orbits.extend(abreast(block, sampled, step, &measure).into_iter().take(starts.len()));
    }
    orbits
}

fn abreast<F: Float>(
    starts: [State<F, 1>; ABREAST],
    sampled: &[u64],
    step: impl Fn(State<F, 1>) -> State<F, 1> + Copy,
    measure: &impl Fn(&State<F, 1>, &State<F, 1>) -> f64,
) -> [Orbit; ABREAST] {
    let mut orbits = starts.map(|_| Orbit { seen: Vec::new(), repeats: None });
    let (mut states, mut waiting, mut since) = (starts, starts, 0);
    let mut n = 0;
    for (i, &next) in sampled.iter().enumerate() {
        while n < next {
            states = states.map(step);
            n += 1;
            for lane in 0..ABREAST {
                if states[lane] == waiting[lane] && orbits[lane].repeats.is_none() {
                    orbits[lane].repeats = Some((n, n - since));
                }
            }
            if n.is_power_of_two() {
                (waiting, since) = (states, n);
            }
            if orbits.iter().all(|orbit| orbit.repeats.is_some()) {
                for lane in 0..ABREAST {
                    let measured = |state: &State<F, 1>| measure(&starts[lane], state);
                    rest(&mut orbits[lane], (n, states[lane]), &sampled[i..], step, measured);
                }
                return orbits;
            }
        }
        for lane in 0..ABREAST {
            let seen = measure(&starts[lane], &states[lane]);
            orbits[lane].seen.push(seen);
        }
    }
    orbits
}

/// What an orbit that repeats itself, and is at `state` after `n` steps, will be at the steps `sampled`.
fn rest<F: Float>(
    orbit: &mut Orbit,
    (n, mut state): (u64, State<F, 1>),
    sampled: &[u64],
    step: impl Fn(State<F, 1>) -> State<F, 1>,
    measured: impl Fn(&State<F, 1>) -> f64,
) {
    let Some((_, period)) = orbit.repeats else { return };
    let mut ahead: Vec<(u64, usize)> =
        sampled.iter().enumerate().map(|(i, &at)| ((at - n) % period, i)).collect();
    ahead.sort_unstable();
    let begun = orbit.seen.len();
    orbit.seen.resize(begun + sampled.len(), f64::NAN);
    let mut taken = 0;
    for (steps, i) in ahead {
        for _ in taken..steps {
            state = step(state);
        }
        taken = steps;
        orbit.seen[begun + i] = measured(&state);
    }
}

#[cfg(test)]
mod tests {
    use half::f16;
    use libration::Integrator;
    use libration::integrator::VelocityVerlet;
    use libration::system::Oscillator;

    use super::*;

    #[test]
    fn orbits_that_are_cut_short_are_seen_as_if_every_step_were_taken() {
        let short = f16::from_f64;
        let system = Oscillator { omega2: short(10.0) };
        let step = |state| VelocityVerlet.step(&system, state, short(0.01));
        let starts: Vec<State<f16, 1>> = (0..6)
            .map(|i| State { q: [short(1.0 + 0.1 * f64::from(i))], v: [short(0.3)] })
            .collect();
        let sampled = [1, 10, 777, 5_000, 60_000, 100_001, 123_456];
        let position = |_: &State<f16, 1>, state: &State<f16, 1>| state.q[0].to_f64();
        let orbits = follow(&starts, &sampled, step, position);
        assert_eq!(orbits.len(), starts.len());
        for (orbit, &start) in orbits.iter().zip(&starts) {
            assert!(orbit.repeats.is_some());
            let mut state = start;
            let mut all = vec![state.q[0].to_f64()];
            for _ in 0..123_456 {
                state = step(state);
                all.push(state.q[0].to_f64());
            }
            let expected: Vec<f64> = sampled.iter().map(|&n| all[n as usize]).collect();
            assert_eq!(orbit.seen, expected);
        }
    }
}
