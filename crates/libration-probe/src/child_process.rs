//! A simulator that is another program: numbers on its standard input and output.

use std::io::Write;
use std::sync::mpsc::{RecvTimeoutError, TryRecvError};
use std::time::{Duration, Instant};

use libration::linear::Matrix;
use libration_report::notation::plural;

use crate::running_program::{Environment, RunningProgram};
use crate::{BlackBox, BlackBoxError};

/// A program that gets a line `x₁ … xₙ u₁ … uₘ dt` for each step, and answers each with a line `x₁ … xₙ`, without waiting for more.
///
/// Numbers are decimal and separated by spaces or commas, with as many digits as a float needs to be the same again.
#[derive(Debug)]
pub struct ChildProcess {
    words: Vec<String>,
    environment: Environment,
    patience: Duration,
    /// The end of the audit.
    deadline: Option<Instant>,
    running: RunningProgram,
    has_energy: bool,
    /// Lines that were answered.
    answered: u64,
    reads_description: bool,
    /// The least time for a description.
    loading: Duration,
}

impl ChildProcess {
    /// Starts a program, which must answer each line within `patience`.
    ///
    /// # Errors
    /// The program does not start.
    pub fn start(
        words: &[String],
        environment: Environment,
        patience: Duration,
    ) -> Result<Self, BlackBoxError> {
        Ok(ChildProcess {
            words: words.to_vec(),
            patience,
            deadline: None,
            running: RunningProgram::start(words, &environment)?,
            environment,
            has_energy: false,
            answered: 0,
            reads_description: false,
            loading: Duration::ZERO,
        })
    }

    /// The first line of a program that describes itself before its first step. It may answer a line `energy x₁ … xₙ`. The line may
    /// take the time of an answer, or `loading` if that is longer.
    ///
    /// # Errors
    /// There is no line in time.
    pub fn description(&mut self, loading: Duration) -> Result<String, BlackBoxError> {
        self.reads_description = true;
        self.loading = loading;
        self.first_line()
    }

    fn first_line(&mut self) -> Result<String, BlackBoxError> {
        let patience = self.patience;
        self.patience = patience.max(self.loading);
        let line = self.next_line();
        self.patience = patience;
        line
    }

    /// The end of the audit, at which the wait for an answer ends as well.
    pub fn set_deadline(&mut self, deadline: Instant) {
        self.deadline = Some(deadline);
    }

    /// Whether the program answers lines `energy x₁ … xₙ`.
    pub fn set_energy(&mut self, has_energy: bool) {
        self.has_energy = has_energy;
    }

    /// An error of the program, with its name.
    fn failed(&self, why: &str) -> BlackBoxError {
        let program = self.words.first().map_or("", String::as_str);
        BlackBoxError::Failed(format!("`{program}` {why}"))
    }

    fn next_line(&mut self) -> Result<String, BlackBoxError> {
        let left = self.deadline.map(|end| end.saturating_duration_since(Instant::now()));
        let wait = left.map_or(self.patience, |left| left.min(self.patience));
        match self.running.lines.recv_timeout(wait) {
            Ok(Ok(line)) => Ok(line),
            Ok(Err(why)) => Err(self.ended(&why)),
            Err(RecvTimeoutError::Timeout) if wait < self.patience => {
                Err(BlackBoxError::TimeLimit {
                    program: self.words.first().cloned().unwrap_or_default(),
                })
            }
            Err(RecvTimeoutError::Timeout) => Err(BlackBoxError::NoAnswer {
                program: self.words.first().cloned().unwrap_or_default(),
                seconds: self.patience.as_secs_f64(),
            }),
            Err(RecvTimeoutError::Disconnected) => Err(self.ended("")),
        }
    }

    /// The error of a program whose output ends, or cannot be read.
    fn ended(&mut self, why: &str) -> BlackBoxError {
        if !why.is_empty() {
            return self.failed(&format!("failed: {why}"));
        }
        let status = match self.running.last_status() {
            Some(status) => format!("ended ({status})"),
            None => "closed its output".to_owned(),
        };
        let answered = usize::try_from(self.answered).unwrap_or(usize::MAX);
        self.failed(&format!(
            "{status} after {}; expected an answer to each line until its input ends",
            plural(answered, "line")
        ))
    }

    fn ask(&mut self, line: &str, count: usize) -> Result<Vec<f64>, BlackBoxError> {
        match self.running.lines.try_recv() {
            Ok(Ok(line)) => {
                return Err(self.failed(&format!(
                    "wrote `{}` before it was asked; expected one line for each line",
                    shortened(&line)
                )));
            }
            Ok(Err(why)) => return Err(self.ended(&why)),
            Err(TryRecvError::Empty | TryRecvError::Disconnected) => {}
        }
        if let Some(input) = &mut self.running.input {
            let written = input.write_all(line.as_bytes()).and_then(|()| input.flush());
            // Its end is reported with its exit code below.
            if written.is_err() && self.running.last_status().is_none() {
                return Err(self.failed("does not read its input"));
            }
        }
        let reply = self.next_line()?;
        self.answered += 1;
        let words = reply.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty());
        let numbers: Result<Vec<f64>, _> = words.map(|word| word.parse::<f64>()).collect();
        match numbers {
            Ok(numbers) if numbers.len() == count => Ok(numbers),
            Ok(numbers) => Err(self.failed(&format!(
                "answered with {}: `{}`; expected {count}",
                plural(numbers.len(), "number"),
                shortened(&reply)
            ))),
            Err(_) => Err(self.failed(&format!(
                "answered `{}`; expected {}{}",
                shortened(&reply),
                plural(count, "number"),
                if count == 1 { "" } else { ", separated by spaces" }
            ))),
        }
    }
}

/// The first words of a line.
fn shortened(line: &str) -> String {
    let line = line.trim();
    match line.char_indices().nth(60) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}

fn joined<'a>(numbers: impl Iterator<Item = &'a f64>) -> String {
    let words: Vec<String> = numbers.map(|x| format!("{x:?}")).collect();
    words.join(" ")
}

impl BlackBox for ChildProcess {
    fn step(
        &mut self,
        states: &Matrix,
        actions: &Matrix,
        dt: f64,
    ) -> Result<Matrix, BlackBoxError> {
        let mut next = Matrix::zeros(states.rows(), states.columns());
        for i in 0..states.rows() {
            let numbers = states.row(i).iter().chain(actions.row(i)).chain([&dt]);
            let line = joined(numbers) + "\n";
            let reply = self.ask(&line, states.columns())?;
            next.row_mut(i).copy_from_slice(&reply);
        }
        Ok(next)
    }

    fn energies(&mut self, states: &Matrix) -> Result<Option<Vec<f64>>, BlackBoxError> {
        if !self.has_energy {
            return Ok(None);
        }
        let of = |i: usize| {
            let line = format!("energy {}\n", joined(states.row(i).iter()));
            Ok(self.ask(&line, 1)?[0])
        };
        (0..states.rows()).map(of).collect::<Result<_, _>>().map(Some)
    }

    fn set_gains(&mut self, kp: &[f64], kv: &[f64]) -> Result<bool, BlackBoxError> {
        let line = format!("gains {}\n", joined(kp.iter().chain(kv)));
        self.ask(&line, 1).map(|_| true)
    }

    fn restart(&mut self) -> Result<bool, BlackBoxError> {
        self.running = RunningProgram::start(&self.words, &self.environment)?;
        self.answered = 0;
        if self.reads_description {
            self.first_line()?;
        }
        Ok(true)
    }
}
