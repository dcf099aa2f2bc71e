//! Methods of Langevin dynamics.

use core::fmt;
use core::str::FromStr;

use thiserror::Error;

use super::{LangevinLetter, LangevinStep, LangevinWord, WordError};
use crate::array::each;
use crate::{Scalar, State, System};

/// A method of Langevin dynamics.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum LangevinMethod {
    /// A splitting into exact flows.
    Word(LangevinWord),
    /// The method of N. Grønbech-Jensen and O. Farago, *A simple and effective Verlet-type algorithm for simulating Langevin dynamics*,
    /// Molecular Physics 111, 2013.
    Gjf,
    /// The method of G. Maruyama, *Continuous Markov processes and stochastic equations*, 1955: explicit Euler with noise,
    /// `q += h·v` and `v += h·(a(q) − γv) + √(2γh·kT/m)·ξ`, both of the state at the start.
    EulerMaruyama,
}

/// The names of methods that are no words.
const NAMES: [(&str, LangevinMethod); 2] =
    [("gjf", LangevinMethod::Gjf), ("euler-maruyama", LangevinMethod::EulerMaruyama)];

/// Error of the name of a method.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("thermostat `{name}`: {word}; or one of {}", NAMES.map(|(name, _)| name).join(", "))]
pub struct UnknownThermostat {
    /// The name.
    pub name: String,
    /// Why it is no word.
    pub word: WordError,
}

impl FromStr for LangevinMethod {
    type Err = UnknownThermostat;

    /// A name, or a word of the letters A, B and O.
    fn from_str(text: &str) -> Result<Self, UnknownThermostat> {
        let known = NAMES.into_iter().find(|(name, _)| text.eq_ignore_ascii_case(name));
        match known {
            Some((_, method)) => Ok(method),
            None => text
                .parse()
                .map(LangevinMethod::Word)
                .map_err(|word| UnknownThermostat { name: text.to_owned(), word }),
        }
    }
}

impl fmt::Display for LangevinMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = NAMES.iter().find(|(_, method)| method == self);
        match (self, named) {
            (LangevinMethod::Word(word), _) => fmt::Display::fmt(word, f),
            (_, Some((name, _))) => f.write_str(name),
            (_, None) => Ok(()),
        }
    }
}

impl LangevinMethod {
    /// The words of the literature, and the methods that are no words.
    pub fn common() -> Vec<Self> {
        let words = ["BAOAB", "ABOBA", "OBABO", "OABAO", "BAOA", "OBAB"];
        let words =
            words.into_iter().filter_map(|word| word.parse().ok()).map(LangevinMethod::Word);
        words.chain(NAMES.map(|(_, method)| method)).collect()
    }

    /// The number of vectors of noise of a step.
    pub fn noises(&self) -> usize {
        match self {
            LangevinMethod::Word(word) => word.count(LangevinLetter::OrnsteinUhlenbeck),
            LangevinMethod::Gjf | LangevinMethod::EulerMaruyama => 1,
        }
    }

    /// Force evaluations of a step in a row of steps.
    pub fn evaluations(&self) -> usize {
        match self {
            LangevinMethod::Word(word) => word.evaluations(),
            LangevinMethod::Gjf | LangevinMethod::EulerMaruyama => 1,
        }
    }

    /// The variance of each number of the noise, over `kT/m`.
    pub fn noise_variance<S: Scalar>(&self, step: LangevinStep<S>) -> S {
        match self {
            LangevinMethod::Word(_) => step.letter_variance(),
            LangevinMethod::Gjf | LangevinMethod::EulerMaruyama => step.damping + step.damping,
        }
    }

    /// One step. `noise` has as many vectors as [`noises`](Self::noises), with numbers of the [variance](Self::noise_variance) times
    /// `kT/m`; missing ones are zero.
    pub fn step<S: Scalar, const D: usize>(
        &self,
        system: &impl System<S, D>,
        state: State<S, D>,
        step: LangevinStep<S>,
        noise: &[[S; D]],
    ) -> State<S, D> {
        let LangevinStep { dt, damping, implicit_factor, .. } = step;
        let first = noise.first().copied().unwrap_or([S::zero(); D]);
        match self {
            LangevinMethod::Word(word) => word.step(system, state, step, noise),
            LangevinMethod::EulerMaruyama => {
                let kept = S::one() - damping;
                let damped = State { v: each(|i| kept * state.v[i] + first[i]), ..state.drift(dt) };
                damped.kicked(system.acceleration(&state), dt)
            }
            LangevinMethod::Gjf => {
                let half = dt.ratio(1, 2);
                let before = system.acceleration(&state);
                let mean: [S; D] = each(|i| state.v[i] + half * before[i] + first[i].ratio(1, 2));
                let moved =
                    State { q: each(|i| state.q[i] + implicit_factor * dt * mean[i]), ..state };
                let after = system.acceleration(&moved);
                let kept = (S::one() - damping.ratio(1, 2)) * implicit_factor;
                let v = each(|i| {
                    kept * (state.v[i] + half * before[i])
                        + half * after[i]
                        + implicit_factor * first[i]
                });
                State { v, ..moved }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::Oscillator;

    #[test]
    fn euler_maruyama_drifts_with_the_velocity_at_the_start() {
        let step = LangevinStep::of_decay(0.5, 0.125, 0.0);
        let start = State { q: [2.0], v: [3.0] };
        let system = Oscillator { omega2: 4.0 };
        let end = LangevinMethod::EulerMaruyama.step(&system, start, step, &[[0.25]]);
        // 2 + 0.5·3, and 3 + 0.5·(−4·2) − 0.125·3 + 0.25.
        assert_eq!((end.q, end.v), ([3.5], [-1.125]));
    }

    #[test]
    fn every_common_method_has_its_name() {
        for method in LangevinMethod::common() {
            assert_eq!(method.to_string().parse::<LangevinMethod>(), Ok(method));
        }
        let wrong = "verlet".parse::<LangevinMethod>().unwrap_err().to_string();
        assert!(
            wrong.contains("`v` is no letter") && wrong.contains("gjf, euler-maruyama"),
            "{wrong}"
        );
    }
}
