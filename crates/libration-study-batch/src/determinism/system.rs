//! The study `determinism` of a system of equations.

use libration::ensemble::{AnyEnsemble, BatchFloat, Execution, InstructionSet};
use libration::equations::StepProgram;
use libration::{Float, Method};
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::{Finding, RecordError, Tolerance};
use libration_settings::equations::EquationSystem;
use libration_study::{Lab, Study, StudyError};

use super::invariance::THREADS;
use crate::bit_comparison;

/// Trajectories that are compared.
const COUNT: usize = 1000;

/// Steps a turn, and steps of a run: two turns.
const STEPS: [u64; 2] = [64, 128];

/// The study `determinism` of a system of equations.
#[derive(Clone, Copy, Debug)]
pub struct SystemDeterminism<'a> {
    system: &'a EquationSystem,
    turn: f64,
}

impl<'a> SystemDeterminism<'a> {
    /// Of a system with a turn of so many seconds.
    pub fn new(system: &'a EquationSystem, turn: f64) -> Self {
        SystemDeterminism { system, turn }
    }
}

/// A change that keeps every bit.
struct Change {
    id: &'static str,
    text: String,
    /// The number of trajectories, the calls in which steps are taken, and the executions.
    count: usize,
    calls: u64,
    executions: Vec<Execution>,
}

impl Study for SystemDeterminism<'_> {
    fn name(&self) -> &'static str {
        "determinism"
    }

    fn question(&self) -> &'static str {
        "Which conditions leave every bit of a result as it is?"
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        bit_comparison::begin(&mut record);
        for change in changes(lab)? {
            let (mut compared, mut differ) = (0, 0);
            for &method in &lab.config.integrators {
                lab.check()?;
                for [all, other] in [
                    self.differing::<f64>(lab, method, &change)?,
                    self.differing::<f32>(lab, method, &change)?,
                ] {
                    (compared, differ) = (compared + all, differ + other);
                }
            }
            same(&mut record, change.id, &change.text, compared, differ);
        }
        let (mut compared, mut differ) = (0, 0);
        for &method in &lab.config.integrators {
            for [all, other] in [self.alone::<f64>(lab, method)?, self.alone::<f32>(lab, method)?] {
                (compared, differ) = (compared + all, differ + other);
            }
        }
        let text = "the program of a step, run alone on one trajectory after the other";
        same(&mut record, "program", text, compared, differ);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        page.title = "Determinism".into();
        let (held, all) =
            (record.findings.iter().filter(|f| f.agrees()).count(), record.findings.len());
        page.answer = format!(
            "{held} of {all} changes of the execution leave every bit of every trajectory as it is."
        );
        page.paragraph(format!(
            "Each row changes one condition and compares the bits of {COUNT} trajectories, from starts near that of the file, with \
             each integrator in f64 and in f32. What is not a number counts as one value."
        ));
        page.table(bit_comparison::table(record)?, 4);
        page.action(
            "Repeat the run on another machine with `--out after`, and list what differs: `libration compare libration-report after`.",
        );
        Ok(())
    }
}

/// The changes, with the executions that are tried.
fn changes(lab: &Lab<'_>) -> Result<Vec<Change>, StudyError> {
    let serial = lab.alone()?;
    let mut threads = Vec::new();
    for count in THREADS {
        // With work for each of them, however little there is.
        threads.push(lab.alone()?.threads(count)?.worth(1));
    }
    let sets: Vec<InstructionSet> = InstructionSet::available().collect();
    let mut instructions = Vec::new();
    for &set in &sets {
        instructions.push(lab.alone()?.instructions(set)?);
    }
    let names: Vec<&str> = sets.iter().map(|set| set.name()).collect();
    let change = |id, text: &str, count, calls, executions| Change {
        id,
        text: text.to_owned(),
        count,
        calls,
        executions,
    };
    Ok(vec![
        change("repeat", "nothing: the same run again", COUNT, 1, vec![serial.clone()]),
        change("threads", "1, 2, 3 and 4 threads", COUNT, 1, threads),
        change(
            "instructions",
            &format!("the instruction set: {}", names.join(", ")),
            COUNT,
            1,
            instructions,
        ),
        change("calls", "steps in seven calls in place of one", COUNT, 7, vec![serial.clone()]),
        change("count", "a fifth of the trajectories, the same ones", COUNT / 5, 1, vec![serial]),
    ])
}

/// Adds the finding that no result differs.
fn same(record: &mut Record, id: &str, changed: &str, compared: usize, differ: usize) {
    let finding = Finding::predicted(
        format!("determinism.kept.{id}"),
        format!("trajectories that differ in any bit; changed: {changed}"),
        "1",
        0.0,
        differ as f64,
        Tolerance::exact(
            "every lane takes the steps of a lone trajectory, whose operations and their order are fixed",
        ),
    );
    bit_comparison::add_row(record, changed, compared, finding);
}

impl SystemDeterminism<'_> {
    /// Coordinate `i` of positions and velocities at the start of trajectory `n`; each starts elsewhere.
    fn start<T: Float>(&self, n: usize, i: usize) -> T {
        let x = self.system.q.iter().chain(&self.system.v).nth(i).copied().unwrap_or(0.0);
        let part = n as f64 / (1 << 20) as f64;
        T::from_f64(x + part * x.abs().max(1.0))
    }

    fn dt<T: Float>(&self) -> T {
        T::from_f64(self.turn / STEPS[0] as f64)
    }

    /// The last states of `count` trajectories: the positions and velocities of each.
    fn run_many<T: BatchFloat>(
        &self,
        method: Method,
        count: usize,
        calls: u64,
        execution: Execution,
    ) -> Result<Vec<Vec<T>>, StudyError> {
        let dynamics = self.system.equations.dynamics();
        let start = |n: usize, i: usize| self.start(n, i);
        let mut all = AnyEnsemble::<T>::new(dynamics, None, count, execution, start)?;
        for call in 0..calls {
            let part = STEPS[1] * (call + 1) / calls - STEPS[1] * call / calls;
            all.advance(method, self.dt(), part);
        }
        let planes: Vec<&[T]> = (0..dynamics.degrees())
            .filter_map(|i| all.q(i))
            .chain((0..dynamics.degrees()).filter_map(|i| all.v(i)))
            .collect();
        Ok((0..count).map(|n| planes.iter().map(|plane| plane[n]).collect()).collect())
    }

    /// How many trajectories are compared, and how many differ.
    fn differing<T: BatchFloat>(
        &self,
        lab: &Lab<'_>,
        method: Method,
        change: &Change,
    ) -> Result<[usize; 2], StudyError> {
        let whole = self.run_many::<T>(method, COUNT, 1, lab.alone()?)?;
        let mut counts = [0, 0];
        for execution in &change.executions {
            let other =
                self.run_many::<T>(method, change.count, change.calls, execution.clone())?;
            counts[0] += other.len();
            counts[1] += differing(&whole, &other);
        }
        Ok(counts)
    }

    /// The same of a fifth of the trajectories, one after the other.
    fn alone<T: BatchFloat>(
        &self,
        lab: &Lab<'_>,
        method: Method,
    ) -> Result<[usize; 2], StudyError> {
        let whole = self.run_many::<T>(method, COUNT, 1, lab.alone()?)?;
        let dynamics = self.system.equations.dynamics();
        let step = StepProgram::new(method, dynamics);
        let mut run = step.program().on::<T>();
        let states = 2 * dynamics.degrees();
        let alone = (0..COUNT / 5).map(|n| {
            let mut inputs: Vec<T> = (0..states).map(|i| self.start(n, i)).collect();
            inputs.resize(states + dynamics.inputs(), T::zero());
            inputs.push(self.dt());
            for _ in 0..STEPS[1] {
                let next: Vec<T> = run.run(&inputs).collect();
                inputs[..states].copy_from_slice(&next);
            }
            inputs.truncate(states);
            inputs
        });
        let alone: Vec<Vec<T>> = alone.collect();
        Ok([alone.len(), differing(&whole, &alone)])
    }
}

/// The number of different entries of two lists; what is not a number is one value.
fn differing<T: BatchFloat>(a: &[Vec<T>], b: &[Vec<T>]) -> usize {
    let bits = |x: &T| {
        let x = x.to_f64();
        if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() }
    };
    let same = |a: &Vec<T>, b: &Vec<T>| a.iter().map(bits).eq(b.iter().map(bits));
    a.iter().zip(b).filter(|(a, b)| !same(a, b)).count()
}
