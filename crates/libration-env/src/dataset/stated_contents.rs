//! What a manifest says of the contents of a chunk, compared with the settings.

use serde_json::{Map, Value, json};

use super::{DataFormat, Dataset};

impl Dataset {
    /// The first key of the entry of a chunk that differs from the settings, or that they do not know; none if there is none. `chunk` is
    /// the number of the chunk in its group. Numbers that only a computation knows are compared with their limits; `before` has the totals
    /// of episodes and actions before the chunk, to which it adds those of the chunk.
    pub(super) fn misstated(
        &self,
        group: usize,
        chunk: u64,
        format: DataFormat,
        before: &mut [u64; 2],
        holds: &Map<String, Value>,
    ) -> Option<String> {
        let group = self.group(group);
        let most = self.chunk.steps as u64;
        let first = chunk.saturating_mul(most);
        let steps = self.steps.saturating_sub(first).min(most);
        let transitions = steps * group.len as u64;
        let mut wanted = json!({
            "seed": self.seed,
            "environments": [group.first, group.first + group.len],
            "steps": [first, first + steps],
            "transitions": transitions,
            "ends": holds.get("ends").filter(|ends| ends.as_u64().is_some_and(|n| n <= transitions)),
        });
        if format == DataFormat::Minari {
            for (key, before) in ["episodes", "actions"].into_iter().zip(before) {
                let after = holds.get(key).and_then(|pair| pair.get(1)).and_then(Value::as_u64);
                // Episodes of earlier chunks may end in this one, with all actions since the first.
                let after = after.filter(|after| *after >= *before);
                wanted[key] = json!([*before, after]);
                *before = after.unwrap_or(*before);
            }
        }
        let wanted = wanted.as_object()?;
        let differs = |key: &&String| {
            let stated = wanted.get(*key);
            stated != holds.get(*key) || stated.is_none_or(Value::is_null)
        };
        wanted.keys().chain(holds.keys()).find(differs).cloned()
    }
}
