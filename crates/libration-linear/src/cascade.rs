//! Cascades of two controllers.

use thiserror::Error;

use crate::{ControllerSchedule, DiscreteController, Matrix};

/// An inner controller whose references an outer one computes, each with a rate of its own.
///
/// Between two runs of a controller its references or commands are held. In a period in which both run, the outer one is first.
#[derive(Clone, Debug, PartialEq)]
pub struct Cascade {
    /// From the outputs and then the references to the commands.
    pub inner: DiscreteController,
    /// From the outputs to the references.
    pub outer: DiscreteController,
    /// The inner controller runs in every so-manieth period of the loop.
    pub inner_every: usize,
    /// The outer controller runs in every so-manieth period of the loop.
    pub outer_every: usize,
    /// The periods of the loop from a run of the outer controller until its references act, at most `outer_every`.
    pub outer_latency: usize,
}

/// Error of a cascade.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CascadeError {
    /// A controller never runs, or the cascade repeats too late.
    #[error(
        "the inner controller runs every {inner} periods and the outer one every {outer}; expected 1 or more, and a least common multiple of at most {}",
        Cascade::MOST_PERIODS
    )]
    Rates {
        /// Of the inner controller.
        inner: usize,
        /// Of the outer controller.
        outer: usize,
    },
    /// References act after the next ones are computed.
    #[error(
        "the outer latency is {latency} periods; expected at most {every}, after which the outer controller runs again"
    )]
    Latency {
        /// In periods of the loop.
        latency: usize,
        /// The periods between two runs.
        every: usize,
    },
    /// The controllers do not fit each other.
    #[error(
        "the inner controller has {inner} measurements; expected {expected}: {outputs} outputs and {references} references of the outer controller"
    )]
    Measurements {
        /// The number of measurements.
        inner: usize,
        /// The expected number.
        expected: usize,
        /// The measurements of the outer controller.
        outputs: usize,
        /// The commands of the outer controller.
        references: usize,
    },
}

impl Cascade {
    /// The most periods of the loop after which a cascade repeats.
    pub const MOST_PERIODS: usize = 100;

    /// The controllers of all periods until the cascade repeats.
    ///
    /// They share one memory: that of both controllers, the references that act, those that do not act yet, and the commands between
    /// two runs of the inner controller.
    ///
    /// # Errors
    /// [`CascadeError`].
    pub fn schedule(&self) -> Result<ControllerSchedule, CascadeError> {
        let Cascade { inner, outer, inner_every, outer_every, outer_latency } = self;
        let (inner_every, every, latency) = (*inner_every, *outer_every, *outer_latency);
        let rates = CascadeError::Rates { inner: inner_every, outer: every };
        if inner_every == 0 || every == 0 {
            return Err(rates);
        }
        let periods = inner_every / common_divisor(inner_every, every) * every;
        if periods > Self::MOST_PERIODS {
            return Err(rates);
        }
        if latency > every {
            return Err(CascadeError::Latency { latency, every });
        }
        let (outputs, references) = (outer.measurements(), outer.commands());
        if inner.measurements() != outputs + references {
            let (inner, expected) = (inner.measurements(), outputs + references);
            return Err(CascadeError::Measurements { inner, expected, outputs, references });
        }
        let all = (0..periods).map(|k| self.period(k)).collect();
        // They have equal sizes.
        ControllerSchedule::new(all).ok_or(rates)
    }

    /// The controller of period `k`.
    fn period(&self, k: usize) -> DiscreteController {
        let Cascade { inner, outer, inner_every, outer_every, outer_latency } = self;
        let (outputs, references) = (outer.measurements(), outer.commands());
        let mut size = 0;
        let mut take = |count: usize| {
            size += count;
            size - count..size
        };
        let of_inner = take(inner.memory());
        let of_outer = take(outer.memory());
        let acting = take(references);
        let pending = take(if *outer_latency > 0 { references } else { 0 });
        let commands = take(if *inner_every > 1 { inner.commands() } else { 0 });
        // Rows over the memory and the outputs.
        let columns = size + outputs;
        let kept = |places: &core::ops::Range<usize>| {
            Matrix::from_fn(places.len(), columns, |i, j| {
                f64::from(u8::from(j == places.start + i))
            })
        };
        let of_controller = |memory: &Matrix, direct: &Matrix, first: usize, measured: &Matrix| {
            let mut rows = direct * measured;
            for i in 0..memory.rows() {
                rows.row_mut(i)[first..first + memory.columns()].copy_from_slice(memory.row(i));
            }
            rows
        };
        let measured = kept(&(size..columns));
        let outer_runs = k.is_multiple_of(*outer_every);
        let fresh = of_controller(&outer.c, &outer.d, of_outer.start, &measured);
        let reference = match (*outer_latency, k % outer_every == outer_latency % outer_every) {
            (_, false) => kept(&acting),
            (0, true) => fresh.clone(),
            (_, true) => kept(&pending),
        };
        let mut seen = Matrix::zeros(outputs + references, columns);
        seen.set_block((0, 0), &measured);
        seen.set_block((outputs, 0), &reference);
        let inner_runs = k.is_multiple_of(*inner_every);
        let command = match inner_runs {
            true => of_controller(&inner.c, &inner.d, of_inner.start, &seen),
            false => kept(&commands),
        };
        let mut next = Matrix::zeros(size, columns);
        let mut put = |places: &core::ops::Range<usize>, rows: Matrix| {
            next.set_block((places.start, 0), &rows.block((0, 0), (places.len(), columns)));
        };
        put(
            &of_inner,
            match inner_runs {
                true => of_controller(&inner.a, &inner.b, of_inner.start, &seen),
                false => kept(&of_inner),
            },
        );
        put(
            &of_outer,
            match outer_runs {
                true => of_controller(&outer.a, &outer.b, of_outer.start, &measured),
                false => kept(&of_outer),
            },
        );
        put(&acting, reference);
        put(&pending, if outer_runs { fresh } else { kept(&pending) });
        put(&commands, command.clone());
        let split = |rows: &Matrix| {
            let memory = rows.block((0, 0), (rows.rows(), size));
            [memory, rows.block((0, size), (rows.rows(), outputs))]
        };
        let ([a, b], [c, d]) = (split(&next), split(&command));
        DiscreteController { a, b, c, d }
    }
}

fn common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(rows: usize, columns: usize, seed: usize) -> Matrix {
        Matrix::from_fn(rows, columns, |i, j| ((seed + 5 * i + 3 * j) as f64 * 1.7).sin())
    }

    fn controller(
        memory: usize,
        measurements: usize,
        commands: usize,
        seed: usize,
    ) -> DiscreteController {
        DiscreteController {
            a: random(memory, memory, seed).scaled(0.5),
            b: random(memory, measurements, seed + 1),
            c: random(commands, memory, seed + 2),
            d: random(commands, measurements, seed + 3),
        }
    }

    /// `C·m + D·y`, after which the memory moves on.
    fn run(one: &DiscreteController, memory: &mut Vec<f64>, seen: &[f64]) -> Vec<f64> {
        let sum = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(b).map(|(a, b)| a + b).collect();
        let command = sum(one.c.apply(memory), one.d.apply(seen));
        *memory = sum(one.a.apply(memory), one.b.apply(seen));
        command
    }

    #[test]
    fn a_cascade_commands_what_two_controllers_that_run_apart_do() {
        for (inner_every, outer_every, outer_latency) in
            [(1, 1, 0), (1, 1, 1), (1, 5, 0), (1, 4, 2), (1, 3, 3), (2, 3, 0), (2, 6, 5), (3, 2, 1)]
        {
            let [inner, outer] = [controller(2, 5, 2, 7), controller(1, 3, 2, 40)];
            let cascade = Cascade { inner, outer, inner_every, outer_every, outer_latency };
            let schedule = cascade.schedule().unwrap();
            assert_eq!(schedule.periods() % outer_every, 0);
            let Cascade { inner, outer, .. } = &cascade;
            let mut memory = vec![0.0; schedule.at(0).memory()];
            let (mut of_inner, mut of_outer) = (vec![0.0; 2], vec![0.0; 1]);
            let (mut computed, mut command) = (Vec::new(), vec![0.0; 2]);
            for k in 0..30_usize {
                let y: Vec<f64> = (0..3).map(|j| ((k * 3 + j) as f64 * 0.9).cos()).collect();
                if k % outer_every == 0 {
                    computed.push((k + outer_latency, run(outer, &mut of_outer, &y)));
                }
                let reference = computed.iter().rev().find(|(from, _)| *from <= k);
                let reference = reference.map_or(vec![0.0; 2], |(_, values)| values.clone());
                if k % inner_every == 0 {
                    let seen: Vec<f64> = y.iter().chain(&reference).copied().collect();
                    command = run(inner, &mut of_inner, &seen);
                }
                let found = run(schedule.at(k), &mut memory, &y);
                for (found, wanted) in found.iter().zip(&command) {
                    let off = (found - wanted).abs();
                    assert!(off < 1e-12, "{inner_every} {outer_every} {outer_latency} {k}: {off}");
                }
            }
        }
    }

    #[test]
    fn controllers_that_do_not_fit_and_impossible_rates_are_refused() {
        let cascade = Cascade {
            inner: controller(0, 3, 1, 1),
            outer: controller(0, 2, 1, 2),
            inner_every: 1,
            outer_every: 5,
            outer_latency: 0,
        };
        assert_eq!(cascade.schedule().unwrap().periods(), 5);
        let message = |cascade: Cascade| cascade.schedule().unwrap_err().to_string();
        let narrow = Cascade { inner: controller(0, 2, 1, 1), ..cascade.clone() };
        assert!(message(narrow).contains("has 2 measurements; expected 3"));
        assert!(message(Cascade { outer_every: 0, ..cascade.clone() }).contains("every 0"));
        let long = Cascade { inner_every: 13, outer_every: 17, ..cascade.clone() };
        assert!(message(long).contains("at most 100"));
        assert!(message(Cascade { outer_latency: 6, ..cascade }).contains("expected at most 5"));
    }
}
