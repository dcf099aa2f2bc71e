//! Controllers as linear maps.

use libration_core::State;
use libration_core::control::{Controller, Feedback, Memory};
use libration_linear::{DiscreteController, Matrix};
use thiserror::Error;

/// `m' = A·m + B·y` and `u = C·m + D·y`: what a controller makes of its memory `m` and of the state `y = (q, v)` that it sees, near the
/// origin, where no limit is reached.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearController {
    /// A row for each number of the memory, over `q`, `v` and the memory.
    memory: Vec<Vec<f64>>,
    /// The row of the command.
    command: Vec<f64>,
}

/// Error of a controller that is not linear near the origin.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum NotLinear {
    /// The command is not zero at the origin.
    #[error(
        "the controller commands {0} m/s² at the origin, at rest; its target must be the origin"
    )]
    Offset(f64),
    /// Twice as much does not make it command twice as much.
    #[error("the controller is not linear near the origin")]
    Curved,
}

/// Numbers on which the controller is tried: far below any limit, and scaling by a power of two rounds nothing.
const SMALL: f64 = 1.0 / (1_u64 << 60) as f64;

impl LinearController {
    /// The linear map of `controller`, sampled every `period` seconds, from its commands for small memories and states.
    ///
    /// # Errors
    /// [`NotLinear`].
    pub fn of<K: Controller<f64, 1>>(controller: &K, period: f64) -> Result<Self, NotLinear> {
        let size = 2 + K::Memory::LEN;
        let run = |numbers: &[f64]| -> Vec<f64> {
            let lanes = K::Memory::load(&|i| [numbers[2 + i]]);
            let mut memory = K::Memory::lane(&lanes, 0);
            let seen = State { q: [numbers[0]], v: [numbers[1]] };
            let [command] = controller.command(&mut memory, &seen, period);
            let mut after = vec![command];
            K::Memory::store(&memory.single_lane(), &mut |_, &[value]: &[f64; 1]| {
                after.push(value)
            });
            after
        };
        let rest = run(&vec![0.0; size]);
        if let Some(&offset) = rest.iter().find(|x| **x != 0.0) {
            return Err(NotLinear::Offset(offset));
        }
        let column = |j: usize| {
            let mut numbers = vec![0.0; size];
            numbers[j] = SMALL;
            run(&numbers)
        };
        let columns: Vec<Vec<f64>> = (0..size).map(column).collect();
        let row = |i: usize| columns.iter().map(|column| column[i] / SMALL).collect();
        let (command, memory) = (row(0), (1..size - 1).map(row).collect());
        let linear = LinearController { memory, command };
        // All at once, and to the other side.
        let numbers: Vec<f64> = (0..size).map(|j| -SMALL * (1.5 + j as f64)).collect();
        let rows = [&linear.command].into_iter().chain(&linear.memory);
        let straight = rows.zip(run(&numbers)).all(|(row, found)| {
            let terms = || row.iter().zip(&numbers).map(|(factor, x)| factor * x);
            let most: f64 = terms().map(f64::abs).sum();
            // A rounding for each term.
            (terms().sum::<f64>() - found).abs() <= 8.0 * size as f64 * f64::EPSILON * most
        });
        if straight { Ok(linear.fed()) } else { Err(NotLinear::Curved) }
    }

    /// Without what nothing ever reaches, such as the integral of a controller that has none: it stays zero for ever, and would look like
    /// a motion that does not decay.
    fn fed(self) -> Self {
        let LinearController { memory, command } = self;
        let mut fed = vec![false; memory.len()];
        // A chain is no longer than the memory.
        for _ in 0..memory.len() {
            for (i, row) in memory.iter().enumerate() {
                let seen = row[..2].iter().any(|x| *x != 0.0);
                let told = (0..fed.len()).any(|j| j != i && fed[j] && row[2 + j] != 0.0);
                fed[i] |= seen || told;
            }
        }
        let kept = |row: Vec<f64>| -> Vec<f64> {
            let all = row.into_iter().enumerate();
            all.filter(|(j, _)| *j < 2 || fed[j - 2]).map(|(_, x)| x).collect()
        };
        let rows = memory.into_iter().zip(&fed).filter(|(_, fed)| **fed);
        LinearController {
            memory: rows.map(|(row, _)| kept(row)).collect(),
            command: kept(command),
        }
    }

    /// The number of values in its memory.
    pub fn remembers(&self) -> usize {
        self.memory.len()
    }

    /// The gains of the state: `−D`.
    pub fn gains(&self) -> Feedback {
        Feedback { position: -self.command[0], velocity: -self.command[1] }
    }

    /// The controller with its command scaled by `factor`.
    pub fn amplified(&self, factor: f64) -> Self {
        let command = self.command.iter().map(|x| factor * x).collect();
        LinearController { command, ..self.clone() }
    }

    /// The controller in state space, with the measurements `q` and `v`.
    pub fn discrete(&self) -> DiscreteController {
        let m = self.memory.len();
        DiscreteController {
            a: Matrix::from_fn(m, m, |i, j| self.memory[i][2 + j]),
            b: Matrix::from_fn(m, 2, |i, j| self.memory[i][j]),
            c: Matrix::from_fn(1, m, |_, j| self.command[2 + j]),
            d: Matrix::from_fn(1, 2, |_, j| self.command[j]),
        }
    }
}

/// State feedback remembers nothing.
impl From<Feedback> for LinearController {
    fn from(Feedback { position, velocity }: Feedback) -> Self {
        LinearController { memory: Vec::new(), command: vec![-position, -velocity] }
    }
}

#[cfg(test)]
mod tests {
    use libration_core::control::controller::{Force, Pid, PidGains, Saturated, StateFeedback};

    use super::*;

    const GAINS: Feedback = Feedback { position: 10.0, velocity: 2.0 };

    fn pid(most: f64, target: f64) -> Pid<1> {
        let gains = PidGains {
            proportional: 30.0,
            integral: 4.0,
            derivative: 5.0,
            filter: 0.0,
            most,
            tracking: 1.0,
            target: [target],
        };
        Pid::new(gains).unwrap()
    }

    #[test]
    fn state_feedback_is_its_gains_also_below_a_limit() {
        let wanted = LinearController::from(GAINS);
        let plain = StateFeedback::to_origin(GAINS);
        assert_eq!(LinearController::of(&plain, 0.1).unwrap(), wanted);
        let limited = Saturated { controller: plain, most: 0.5 };
        assert_eq!(LinearController::of(&limited, 0.1).unwrap(), wanted);
        assert_eq!(wanted.gains(), GAINS);
    }

    #[test]
    fn a_pid_is_its_difference_equations() {
        // Without a filter: u = −K_p·q + I − K_d(q − q₋)/h; I' = I − K_i·h·q; q₋' = q.
        let found = LinearController::of(&pid(f64::INFINITY, 0.0), 0.5).unwrap();
        let close = |row: &[f64], wanted: [f64; 5]| {
            let off = row.iter().zip(wanted).map(|(x, y)| (x - y).abs());
            assert!(off.fold(0.0, f64::max) < 1e-13, "{row:?} {wanted:?}");
        };
        assert_eq!(found.remembers(), 3);
        close(&found.command, [-40.0, 0.0, 1.0, 10.0, 0.0]);
        close(&found.memory[0], [-2.0, 0.0, 1.0, 0.0, 0.0]);
        close(&found.memory[1], [1.0, 0.0, 0.0, 0.0, 0.0]);
        close(&found.memory[2], [-10.0, 0.0, 0.0, 10.0, 0.0]);
        // Its limit is far away.
        assert_eq!(LinearController::of(&pid(3.0, 0.0), 0.5).unwrap(), found);
    }

    #[test]
    fn what_nothing_reaches_is_left_out() {
        let gains = PidGains {
            proportional: 30.0,
            integral: 0.0,
            derivative: 5.0,
            filter: 0.1,
            most: f64::INFINITY,
            tracking: 1.0,
            target: [0.0],
        };
        let of = |gains| LinearController::of(&Pid::<1>::new(gains).unwrap(), 0.5).unwrap();
        // The last position and the filtered slope, but no integral.
        assert_eq!(of(gains).remembers(), 2);
        assert_eq!(of(PidGains { derivative: 0.0, ..gains }).remembers(), 1);
        assert_eq!(of(PidGains { integral: 1.0, ..gains }).remembers(), 3);
    }

    #[test]
    fn what_is_not_linear_about_the_origin_is_refused() {
        assert!(matches!(
            LinearController::of(&pid(9.0, 1.0), 0.5),
            Err(NotLinear::Offset(offset)) if offset != 0.0
        ));
        let cubic = Force(libration_core::system::Duffing { alpha: 0.0, beta: 1e60 });
        assert_eq!(LinearController::of(&cubic, 0.5), Err(NotLinear::Curved));
    }
}
