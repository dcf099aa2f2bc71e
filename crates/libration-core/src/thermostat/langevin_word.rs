//! Splittings of Langevin dynamics as words.

use core::fmt;
use core::str::FromStr;

use thiserror::Error;

use super::LangevinStep;
use crate::array::each;
use crate::{Scalar, State, System};

/// Most letters of a word.
pub const MOST_LETTERS: usize = 32;

/// An exact flow of a part of Langevin dynamics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LangevinLetter {
    /// `A`: the drift `q += h·v`.
    Drift,
    /// `B`: the kick `v += h·a(q)`.
    Kick,
    /// `O`: friction and noise, an Ornstein–Uhlenbeck process of the velocity.
    OrnsteinUhlenbeck,
}

impl LangevinLetter {
    /// All letters.
    pub const ALL: [LangevinLetter; 3] =
        [LangevinLetter::Drift, LangevinLetter::Kick, LangevinLetter::OrnsteinUhlenbeck];

    /// The letter in a word.
    pub const fn symbol(self) -> char {
        match self {
            LangevinLetter::Drift => 'A',
            LangevinLetter::Kick => 'B',
            LangevinLetter::OrnsteinUhlenbeck => 'O',
        }
    }
}

/// A splitting of Langevin dynamics, such as `BAOAB`: exact flows of its parts, one after the other, the first letter first.
///
/// Each letter acts for the time step over the number of its occurrences. B. Leimkuhler, C. Matthews, *Rational construction of
/// stochastic numerical methods for molecular sampling*, Applied Mathematics Research eXpress 2013, section 2.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct LangevinWord {
    letters: Vec<LangevinLetter>,
}

/// Error of a word.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum WordError {
    /// A character that is no letter.
    #[error(
        "`{0}` is no letter of a word; expected A (drift), B (kick) and O (friction and noise)"
    )]
    Letter(char),
    /// A letter that does not occur.
    #[error("the word has no {}; expected at least one each of A, B and O", .0.symbol())]
    Missing(LangevinLetter),
    /// More than [`MOST_LETTERS`].
    #[error("the word has {0} letters; expected at most {MOST_LETTERS}")]
    Length(usize),
}

impl FromStr for LangevinWord {
    type Err = WordError;

    /// A word of the letters A, B and O, in upper or lower case.
    fn from_str(text: &str) -> Result<Self, WordError> {
        let letter = |symbol: char| {
            let same = |letter: &LangevinLetter| letter.symbol() == symbol.to_ascii_uppercase();
            LangevinLetter::ALL.into_iter().find(same).ok_or(WordError::Letter(symbol))
        };
        let letters = text.chars().map(letter).collect::<Result<Vec<_>, _>>()?;
        if letters.len() > MOST_LETTERS {
            return Err(WordError::Length(letters.len()));
        }
        match LangevinLetter::ALL.into_iter().find(|letter| !letters.contains(letter)) {
            Some(letter) => Err(WordError::Missing(letter)),
            None => Ok(LangevinWord { letters }),
        }
    }
}

impl fmt::Display for LangevinWord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.letters.iter().try_for_each(|letter| write!(f, "{}", letter.symbol()))
    }
}

impl LangevinWord {
    /// The letters, the first to act first.
    pub fn letters(&self) -> &[LangevinLetter] {
        &self.letters
    }

    /// How often a letter occurs.
    pub fn count(&self, letter: LangevinLetter) -> usize {
        self.letters.iter().filter(|other| **other == letter).count()
    }

    /// Force evaluations of a step in a row of steps: kicks without a drift between them share one.
    pub fn evaluations(&self) -> usize {
        let moves =
            self.letters.iter().filter(|letter| **letter != LangevinLetter::OrnsteinUhlenbeck);
        let moves: Vec<LangevinLetter> = moves.copied().collect();
        let drifted = |i: &usize| {
            let before = moves[(i + moves.len() - 1) % moves.len()];
            moves[*i] == LangevinLetter::Kick && before == LangevinLetter::Drift
        };
        (0..moves.len()).filter(drifted).count()
    }

    /// One step. `noise` has a vector for each letter O: what it adds to the velocity, of variance
    /// [`LangevinStep::letter_variance`] times `kT/m`; missing ones are zero.
    pub fn step<S: Scalar, const D: usize>(
        &self,
        system: &impl System<S, D>,
        state: State<S, D>,
        step: LangevinStep<S>,
        noise: &[[S; D]],
    ) -> State<S, D> {
        let part = |letter| step.dt.ratio(1, self.count(letter) as i32);
        let [drift, kick] = [LangevinLetter::Drift, LangevinLetter::Kick].map(part);
        let mut noise = noise.iter();
        self.letters.iter().fold(state, |state, letter| match letter {
            LangevinLetter::Drift => state.drift(drift),
            LangevinLetter::Kick => state.kick(system, kick),
            LangevinLetter::OrnsteinUhlenbeck => {
                let added = noise.next().copied().unwrap_or([S::zero(); D]);
                State { v: each(|i| step.decay * state.v[i] + added[i]), ..state }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Address, Purpose};
    use crate::system::Oscillator;

    fn word(text: &str) -> LangevinWord {
        text.parse().unwrap()
    }

    #[test]
    fn wrong_words_are_refused_with_the_letter() {
        let fails = |text: &str| text.parse::<LangevinWord>().unwrap_err();
        assert_eq!(fails("BAXAB"), WordError::Letter('X'));
        assert_eq!(fails("BAAB"), WordError::Missing(LangevinLetter::OrnsteinUhlenbeck));
        assert_eq!(fails(""), WordError::Missing(LangevinLetter::Drift));
        assert_eq!(fails(&"BAO".repeat(11)), WordError::Length(33));
        assert_eq!(word("baoab").to_string(), "BAOAB");
    }

    #[test]
    fn kicks_at_the_same_place_share_an_evaluation_also_across_steps() {
        for (text, evaluations) in
            [("BAOAB", 1), ("OBABO", 1), ("ABOBA", 1), ("BABOBAB", 2), ("BOBAB", 1), ("AOBAOB", 2)]
        {
            assert_eq!(word(text).evaluations(), evaluations, "{text}");
        }
    }

    /// The letter O is the transition of an Ornstein–Uhlenbeck process (C. W. Gardiner, *Stochastic Methods*, section 4.5.4).
    #[test]
    fn friction_and_noise_have_the_mean_and_variance_of_the_exact_process() {
        const COUNT: u64 = 1 << 18;
        let free = Oscillator { omega2: 0.0 };
        let (damping, start) = (0.7_f64, 2.0);
        for text in ["BAOAB", "OABAO", "OAOBO"] {
            let word = word(text);
            let letters = word.count(LangevinLetter::OrnsteinUhlenbeck);
            let step = LangevinStep::new(1.0, damping, letters);
            let deviation = step.letter_variance().sqrt();
            let (mut sum, mut square) = (0.0, 0.0);
            for trajectory in 0..COUNT {
                let draw = |step| {
                    let address =
                        Address { seed: 1, trajectory, step, purpose: Purpose::Thermostat };
                    [deviation * address.gaussian()[0]]
                };
                let noise: Vec<[f64; 1]> = (0..letters as u64).map(draw).collect();
                let State { v: [v], .. } =
                    word.step(&free, State { q: [0.0], v: [start] }, step, &noise);
                let off = v - start * (-damping).exp();
                (sum, square) = (sum + off, square + off * off);
            }
            let count = COUNT as f64;
            let variance = 1.0 - (-2.0 * damping).exp();
            // Four standard errors of the mean and of the variance of normal numbers.
            assert!((sum / count).abs() < 4.0 * (variance / count).sqrt(), "{text}");
            let off = (square / count - variance).abs();
            assert!(off < 4.0 * variance * (2.0 / count).sqrt(), "{text} {off}");
        }
    }
}
