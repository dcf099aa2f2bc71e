//! Checks of values and lists in settings.

use std::ops::RangeInclusive;
use std::path::Path;

use libration::catalog::Allowed;

use crate::limits::within;
use crate::{Count, Fault, limits, suggestions};

/// Checks that `allowed` admits a number.
///
/// # Errors
/// A [`Fault`] at `key`.
pub fn check_number(key: &'static str, allowed: Allowed, value: f64) -> Result<(), Fault> {
    within(allowed, key, value).map(drop).map_err(|message| Fault::new(key, message))
}

/// Checks a number of steps and returns it.
///
/// # Errors
/// A [`Fault`] at `key`.
pub fn check_steps(key: &'static str, value: i128) -> Result<u64, Fault> {
    limits::steps(key, value).map_err(|message| Fault::new(key, message))
}

/// Checks a list of numbers: at least one, without duplicates.
///
/// # Errors
/// A [`Fault`] at `key`.
pub fn check_list(
    key: &'static str,
    what: &str,
    allowed: Allowed,
    values: &[f64],
) -> Result<(), Fault> {
    if values.is_empty() {
        return Err(Fault::new(key, format!("`{key}` must hold at least one {what}")));
    }
    for (i, &value) in values.iter().enumerate() {
        let fault = |message| Fault::at(key, i, message);
        within(allowed, key, value).map_err(fault)?;
        if values[..i].contains(&value) {
            return Err(fault(format!("the {what} {value:?} occurs twice in `{key}`")));
        }
    }
    Ok(())
}

/// Checks a list of numbers of steps: at least one, without duplicates.
///
/// # Errors
/// A [`Fault`] at `key`.
pub fn check_counts(key: &'static str, values: &[u64]) -> Result<(), Fault> {
    if values.is_empty() {
        return Err(Fault::new(key, format!("`{key}` must hold at least one number")));
    }
    for (i, &value) in values.iter().enumerate() {
        check_count(key, i, value.into())?;
        if values[..i].contains(&value) {
            return Err(Fault::at(key, i, format!("{value} occurs twice in `{key}`")));
        }
    }
    Ok(())
}

/// Checks element `i` of a list of numbers of steps and returns it.
///
/// # Errors
/// A [`Fault`] at that element.
pub fn check_count(key: &'static str, i: usize, value: i128) -> Result<u64, Fault> {
    limits::steps(key, value).map_err(|message| Fault::at(key, i, message))
}

/// Checks that a whole number lies in a range and returns it.
///
/// # Errors
/// A [`Fault`] at `key`.
pub fn check_count_in(
    key: &'static str,
    allowed: RangeInclusive<u64>,
    value: i128,
) -> Result<u64, Fault> {
    let (low, high) = (allowed.start(), allowed.end());
    u64::try_from(value).ok().filter(|count| allowed.contains(count)).ok_or_else(|| {
        Fault::new(key, format!("`{key}` is {value}, but it must be {low} to {high}"))
    })
}

/// The values that `find` returns for the names of a list.
///
/// # Errors
/// A [`Fault`] at the first unknown name. `one` and `all` are the noun in the singular and the plural.
pub fn parse_names<T>(
    key: &'static str,
    (one, all): (&str, &str),
    list: &[String],
    known: &[&str],
    find: impl Fn(&str) -> Option<T>,
) -> Result<Vec<T>, Fault> {
    let found = |(i, name): (usize, &String)| {
        find(name).ok_or_else(|| {
            let fault = Fault::at(key, i, format!("unknown {one} `{name}`"));
            fault.help(suggestions::suggest(all, name, known.iter().copied()))
        })
    };
    list.iter().enumerate().map(found).collect()
}

/// Checks that the folder exists, if there is one.
///
/// # Errors
/// A [`Fault`] at `key`.
pub fn check_folder(key: &'static str, path: Option<&Path>) -> Result<(), Fault> {
    match path.filter(|path| !path.is_dir()) {
        Some(path) => {
            let message = format!("`{key}` is `{}`, but it must be a folder", path.display());
            Err(Fault::new(key, message))
        }
        None => Ok(()),
    }
}

/// The numbers of steps of a list in a file.
///
/// # Errors
/// A [`Fault`] at the first value that is not allowed.
pub fn parse_counts(key: &'static str, list: Vec<Count>) -> Result<Vec<u64>, Fault> {
    list.into_iter().enumerate().map(|(i, n)| check_count(key, i, n.0)).collect()
}
