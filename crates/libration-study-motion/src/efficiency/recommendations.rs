//! The cheapest method and step for an accuracy target.

use std::f64::consts::TAU;

use libration::simulation::{EnergyDrift, Sample, Simulator};
use libration::system::Oscillator;
use libration::{Method, Model, State, with_method};
use libration_report::Record;
use libration_report::notation::{count, number};
use libration_report::record::{Cell, Finding, Table, Tolerance};
use libration_study::{Lab, StudyError};

use super::accuracy_target::{AccuracyTarget, Kind, steps_for};
use super::cost::Cost;
use crate::coverage::{lacking, turns};
use crate::efficiency::EfficiencySettings;
use crate::rounding::rounding_of_run;

/// Step and cost of a method that meets an accuracy target.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    cost: Cost,
    z: f64,
}

impl Candidate {
    /// Force evaluations for one period.
    fn work(&self) -> f64 {
        self.cost.evaluations as f64 * TAU / self.z
    }

    /// Time for one period, in ns.
    fn time(&self) -> f64 {
        self.cost.nanoseconds * TAU / self.z
    }
}

/// Answers every demand, and tries those that a simulation can reach.
pub(super) fn recommend(
    lab: &Lab<'_>,
    costs: &[Cost],
    record: &mut Record,
) -> Result<(), StudyError> {
    let config = lab.config;
    let start = super::start(config);
    let settings = &config.get::<EfficiencySettings>();
    let demands: Vec<AccuracyTarget> = Kind::ALL
        .iter()
        .flat_map(|&kind| {
            settings.periods.iter().flat_map(move |&periods| {
                settings.tolerances.iter().map(move |&tolerance| AccuracyTarget {
                    kind,
                    tolerance,
                    periods,
                    start,
                })
            })
        })
        .collect();
    let offers = lab.sweep("the cheapest method", &demands, |demand| {
        let offer = |&cost: &Cost| Some(Candidate { cost, z: demand.largest_z(cost.method)? });
        let mut offers: Vec<Candidate> =
            costs.iter().filter_map(offer).filter(|offer| offer.z > 0.0).collect();
        offers.sort_by(|a, b| a.work().total_cmp(&b.work()));
        Ok(offers)
    })?;
    let columns = [
        "error in",
        "at most",
        "periods",
        "take",
        "at z = ωΔt",
        "force evaluations a period",
        "time a period (ns)",
        "next best",
        "its evaluations",
    ];
    let mut table = Table::new("answers", &columns);
    for (demand, offers) in demands.iter().zip(&offers) {
        let Some(best) = offers.first() else { continue };
        let next = offers.get(1);
        let cells: [Cell; 9] = [
            demand.kind.name().into(),
            demand.tolerance.into(),
            demand.periods.into(),
            best.cost.method.title().into(),
            best.z.into(),
            best.work().into(),
            best.time().into(),
            next.map_or_else(|| Cell::absent("—"), |offer| offer.cost.method.title().into()),
            next.map(Candidate::work).into(),
        ];
        table.push(cells);
    }
    record.tables.push(table);
    try_out(lab, &demands, &offers, record)
}

/// Simulates at the steps that were found for the energy, where the run is short enough.
fn try_out(
    lab: &Lab<'_>,
    demands: &[AccuracyTarget],
    offers: &[Vec<Candidate>],
    record: &mut Record,
) -> Result<(), StudyError> {
    let reach = lab.effort.choose(20_000, 200_000, 4_000_000);
    let jobs: Vec<(AccuracyTarget, Candidate)> = demands
        .iter()
        .zip(offers)
        .filter(|(demand, _)| demand.kind == Kind::Energy)
        .flat_map(|(&demand, offers)| offers.iter().map(move |&offer| (demand, offer)))
        .filter(|(demand, offer)| steps_for(demand.periods, offer.z) <= reach)
        .collect();
    let found = lab.sweep("trying the steps that were found", &jobs, |(demand, offer)| {
        let (method, steps) = (offer.cost.method, steps_for(demand.periods, offer.z));
        let measured = largest_drift(method, demand.start, offer.z, steps)?;
        let lacks = lacking(method, &demand.start, steps, offer.z);
        Ok((steps, measured, lacks))
    })?;
    for ((demand, offer), (steps, measured, lacks)) in jobs.iter().zip(found) {
        let (method, tolerance) = (offer.cost.method, demand.tolerance);
        // A start of less than a turn may not see the extreme, and near the end of stability an
        // orbit grows before it is seen: only what covers its curve is compared.
        if lacks > 0.1 || !turns(method, &demand.start, offer.z) {
            continue;
        }
        let rounding = 4.0 * rounding_of_run(method, 1.0, offer.z, steps) / tolerance;
        record.find(Finding::predicted(
            format!("efficiency.{}.energy-{tolerance}.periods-{}", method.name(), demand.periods),
            format!(
                "{}: largest energy drift over {} periods at z = {}, the step found for {}",
                method.title(),
                count(demand.periods),
                number(offer.z, 6),
                number(tolerance, 3)
            ),
            "1",
            tolerance,
            measured,
            Tolerance::relative(
                1.01 * lacks + rounding + 1e-9,
                "what the discrete orbit lacks of its curve’s extreme, and rounding",
            ),
        ));
    }
    Ok(())
}

fn largest_drift(
    method: Method,
    start: State<f64, 1>,
    z: f64,
    steps: u64,
) -> Result<f64, StudyError> {
    let system = Model::<1>::on::<f64>(&Oscillator { omega2: 1.0 });
    let drift = EnergyDrift::new(system, &start);
    let mut largest = 0.0_f64;
    let mut watch = |sample: &Sample<f64, 1>| largest = largest.max(drift.of(&sample.state).abs());
    with_method!(method, |m| Simulator::new(system, m, start, z)?.run(steps, &mut watch))?;
    Ok(largest)
}
