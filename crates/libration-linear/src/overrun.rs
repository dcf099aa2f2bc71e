//! Jobs of a controller that overrun their period.

use crate::{DiscreteController, Matrix, MissingCommand};

/// What happens to a job that is not finished at the end of its period, its deadline (M. Maggio, A. Hamann, E. Mayer-John, D.
/// Ziegenbein, *Control-system stability under consecutive deadline misses constraints*, ECRTS 2020).
///
/// A job begins with its period, and reads the measurements that have arrived then.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OverrunStrategy {
    /// It ends without a trace: neither a command nor a change of the controller's memory.
    #[default]
    Kill,
    /// It goes on, and no other job begins until it is finished. Its commands are those of old measurements.
    Skip,
    /// It goes on, and the job of the latest period waits for it in place of any that waited before. Those that do not run leave no
    /// trace.
    Queue,
}

/// What becomes of a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PeriodOutcome {
    /// No job is unfinished at its end.
    Met,
    /// A job is unfinished at its end, or was killed, and no commands were sent.
    Missed,
    /// The job before was finished in it and sent its commands; that of the period itself is unfinished at its end. Only a queue has
    /// this outcome.
    Late,
}

/// The commands that take over with the latency of each input, counted from the beginning of the period.
#[derive(Clone, Copy, PartialEq)]
enum Sent {
    /// Those of the job of this period.
    Own,
    /// Those of the job that overran.
    Overdue,
    /// None.
    Nothing,
}

/// What the controller does in a period.
#[derive(Clone, Copy)]
pub(crate) struct Activity {
    sent: Sent,
    /// Whether the job of this period runs. It uses the memory that the job before left, and no other job sees the memory until it is
    /// finished: it may be updated at once.
    runs: bool,
    /// Whether a job is unfinished at the end and goes on.
    overruns: bool,
}

impl Activity {
    /// Whether a job is unfinished at the end of the period and goes on.
    pub(crate) fn overruns(self) -> bool {
        self.overruns
    }
}

impl OverrunStrategy {
    /// What the controller does in a period with this outcome; `running` says whether a job is unfinished at its beginning.
    pub(crate) fn activity(self, running: bool, outcome: PeriodOutcome) -> Activity {
        let activity = |sent, runs, overruns| Activity { sent, runs, overruns };
        match (self, running, outcome) {
            (OverrunStrategy::Kill, _, PeriodOutcome::Missed | PeriodOutcome::Late) => {
                activity(Sent::Nothing, false, false)
            }
            (OverrunStrategy::Skip, true, PeriodOutcome::Met) => {
                activity(Sent::Overdue, false, false)
            }
            (_, _, PeriodOutcome::Met) => activity(Sent::Own, true, false),
            (_, true, PeriodOutcome::Missed) => activity(Sent::Nothing, false, true),
            (_, true, PeriodOutcome::Late) => activity(Sent::Overdue, true, true),
            (_, false, _) => activity(Sent::Nothing, true, true),
        }
    }

    /// The possible outcomes of a period.
    pub(crate) fn outcomes(self, running: bool, missed: bool) -> &'static [PeriodOutcome] {
        match (self, running, missed) {
            (_, _, false) => &[PeriodOutcome::Met],
            (OverrunStrategy::Queue, true, true) => &[PeriodOutcome::Missed, PeriodOutcome::Late],
            (_, _, true) => &[PeriodOutcome::Missed],
        }
    }

    /// Whether a job goes on behind its deadline.
    pub(crate) fn goes_on(self) -> bool {
        self != OverrunStrategy::Kill
    }
}

impl DiscreteController {
    /// The controller in a period, as a controller whose memory also holds the commands that were sent last, and those of a job that
    /// overruns.
    ///
    /// A missing command is another command in its place: the last one again, or zero.
    pub(crate) fn overrunning(
        &self,
        strategy: OverrunStrategy,
        missing: MissingCommand,
        activity: Activity,
    ) -> Self {
        let (memory, inputs, outputs) = (self.memory(), self.commands(), self.measurements());
        let holds = missing == MissingCommand::Hold;
        let last = memory;
        let overdue = last + if holds { inputs } else { 0 };
        let size = overdue + if strategy.goes_on() { inputs } else { 0 };
        let unit = |place: usize| {
            let mut c = Matrix::zeros(inputs, size);
            (0..inputs).for_each(|i| c[(i, place + i)] = 1.0);
            (c, Matrix::zeros(inputs, outputs))
        };
        let nothing = || (Matrix::zeros(inputs, size), Matrix::zeros(inputs, outputs));
        let own = || {
            let mut c = Matrix::zeros(inputs, size);
            c.set_block((0, 0), &self.c);
            (c, self.d.clone())
        };
        let (c, d) = match activity.sent {
            Sent::Own => own(),
            Sent::Overdue => unit(overdue),
            Sent::Nothing if holds => unit(last),
            Sent::Nothing => nothing(),
        };
        let (mut a, mut b) = (Matrix::zeros(size, size), Matrix::zeros(size, outputs));
        match activity.runs {
            true => {
                a.set_block((0, 0), &self.a);
                b.set_block((0, 0), &self.b);
            }
            false => a.set_block((0, 0), &Matrix::identity(memory)),
        }
        if holds {
            a.set_block((last, 0), &c);
            b.set_block((last, 0), &d);
        }
        if activity.overruns {
            let (rows, direct) = if activity.runs { own() } else { unit(overdue) };
            a.set_block((overdue, 0), &rows);
            b.set_block((overdue, 0), &direct);
        }
        DiscreteController { a, b, c, d }
    }
}
