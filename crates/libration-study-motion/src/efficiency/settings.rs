//! Settings of the study `efficiency`.

use std::sync::LazyLock;

use libration::Method;
use libration::analysis::SymbolicStep;
use libration::integrator::SplittingTable;
use libration_settings::validation::{check_counts, check_list, parse_counts, parse_names};
use libration_settings::{Count, Fault, Number, limits, numbers};
use libration_study::{Settings, schema};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

/// Settings of the study `efficiency`.
#[derive(Clone, Debug, PartialEq)]
pub struct EfficiencySettings {
    /// Tolerated errors in energy and in state, ascending.
    pub tolerances: Vec<f64>,
    /// Horizons in periods of the oscillator, ascending.
    pub periods: Vec<u64>,
    /// Published splitting methods that are studied besides the integrators.
    pub splitting_methods: Vec<Method>,
}

impl Default for EfficiencySettings {
    fn default() -> Self {
        EfficiencySettings {
            tolerances: vec![1e-6, 1e-4, 1e-2],
            periods: vec![10, 1_000, 1_000_000],
            splitting_methods: offered()
                .filter(|method| DEFAULT_SPLITTING_METHODS.contains(&method.name()))
                .collect(),
        }
    }
}

/// One of order 4, with the smallest error per evaluation of all of this order, and one of order 6.
const DEFAULT_SPLITTING_METHODS: [&str; 2] = ["blanes-moan-srkn-6-4", "okunbor-skeel-6-13"];

/// The published splitting methods that can be studied: those whose update matrix has an exact polynomial.
fn offered() -> impl Iterator<Item = Method> {
    static OFFERED: LazyLock<Vec<Method>> = LazyLock::new(|| {
        let splitting = SplittingTable::ALL.into_iter().flatten().map(Method::Splitting);
        splitting.filter(|&method| SymbolicStep::new(method).is_some()).collect()
    });
    OFFERED.iter().copied()
}

/// Settings of the study `efficiency`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Tolerated errors in energy and in state, each once.
    #[schemars(schema_with = "schema::tolerances")]
    tolerances: Vec<Number>,
    /// Horizons in periods of the oscillator, each once.
    #[schemars(schema_with = "schema::horizons")]
    periods: Vec<Count>,
    /// Published splitting methods that are studied besides the integrators, each once.
    #[schemars(schema_with = "splitting_methods")]
    splitting_methods: Vec<String>,
}

fn splitting_methods(_: &mut SchemaGenerator) -> Schema {
    let names: Vec<&str> = offered().map(Method::name).collect();
    json_schema!({ "type": "array", "uniqueItems": true, "items": schema::one_of(&names) })
}

impl Default for Table {
    fn default() -> Self {
        EfficiencySettings::default().table()
    }
}

impl Settings for EfficiencySettings {
    const NAME: &'static str = "efficiency";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table {
            tolerances: self.tolerances.iter().copied().map(Number).collect(),
            periods: self.periods.iter().map(|&n| Count(n.into())).collect(),
            splitting_methods: self.splitting_methods.iter().map(|m| m.name().into()).collect(),
        }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(EfficiencySettings {
            tolerances: numbers(table.tolerances),
            periods: parse_counts("efficiency.periods", table.periods)?,
            splitting_methods: parse_names(
                "efficiency.splitting_methods",
                ("splitting method", "splitting methods"),
                &table.splitting_methods,
                &offered().map(Method::name).collect::<Vec<_>>(),
                |name| offered().find(|method| method.name() == name),
            )?,
        })
    }

    fn check(&self) -> Result<(), Fault> {
        check_list("efficiency.tolerances", "tolerance", limits::TOLERANCE, &self.tolerances)?;
        check_counts("efficiency.periods", &self.periods)?;
        for (i, method) in self.splitting_methods.iter().enumerate() {
            if self.splitting_methods[..i].contains(method) {
                let message = format!("the splitting method `{}` is named twice", method.name());
                return Err(Fault::at("efficiency.splitting_methods", i, message));
            }
        }
        Ok(())
    }

    fn sort(&mut self) {
        self.tolerances.sort_by(f64::total_cmp);
        self.periods.sort_unstable();
    }
}
