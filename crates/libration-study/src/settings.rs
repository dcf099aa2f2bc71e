//! The table of a study in the configuration.

use std::any::Any;
use std::fmt::Debug;

use libration_settings::Fault;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::table::read;

/// Settings of a study: conversion from a table of the configuration, and checks.
pub trait Settings: Any + Clone + Debug + Default + PartialEq + Send + Sync {
    /// Name of the table, equal to the name of the study.
    const NAME: &'static str;

    /// The table in the default configuration, with comments.
    const TEXT: &'static str;

    /// The table of a file, before the checks. Missing keys have their defaults.
    type Table: DeserializeOwned + JsonSchema + Serialize;

    /// Returns the settings as a table.
    fn table(&self) -> Self::Table;

    /// Returns the settings of a table.
    ///
    /// # Errors
    /// For the first value without a representation in the settings.
    fn from_table(table: Self::Table) -> Result<Self, Fault>;

    /// Checks every value.
    ///
    /// # Errors
    /// For the first invalid value.
    fn check(&self) -> Result<(), Fault>;

    /// Sorts lists whose order has no meaning.
    fn sort(&mut self) {}
}

/// Type-erased settings of a study.
pub(crate) trait AnySettings: Any + Debug + Send + Sync {
    fn name(&self) -> &'static str;
    fn boxed(&self) -> Box<dyn AnySettings>;
    fn equals(&self, other: &dyn AnySettings) -> bool;
    fn value(&self) -> serde_json::Result<Value>;
    fn check(&self) -> Result<(), Fault>;
    fn sort(&mut self);
}

impl<S: Settings> AnySettings for S {
    fn name(&self) -> &'static str {
        S::NAME
    }

    fn boxed(&self) -> Box<dyn AnySettings> {
        Box::new(self.clone())
    }

    fn equals(&self, other: &dyn AnySettings) -> bool {
        (other as &dyn Any).downcast_ref::<S>() == Some(self)
    }

    fn value(&self) -> serde_json::Result<Value> {
        serde_json::to_value(self.table())
    }

    fn check(&self) -> Result<(), Fault> {
        Settings::check(self)
    }

    fn sort(&mut self) {
        Settings::sort(self);
    }
}

/// The settings of all studies, each once.
#[derive(Debug, Default)]
pub struct AllSettings(Vec<Box<dyn AnySettings>>);

impl AllSettings {
    pub(crate) fn get<S: Settings>(&self) -> S {
        let found = |one: &dyn AnySettings| (one as &dyn Any).downcast_ref::<S>().cloned();
        self.0.iter().find_map(|one| found(&**one)).unwrap_or_default()
    }

    pub(crate) fn put(&mut self, settings: Box<dyn AnySettings>) {
        match self.0.iter_mut().find(|one| one.name() == settings.name()) {
            Some(one) => *one = settings,
            None => self.0.push(settings),
        }
    }

    /// Keeps the settings of the studies with these names only.
    pub fn keep(&mut self, names: &[&str]) {
        self.0.retain(|settings| names.contains(&settings.name()));
    }

    pub(crate) fn check(&self) -> Result<(), Fault> {
        self.0.iter().try_for_each(|settings| settings.check())
    }

    pub(crate) fn sort(&mut self) {
        self.0.iter_mut().for_each(|settings| settings.sort());
    }

    pub(crate) fn values(
        &self,
    ) -> impl Iterator<Item = (&'static str, serde_json::Result<Value>)> + '_ {
        self.0.iter().map(|settings| (settings.name(), settings.value()))
    }
}

impl Clone for AllSettings {
    fn clone(&self) -> Self {
        AllSettings(self.0.iter().map(|settings| settings.boxed()).collect())
    }
}

impl PartialEq for AllSettings {
    fn eq(&self, other: &Self) -> bool {
        let mut pairs = self.0.iter().zip(&other.0);
        self.0.len() == other.0.len() && pairs.all(|(one, other)| one.equals(&**other))
    }
}

/// Error of the table of a study.
pub(crate) enum SettingsTableError {
    /// A key is unknown, or a value has the wrong type.
    Shape(toml::de::Error),
    /// A value is not allowed.
    Value(Fault),
}

/// Settings of a study, for a [`Registry`](crate::Registry).
#[derive(Clone, Copy)]
pub struct Section {
    pub(crate) name: &'static str,
    pub(crate) text: &'static str,
    pub(crate) default: fn() -> Box<dyn AnySettings>,
    pub(crate) read: fn(&str) -> Result<Box<dyn AnySettings>, SettingsTableError>,
    pub(crate) schema: fn(&mut SchemaGenerator) -> Schema,
}

impl Section {
    /// Returns the section of settings of this type.
    pub const fn of<S: Settings>() -> Self {
        Section {
            name: S::NAME,
            text: S::TEXT,
            default: || Box::new(S::default()),
            read: |text| {
                let table = read::<S::Table>(text, S::NAME).map_err(SettingsTableError::Shape)?;
                let settings = table.map_or_else(|| Ok(S::default()), S::from_table);
                Ok(Box::new(settings.map_err(SettingsTableError::Value)?))
            },
            schema: |generator| {
                let mut schema = S::Table::json_schema(generator);
                if let Ok(default) = serde_json::to_value(S::default().table()) {
                    schema.insert("default".to_owned(), default);
                }
                schema
            },
        }
    }
}
