//! Errors of traces.

use thiserror::Error;

/// Why traces cannot be audited.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TraceError {
    /// Fewer than two traces.
    #[error(
        "{0} trace given; expected at least 2, of runs of the same system at different time steps"
    )]
    Few(usize),
    /// More traces than an audit takes.
    #[error("{0} traces given; expected at most 64")]
    Many(usize),
    /// Times and energies differ in number.
    #[error("`{title}` has {times} times and {energies} energies; expected as many of each")]
    Lengths {
        /// The trace.
        title: String,
        /// Number of times.
        times: usize,
        /// Number of energies.
        energies: usize,
    },
    /// Too few samples.
    #[error(
        "`{title}` has {samples} samples; expected at least {least}; help: a longer run, or energies of more steps"
    )]
    Short {
        /// The trace.
        title: String,
        /// Number of samples.
        samples: usize,
        /// The fewest samples of an audit.
        least: usize,
    },
    /// A number that is not finite.
    #[error(
        "the {what} of sample {sample} of `{title}` is {value}; expected a finite number; help: audit the part before it"
    )]
    NotFinite {
        /// The trace.
        title: String,
        /// `time` or `energy`.
        what: &'static str,
        /// Number of the sample, from 1.
        sample: usize,
        /// The value.
        value: f64,
    },
    /// Times that do not increase.
    #[error(
        "the times of `{title}` do not increase at sample {sample}: {before} s, then {after} s; expected increasing times; help: remove repeated rows"
    )]
    NotIncreasing {
        /// The trace.
        title: String,
        /// Number of the sample, from 1.
        sample: usize,
        /// Time of the sample before.
        before: f64,
        /// Its time.
        after: f64,
    },
    /// An energy that never changes.
    #[error(
        "the energy of `{title}` is constant: {value} in all {samples} samples; expected an energy with all digits; help: write more digits, or the energy of the simulation instead of a set value"
    )]
    Constant {
        /// The trace.
        title: String,
        /// Number of samples.
        samples: usize,
        /// The energy.
        value: f64,
    },
    /// A time step that is no positive number.
    #[error("the time step of `{title}` is {dt}; expected a positive number of seconds")]
    TimeStep {
        /// The trace.
        title: String,
        /// Its time step.
        dt: f64,
    },
    /// A time step that is longer than the spacing of samples.
    #[error(
        "the time step of `{title}` is {dt} s, its samples are {spacing} s apart; expected at least a step between samples; help: check --dt and the unit of the time"
    )]
    LongStep {
        /// The trace.
        title: String,
        /// Its time step.
        dt: f64,
        /// Time between samples.
        spacing: f64,
    },
    /// Samples at unequal distances, without a time step.
    #[error(
        "the times between samples of `{title}` differ by {percent:.0} % (rms); expected samples at equal distances, or the time step; help: give the time steps with --dt"
    )]
    Uneven {
        /// The trace.
        title: String,
        /// Relative rms deviation of the times between samples in per cent.
        percent: f64,
    },
    /// Two time steps that are the same.
    #[error(
        "`{first}` and `{second}` have the same time step, {dt} s; expected different steps; help: of thinned traces give the steps with --dt"
    )]
    EqualSteps {
        /// A trace.
        first: String,
        /// The other trace.
        second: String,
        /// The time step of both.
        dt: f64,
    },
    /// Runs of different length.
    #[error(
        "`{longer}` covers {long} s, `{shorter}` {short} s; expected runs of the same duration within 5 %; help: cut the longer one, or repeat the shorter one"
    )]
    Durations {
        /// The longer run.
        longer: String,
        /// The shorter run.
        shorter: String,
        /// Duration of the longer run.
        long: f64,
        /// Duration of the shorter run.
        short: f64,
    },
    /// Numbers whose squares are not finite.
    #[error(
        "the energies or times of `{title}` are too large for an audit; expected squares below 1e308; help: use other units"
    )]
    Overflow {
        /// The trace.
        title: String,
    },
    /// A tolerance or a horizon that is no positive number.
    #[error("the {what} is {value}; expected a positive number")]
    Requirement {
        /// `tolerance` or `horizon`.
        what: &'static str,
        /// Its value.
        value: f64,
    },
}
