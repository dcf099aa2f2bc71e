//! Checks of single values and of lists.

use std::ops::RangeInclusive;
use std::path::Path;

use libration::catalog::Allowed;

use crate::limits::within;
use crate::{Count, Fault, limits, names};

/// A number that `allowed` admits.
///
/// # Errors
/// A [`Fault`] at `key`.
pub fn number(key: &'static str, allowed: Allowed, value: f64) -> Result<(), Fault> {
    within(allowed, key, value).map(drop).map_err(|message| Fault::new(key, message))
}

/// A number of steps.
///
/// # Errors
/// A [`Fault`] at `key`.
pub fn steps(key: &'static str, value: i128) -> Result<u64, Fault> {
    limits::steps(key, value).map_err(|message| Fault::new(key, message))
}

/// Numbers, at least one, each once.
///
/// # Errors
/// A [`Fault`] at `key`.
pub fn list(key: &'static str, what: &str, allowed: Allowed, values: &[f64]) -> Result<(), Fault> {
    if values.is_empty() {
        return Err(Fault::new(key, format!("`{key}` must hold at least one {what}")));
    }
    for (i, &value) in values.iter().enumerate() {
        let fault = |message| Fault::at(key, i, message);
        within(allowed, key, value).map_err(fault)?;
        if values[..i].contains(&value) {
            return Err(fault(format!("the {what} {value:?} stands in `{key}` twice")));
        }
    }
    Ok(())
}

/// Whole numbers that are numbers of steps, at least one, each once.
///
/// # Errors
/// A [`Fault`] at `key`.
pub fn counts(key: &'static str, values: &[u64]) -> Result<(), Fault> {
    if values.is_empty() {
        return Err(Fault::new(key, format!("`{key}` must hold at least one number")));
    }
    for (i, &value) in values.iter().enumerate() {
        count(key, i, value.into())?;
        if values[..i].contains(&value) {
            return Err(Fault::at(key, i, format!("{value} stands in `{key}` twice")));
        }
    }
    Ok(())
}

/// Element `i` of a list of numbers of steps.
///
/// # Errors
/// A [`Fault`] at that element.
pub fn count(key: &'static str, i: usize, value: i128) -> Result<u64, Fault> {
    limits::steps(key, value).map_err(|message| Fault::at(key, i, message))
}

/// A whole number in a range.
///
/// # Errors
/// A [`Fault`] at `key`.
pub fn count_in(
    key: &'static str,
    allowed: RangeInclusive<u64>,
    value: i128,
) -> Result<u64, Fault> {
    let (low, high) = (allowed.start(), allowed.end());
    u64::try_from(value).ok().filter(|count| allowed.contains(count)).ok_or_else(|| {
        Fault::new(key, format!("`{key}` is {value}, but it must be {low} to {high}"))
    })
}

/// Names of a list, each of which `find` knows.
///
/// # Errors
/// A [`Fault`] at the first that is none of the `known` ones; `one` and `all` say what they are called.
pub fn named<T>(
    key: &'static str,
    (one, all): (&str, &str),
    list: &[String],
    known: &[&str],
    find: impl Fn(&str) -> Option<T>,
) -> Result<Vec<T>, Fault> {
    let found = |(i, name): (usize, &String)| {
        find(name).ok_or_else(|| {
            let fault = Fault::at(key, i, format!("unknown {one} `{name}`"));
            fault.help(names::suggest(all, name, known.iter().copied()))
        })
    };
    list.iter().enumerate().map(found).collect()
}

/// A folder that exists, if one is given.
///
/// # Errors
/// A [`Fault`] at `key`.
pub fn folder(key: &'static str, path: Option<&Path>) -> Result<(), Fault> {
    match path.filter(|path| !path.is_dir()) {
        Some(path) => {
            let message = format!("`{key}` is `{}`, but it must be a folder", path.display());
            Err(Fault::new(key, message))
        }
        None => Ok(()),
    }
}

/// A list of numbers of steps, as it stands in a file.
///
/// # Errors
/// A [`Fault`] at the first that is not allowed.
pub fn whole(key: &'static str, list: Vec<Count>) -> Result<Vec<u64>, Fault> {
    list.into_iter().enumerate().map(|(i, n)| count(key, i, n.0)).collect()
}
