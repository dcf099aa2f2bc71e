//! Changes that alter bits.

use std::collections::BTreeSet;

use libration::ensemble::All;
use libration::integrator::SymplecticEuler;
use libration::system::Pendulum;
use libration::{Ensemble, State, System};
use libration_report::record::{Finding, Record, Relation, Tolerance};
use libration_study::{Lab, StudyError};

use super::runs::{Bits, COUNT, DT, SPRING, differing, run_perturbed, run_plain, start, steps};
use crate::bench::PlatformPendulum;
use crate::bit_comparison::add_row;

/// Numbers that are added.
const ADDED: usize = 1_000_000;

/// Compares runs that are the same in exact arithmetic only.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let whole = run_plain(lab, COUNT, lab.alone()?, 1)?;
    let omega2 = SPRING.omega2 as f32;
    // The shipped formula, by hand: that it has the same bits shows that what differs is the formula.
    let by_hand = formula(lab, |q, v| v + DT * -(omega2 * q), |q, v| q + DT * v);
    same_formula(record, differing(&whole, &by_hand));
    let ahead = -omega2 * DT;
    let other = formula(lab, |q, v| v + ahead * q, |q, v| q + DT * v);
    let what = "the formula: (−ω²Δt)·x in place of Δt·(−ω²x)";
    some(record, "association", what, COUNT, differing(&whole, &other), ROUNDED);
    let fused = |q: f32, v: f32| DT.mul_add(-(omega2 * q), v);
    let other = formula(lab, fused, |q, v| DT.mul_add(v, q));
    let what = "multiplication and addition fused, with one rounding";
    some(record, "fused", what, COUNT, differing(&whole, &other), ROUNDED);
    lab.check()?;

    let seeds =
        [run_perturbed(lab, COUNT, lab.alone()?, 1)?, run_perturbed(lab, COUNT, lab.alone()?, 2)?];
    let differ = differing(&seeds[0], &seeds[1]);
    let finding = Finding::predicted(
        "determinism.broken.seed",
        "trajectories that differ in any bit; changed: the seed of jitter and skew, as noise without one would",
        "1",
        COUNT as f64,
        differ as f64,
        Tolerance::exact("two runs of hundreds of random steps agree in all bits by no accident"),
    );
    add_row(record, "the seed of jitter and skew", COUNT, finding);

    let sums = sums();
    let different = sums.iter().map(|sum| sum.to_bits()).collect::<BTreeSet<_>>().len();
    let what = "the order of a sum: a million f32 in one part, and in 2, 3 and 4 that are added in the end";
    let finding = Finding::related(
        "determinism.broken.sum",
        format!("different results; changed: {what}"),
        "1",
        Relation::AtLeast,
        2.0,
        different as f64,
        Tolerance::exact("floats round every partial sum, and other parts have other sums"),
    );
    add_row(record, what, sums.len(), finding);

    let swings = |ours: bool| -> Result<Vec<Bits>, StudyError> {
        match ours {
            true => pendula(lab, Pendulum { omega2 }),
            false => pendula(lab, PlatformPendulum { omega2 }),
        }
    };
    let differ = differing(&swings(true)?, &swings(false)?);
    let what = "the sine of a pendulum: the platform’s in place of the program’s";
    // How a platform rounds its sine no theory tells.
    let finding = Finding::measured(
        "determinism.broken.sine",
        format!("trajectories that differ in any bit; changed: {what}"),
        "1",
        differ as f64,
    );
    add_row(record, what, COUNT, finding);
    Ok(())
}

/// Reason for different results of equal formulas.
const ROUNDED: &str = "the products are rounded elsewhere; among thousands of orbits some meet a number where that \
                       shows, and it stays";

fn some(record: &mut Record, id: &str, what: &str, compared: usize, differ: usize, why: &str) {
    let finding = Finding::related(
        format!("determinism.broken.{id}"),
        format!("trajectories that differ in any bit; changed: {what}"),
        "1",
        Relation::AtLeast,
        1.0,
        differ as f64,
        Tolerance::exact(why),
    );
    add_row(record, what, compared, finding);
}

fn same_formula(record: &mut Record, differ: usize) {
    let what = "the program: a plain loop over one trajectory with the same formula";
    let finding = Finding::predicted(
        "determinism.kept.formula",
        format!("results that differ in any bit; changed: {what}"),
        "1",
        0.0,
        differ as f64,
        Tolerance::exact("the same operations in the same order round alike, whoever does them"),
    );
    add_row(record, what, COUNT, finding);
}

/// All trajectories after all steps: first the velocity, then the position, each by its formula.
fn formula(
    lab: &Lab<'_>,
    velocity: impl Fn(f32, f32) -> f32,
    position: impl Fn(f32, f32) -> f32,
) -> Vec<Bits> {
    let run = |n| {
        let [mut q, mut v] = start(n);
        for _ in 0..steps(lab) {
            v = velocity(q, v);
            q = position(q, v);
        }
        [q.to_bits(), v.to_bits()]
    };
    (0..COUNT).map(run).collect()
}

/// A million squares, added in 1, 2, 3 and 4 parts.
fn sums() -> Vec<f32> {
    let numbers: Vec<f32> = (0..ADDED).map(|n| (n as f32 / ADDED as f32).powi(2)).collect();
    let in_parts = |count: usize| {
        let parts = numbers.chunks(ADDED.div_ceil(count));
        parts.map(|part| part.iter().sum::<f32>()).sum()
    };
    (1..=4).map(in_parts).collect()
}

fn pendula<Sys>(lab: &Lab<'_>, system: Sys) -> Result<Vec<Bits>, StudyError>
where
    Sys: System<f32, 1> + Copy + Send + Sync,
{
    let state = |n| {
        let [q, v] = start(n);
        State { q: [q], v: [v] }
    };
    let mut all = Ensemble::<f32, 1>::from_fn(COUNT, lab.alone()?, state)?;
    all.advance(SymplecticEuler, All(system), All(DT), steps(lab))?;
    Ok(all.q(0).iter().zip(all.v(0)).map(|(q, v)| [q.to_bits(), v.to_bits()]).collect())
}
