//! Limits in JSON, where an infinite one is `null`.

use serde::Serializer;

pub(super) fn limit<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    match value.is_finite() {
        true => serializer.serialize_some(value),
        false => serializer.serialize_none(),
    }
}
