//! Messages in JSON.

use serde_json::Value;

/// Elements of an array that are listed.
const MOST_ELEMENTS: usize = 64;

/// Largest message in bytes: its values take many times as much memory.
const LONGEST: usize = 1 << 24;

fn parse(data: &[u8]) -> Option<Value> {
    (data.len() <= LONGEST).then(|| serde_json::from_slice(data).ok()).flatten()
}

/// The names of the numbers in a message.
pub(crate) fn signals(data: &[u8], most: usize) -> Vec<String> {
    let mut names = Vec::new();
    if let Some(value) = parse(data) {
        collect(&value, "", most, &mut names);
    }
    names
}

fn collect(value: &Value, prefix: &str, most: usize, names: &mut Vec<String>) {
    if names.len() >= most {
        return;
    }
    match value {
        Value::Number(_) | Value::Bool(_) if !prefix.is_empty() => names.push(prefix.to_owned()),
        Value::Array(all) => {
            for (i, one) in all.iter().enumerate().take(MOST_ELEMENTS) {
                collect(one, &format!("{prefix}[{i}]"), most, names);
            }
        }
        Value::Object(map) => {
            for (key, one) in map {
                let name = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
                collect(one, &name, most, names);
            }
        }
        _ => {}
    }
}

/// The steps of a name as a JSON pointer has them.
pub(crate) fn path(name: &str) -> Option<Vec<String>> {
    let steps = name.replace('[', ".").replace(']', "");
    let steps: Vec<String> =
        steps.split('.').filter(|step| !step.is_empty()).map(str::to_owned).collect();
    (!steps.is_empty()).then_some(steps)
}

/// The number at a path.
pub(crate) fn value(data: &[u8], path: &[String]) -> Option<f64> {
    let whole = parse(data)?;
    let place = path.iter().try_fold(&whole, |value, step| match value {
        Value::Array(all) => all.get(step.parse::<usize>().ok()?),
        value => value.get(step),
    })?;
    place.as_f64().or_else(|| place.as_bool().map(f64::from))
}

/// The time in `header.stamp` or `timestamp` as objects of `sec` and `nsec` or `nanosec`, in ns.
pub(crate) fn header_time(data: &[u8]) -> Option<i64> {
    let whole = parse(data)?;
    let stamp = whole.pointer("/header/stamp").or_else(|| whole.get("timestamp"))?;
    let part = |names: [&str; 3]| names.iter().find_map(|name| stamp.get(*name)?.as_i64());
    let seconds = part(["sec", "secs", "seconds"])?;
    let nanoseconds = part(["nsec", "nanosec", "nsecs"])?;
    seconds.checked_mul(1_000_000_000)?.checked_add(nanoseconds)
}
