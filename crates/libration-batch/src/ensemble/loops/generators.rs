//! The random generators of a block between two calls of its kernel.

use libration_core::random::{EPOCH, Purpose, Streams};

/// One generator per use.
type Each<const W: usize> = [Streams<W>; 3];

/// Uses of random words, in the order of the generators.
const PURPOSES: [Purpose; 3] = [Purpose::StepTime, Purpose::Latency, Purpose::Disturbance];

/// The generators of a block after the last kernel.
///
/// An observer ends a kernel at each of its steps. A kernel that begins within an epoch would draw all words of the
/// epoch again up to its first step, 128 times as many as one step needs.
pub(super) struct Generators<const W: usize> {
    /// The step of their next words; none before the first kernel.
    next: Option<u64>,
    streams: Each<W>,
}

impl<const W: usize> Generators<W> {
    /// Generators before the first kernel.
    pub(super) fn new() -> Self {
        Generators { next: None, streams: [Streams::none(); 3] }
    }

    /// The generators at `step` of the trajectories from `first` on, of which each step takes so many `words`.
    #[inline(always)]
    pub(super) fn at_step(&self, seed: u64, first: u64, step: u64, words: [usize; 3]) -> Each<W> {
        if self.next == Some(step) && !step.is_multiple_of(EPOCH) {
            return self.streams;
        }
        let mut streams = [Streams::none(); 3];
        for i in 0..3 {
            streams[i] = Streams::at_step(seed, first, step, PURPOSES[i], words[i]);
        }
        streams
    }

    /// Keeps the generators whose next words are those of `step`.
    #[inline(always)]
    pub(super) fn keep(&mut self, step: u64, streams: Each<W>, words: [usize; 3]) {
        self.next = Some(step);
        for i in 0..3 {
            if words[i] > 0 {
                self.streams[i] = streams[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use libration_core::State;
    use libration_core::control::clock::{Gaussian, Jittered};
    use libration_core::control::controller::StateFeedback;
    use libration_core::control::delay::Random;
    use libration_core::control::{Feedback, RandomLatency, WhiteNoise};
    use libration_core::integrator::SymplecticEuler;
    use libration_core::system::{BaselineOnly, Oscillator};

    use crate::checkpoint::Checkpoint;
    use crate::ensemble::{All, Copies, Execution, Loops, Setup};

    #[test]
    fn observed_loops_draw_the_words_of_loops_that_nobody_observes() {
        let table = RandomLatency::new(vec![(0.0, 0.5), (1.25, 0.5)], 0.25).unwrap();
        let setup = Setup::new(All(BaselineOnly(Oscillator { omega2: 4.0 })), SymplecticEuler)
            .clock(Jittered(Gaussian(0.1)))
            .controller(StateFeedback::to_origin(Feedback { position: 3.0, velocity: 0.5 }))
            .delay(Random(&table))
            .disturbance(WhiteNoise(0.1));
        // Full blocks, one that is not, and a lone trajectory.
        let starts: Vec<_> = (0..19).map(|n| State { q: [f64::from(n)], v: [0.25] }).collect();
        for count in [1, 19] {
            let start = &starts[..count];
            let fresh = || Loops::new(setup, 0.05, 11, [0.0], start, Execution::serial()).unwrap();
            let mut plain = fresh();
            plain.advance(600).unwrap();
            for every in [1, 7, 256] {
                let mut observed = fresh();
                for steps in [10, 300, 290] {
                    observed.observe(steps, every, Copies::new).unwrap();
                }
                assert!(observed.to_bytes() == plain.to_bytes(), "{count}, every {every}");
            }
        }
    }
}
