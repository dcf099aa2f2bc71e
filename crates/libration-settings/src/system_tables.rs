//! The tables `[system.NAME]` of a settings file.

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use libration::catalog::Actuation;
use libration::{AnySystem, CatalogError, catalog};
use serde::de::{IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::suggestions::catalog_help;
use crate::{Fault, Number};

/// The tables of `[system]`: systems of the catalogue with their parameters, or `[system.equations]`, whose keys are `E`.
#[derive(Clone, Debug)]
pub struct SystemTables<E = IgnoredAny> {
    /// The equations, if there are any.
    pub equations: Option<E>,
    /// Whether there is a linear plant.
    pub has_linear: bool,
    /// The parameters of systems of the catalogue.
    pub catalogued: BTreeMap<String, BTreeMap<String, Number>>,
}

impl<E> Default for SystemTables<E> {
    fn default() -> Self {
        SystemTables { equations: None, has_linear: false, catalogued: BTreeMap::new() }
    }
}

impl<E> SystemTables<E> {
    /// The table of one system of the catalogue.
    pub fn of(name: &str, parameters: &[(&str, f64)]) -> Self {
        let parameters = parameters.iter().map(|&(name, x)| (name.to_owned(), Number(x)));
        let catalogued = [(name.to_owned(), parameters.collect())].into();
        SystemTables { catalogued, ..SystemTables::default() }
    }

    /// Refuses a second system.
    ///
    /// # Errors
    /// A [`Fault`] at `system`.
    pub fn check_single(&self) -> Result<(), Fault> {
        let others = usize::from(self.equations.is_some()) + usize::from(self.has_linear);
        match self.catalogued.len() + others {
            1 => Ok(()),
            _ => Err(Fault::new("system", "`system` must be one table, as [system.oscillator]")),
        }
    }

    /// The system of the catalogue, and the quantity of its commands; `instead` says what to do about other systems.
    ///
    /// # Errors
    /// A [`Fault`]: no or several systems, a system that is not of the catalogue, or a parameter that is not allowed.
    pub fn build(&self, instead: &str) -> Result<(AnySystem, Actuation), Fault> {
        self.check_single()?;
        let Some((name, parameters)) = self.catalogued.first_key_value() else {
            let name = if self.has_linear { "linear" } else { "equations" };
            let message = format!(
                "[system.{name}] is given; expected a system of the catalogue, as [system.oscillator]"
            );
            return Err(Fault::new(format!("system.{name}"), message).help(instead.to_owned()));
        };
        let values: Vec<_> = parameters.iter().map(|(name, value)| (name, value.0)).collect();
        catalog::build(name, &values).map_err(|error| {
            let key = match &error {
                CatalogError::UnknownParameter { name: key, .. } => format!(".{key}"),
                CatalogError::Value { name: key, .. }
                | CatalogError::Conflict { name: key, .. } => {
                    format!(".{key}")
                }
                CatalogError::Quotient { .. } => ".k".to_owned(),
                _ => String::new(),
            };
            Fault::new(format!("system.{name}{key}"), format!("{error}{}", catalog_help(&error)))
        })
    }
}

impl<'de, E: Deserialize<'de>> Deserialize<'de> for SystemTables<E> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader<E>(PhantomData<E>);

        // Not an untagged enum, whose errors have no place.
        impl<'de, E: Deserialize<'de>> Visitor<'de> for Reader<E> {
            type Value = SystemTables<E>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table, as [system.oscillator]")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut tables = SystemTables::default();
                while let Some(name) = map.next_key::<String>()? {
                    match &*name {
                        "equations" => tables.equations = Some(map.next_value()?),
                        "linear" => {
                            map.next_value::<IgnoredAny>()?;
                            tables.has_linear = true;
                        }
                        _ => drop(tables.catalogued.insert(name, map.next_value()?)),
                    }
                }
                Ok(tables)
            }
        }
        deserializer.deserialize_map(Reader(PhantomData))
    }
}

impl<E> Serialize for SystemTables<E> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.catalogued.serialize(serializer)
    }
}
