//! Data sets as other programs read them.

use std::path::Path;

use assert_cmd::Command;

use crate::rollout::{SETTINGS, settings, write};

/// A Python with what `tools/requirements.txt` lists: `LIBRATION_PYTHON`, or a virtual environment in `target/python`.
fn python() -> Option<std::path::PathBuf> {
    let local = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/python/bin/python");
    let named = std::env::var_os("LIBRATION_PYTHON").map(Into::into);
    named.or_else(|| local.exists().then_some(local))
}

#[test]
fn numpy_and_pyarrow_read_the_same_transitions_ends_and_units() {
    let Some(python) = python() else {
        eprintln!("skipped: set LIBRATION_PYTHON to a Python that has NumPy and pyarrow");
        return;
    };
    let dir = settings(SETTINGS);
    write(&dir, "arrays", "--format npy").success();
    write(&dir, "tables", "--format parquet").success();
    let script = r#"
import json, numpy as np, pyarrow.parquet as pq
lines = [json.loads(line) for line in open('arrays/manifest.jsonl')]
head, chunks = lines[0], lines[1:]
seen = [number['name'] for number in head['observation']]
assert seen == ['q0', 'v0', 'reference_q0', 'reference_v0'], seen
rows = 0
for chunk in chunks:
    name = chunk['chunk']
    field = lambda folder: np.load(f'arrays/{folder}/{name}.npy')
    (first, last), (begin, end) = chunk['holds']['environments'], chunk['holds']['steps']
    shape = (end - begin, last - first)
    observation, action, reward = field('observation'), field('action'), field('reward')
    assert observation.shape == (*shape, 4) and observation.dtype == np.float32
    assert action.shape == (*shape, 1) and reward.shape == shape
    table = pq.read_table(f'tables/transitions/{name}.parquet')
    rows += table.num_rows
    column = lambda name: table[name].to_numpy().reshape(shape)
    assert (column('step') == np.arange(begin, end)[:, None]).all()
    assert (column('environment') == np.arange(first, last)[None, :]).all()
    bits = lambda x: np.ascontiguousarray(x).view(np.uint32)
    for i, number in enumerate(seen):
        assert (bits(column(number)) == bits(observation[..., i])).all(), number
    assert (bits(column('u0')) == bits(action[..., 0])).all()
    assert (bits(column('reward')) == bits(reward)).all()
    for flag in ('terminated', 'truncated'):
        assert field(flag).dtype == np.bool_ and (column(flag) == field(flag)).all()
    units = json.loads(table.schema.metadata[b'libration.units'])
    assert units['q0'] == 'm' and units['v0'] == 'm/s' and units['u0'] == 'm/s\u00b2', units
    ends, rest = field('ends'), pq.read_table(f'tables/ends/{name}.parquet')
    assert list(ends.dtype.names) == rest.column_names
    for column in ends.dtype.names:
        assert np.array_equal(ends[column], rest[column].to_numpy(), equal_nan=ends[column].dtype.kind == 'f')
    over = field('terminated') | field('truncated')
    closed = ends['terminated'] | ends['truncated']
    assert closed.sum() == over.sum() == chunk['holds']['ends']
    # Whoever goes on is listed with what it sees next, which is where the next chunk of the group begins.
    assert (~closed).sum() == (~over[-1]).sum()
    follower = f"{name[:7]}{int(name[7:]) + 1:08}"
    if any(other['chunk'] == follower for other in chunks):
        begins = np.load(f'arrays/observation/{follower}.npy')[0]
        for end in ends[~closed]:
            assert end['step'] == begin + shape[0]
            assert tuple(begins[end['environment'] - first]) == tuple(end[s] for s in seen)
assert rows == 350 * 450
whole = pq.read_table('tables/transitions')
assert whole.num_rows == rows
"#;
    let run = Command::new(python).args(["-c", script]).current_dir(dir.path()).assert();
    run.success();
}
