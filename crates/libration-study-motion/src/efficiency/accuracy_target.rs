//! The largest step that meets an accuracy target, and its cost.

use std::f64::consts::TAU;

use libration::analysis::{Criterion, LargestStep, OrbitError, OrbitStart, SymbolicStep};
use libration::number::Wide;
use libration::{Method, Scalar, State};

/// The error that a tolerance limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The relative energy drift.
    Energy,
    /// The distance from the exact orbit, relative to its amplitude, from the worst start.
    State,
}

impl Kind {
    pub(super) const ALL: [Kind; 2] = [Kind::Energy, Kind::State];

    pub(super) fn name(self) -> &'static str {
        match self {
            Kind::Energy => "energy",
            Kind::State => "state",
        }
    }
}

/// An error, its tolerance and a horizon.
#[derive(Clone, Copy, Debug)]
pub(super) struct AccuracyTarget {
    pub(super) kind: Kind,
    pub(super) tolerance: f64,
    pub(super) periods: u64,
    /// In units in which `ω = 1`.
    pub(super) start: State<f64, 1>,
}

/// Steps that fill `periods` periods at `z = ωΔt`.
pub(super) fn steps_for(periods: u64, z: f64) -> u64 {
    (periods as f64 * TAU / z).ceil().max(1.0) as u64
}

impl AccuracyTarget {
    /// The largest `z = ωΔt` at which `method` meets the demand; none if it was not found to meet it.
    pub(super) fn largest_z(&self, method: Method) -> Option<f64> {
        let step = SymbolicStep::new(method)?;
        match self.kind {
            Kind::Energy if step.is_symplectic() => {
                // The band does not depend on the horizon.
                let (tolerance, start) =
                    (self.tolerance, Some(OrbitStart::new(&self.start.q, &self.start.v)));
                let criterion = Criterion::EnergyDrift { tolerance, steps: 1, start };
                step.largest_step(&criterion).map(LargestStep::to_f64)
            }
            Kind::Energy => self.first_failure(|z| {
                let area = step.determinant().eval_wide(Wide::from_f64(z));
                let steps = steps_for(self.periods, z) as f64;
                let growth = ((area - Wide::one()).to_f64().ln_1p() * steps).exp_m1();
                growth.abs() <= self.tolerance
            }),
            Kind::State => self.first_failure(|z| {
                OrbitError::new(&step, z).is_some_and(|slip| {
                    slip.worst_error_within(steps_for(self.periods, z)) <= self.tolerance
                })
            }),
        }
    }

    /// Returns the first step at which `meets` fails, by a scan in steps of 5 % and bisection.
    fn first_failure(&self, meets: impl Fn(f64) -> bool) -> Option<f64> {
        // Below this a period takes more than 10¹⁶ steps: no run would end.
        let mut low = 1e-15;
        if !meets(low) {
            return None;
        }
        for stride in [10.0, 1.05] {
            while low * stride < 4.0 && meets(low * stride) {
                low *= stride;
            }
        }
        let mut high = 1.05 * low;
        // To neighbouring floats: over many steps a drift magnifies what is left.
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return Some(low);
            }
            if meets(middle) { low = middle } else { high = middle }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn largest(method: Method, tolerance: f64, periods: u64) -> f64 {
        let start = State { q: [1.0], v: [0.0] };
        let demand = AccuracyTarget { kind: Kind::Energy, tolerance, periods, start };
        demand.largest_z(method).unwrap_or(f64::NAN)
    }

    #[test]
    fn an_energy_error_of_10_to_the_minus_4_asks_rk4_for_the_published_steps() {
        for (periods, z) in
            [(1, 0.258561), (100, 0.102790), (10_000, 0.0409122), (1_000_000, 0.0162869)]
        {
            let got = largest(Method::Rk4, 1e-4, periods);
            // Six digits are published; a period is filled with whole steps here, which costs up to
            // one step in 24 for the shortest.
            let whole = got / (TAU * periods as f64) / 5.0;
            assert!((got / z - 1.0).abs() < 5e-6 + whole, "{periods}: {got}, not {z}");
        }
        assert!((largest(Method::VelocityVerlet, 1e-4, 7) - 0.02).abs() < 1e-15);
    }
}
