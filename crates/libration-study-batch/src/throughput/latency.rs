//! The latency of a step of a single trajectory.

use std::hint::black_box;

use libration::Method;
use libration::analysis::Operation;
use libration_report::record::{Record, Table};
use libration_study::StudyError;

use super::fused::{STEPS, flow};
use crate::bench::{
    Bench, BenchFloat, CHAIN_LINKS, Chain, Contestant, Link, Rates, stepping, with_float,
};
use crate::measurement::{Measurement, judge};

/// Share of the bound that a lone trajectory is to reach.
const BAR: f64 = 0.9;

/// Rounds of a chain between two looks at the clock.
const ROUNDS: u64 = 1000;

/// Races single trajectories against chains of dependent operations.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let mut table = Table::new(
        "a lone trajectory",
        &[
            "integrator",
            "float",
            "operations in a row",
            "time of a step (ns)",
            "bound (ns)",
            "share",
        ],
    );
    for &method in &measurement.lab.config.integrators {
        for float in BenchFloat::ALL {
            let (chain, [time, bound]) =
                with_float!(float, T => against_chain::<T>(measurement, method))?;
            let share = bound.over(&time);
            let name = float.name();
            judge(
                record,
                format!("throughput.one.{}.{name}", method.name()),
                format!(
                    "{}, {name}, a single trajectory: the time of the longest chain of dependent \
                     operations of a step over the time of a step",
                    method.title()
                ),
                // The bar was set for the study's first method; others are told.
                (method == Method::SymplecticEuler).then_some(BAR),
                &share,
            );
            table.push([
                method.title().into(),
                name.into(),
                chain.into(),
                time.median().into(),
                bound.median().into(),
                share.median().into(),
            ]);
        }
    }
    record.tables.push(table);
    Ok(())
}

/// The longest chain of a step, in operations; the time of a step, and the bound on it, in ns.
fn against_chain<T: Bench>(
    measurement: &Measurement<'_>,
    method: Method,
) -> Result<(f64, [Rates; 2]), StudyError> {
    let flow = flow(measurement, method);
    let lone = stepping::<T>(method, measurement.task(1), 16 * STEPS, &measurement.serial)?;
    let [time, product, sum, both] = measurement
        .compare_rates([
            lone,
            chain::<T>(Link::Product),
            chain::<T>(Link::Sum),
            chain::<T>(Link::ProductAndSum),
        ])?
        .map(|rates| rates.inverted().scaled(1e9));
    // In a cycle there are as many sums after products as products after sums: half of both for each.
    let change = both.scaled(0.5);
    let bound = product.with_two([&sum, &change], |product, sum, change| {
        flow.recurrence(|before, operation| match [before, operation] {
            [Operation::Addition, Operation::Addition] => sum,
            [Operation::Addition, _] | [_, Operation::Addition] => change,
            _ => product,
        })
    });
    Ok((flow.recurrence(|_, _| 1.0), [time, bound]))
}

/// Links of a chain, one after another: links a second.
fn chain<T: Bench>(link: Link) -> Contestant<'static> {
    Contestant::new((ROUNDS * CHAIN_LINKS) as f64, move |times| {
        black_box(Chain(link).run::<T>(times * ROUNDS));
    })
}
