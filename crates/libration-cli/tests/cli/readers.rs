//! Data sets and the schema of configurations as other programs read them.

use std::path::Path;

use assert_cmd::Command;
use tempfile::TempDir;

use crate::rollout::{SETTINGS, settings, write};

/// A Python with what `tools/requirements.txt` lists: `LIBRATION_PYTHON`, or a virtual environment in `target/python`.
fn python() -> Option<std::path::PathBuf> {
    let local = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/python/bin/python");
    let named = std::env::var_os("LIBRATION_PYTHON").map(Into::into);
    named.or_else(|| local.exists().then_some(local))
}

/// Runs a script beside data sets, if there is a Python.
fn run(dir: &TempDir, script: &str) {
    let Some(python) = python() else {
        eprintln!(
            "skipped: set LIBRATION_PYTHON to a Python with what tools/requirements.txt lists"
        );
        return;
    };
    let mut command = Command::new(python);
    command.args(["-c", script]).current_dir(dir.path()).assert().success();
}

#[test]
fn numpy_and_pyarrow_read_the_same_transitions_ends_and_units() {
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
    assert units['q0'] == 'rad' and units['v0'] == 'rad/s' and units['u0'] == 'rad/s\u00b2', units
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
    run(&dir, script);
}

/// Two groups; most episodes end by themselves or by the limit, the others with the data set.
const EPISODES: &str = "\
seed = 8
num_envs = 20
steps = 130
max_episode_steps = 40
[chunk]
num_envs = 12
steps = 50
[task.regulate]
bound = 0.9
[start]
q = [-1.0, 1.0]
v = [-1.0, 1.0]
[policy.random]
low = -9.0
high = 9.0
";

#[test]
fn minari_reads_every_episode_with_the_numbers_of_the_tensors() {
    let dir = settings(EPISODES);
    write(&dir, "arrays", "--format npy").success();
    write(&dir, "episodes", "--format minari").success();
    let script = r#"
import json, minari, numpy as np
chunks = [json.loads(line) for line in open('arrays/manifest.jsonl')][1:]
tensors = {}
for name in ('observation', 'action', 'reward', 'terminated', 'truncated'):
    groups = {}
    for chunk in chunks:
        group = groups.setdefault(chunk['chunk'].split('-')[0], [])
        group.append(np.load(f"arrays/{name}/{chunk['chunk']}.npy"))
    tensors[name] = np.concatenate([np.concatenate(group) for group in groups.values()], axis=1)
ends = np.concatenate([np.load(f"arrays/ends/{chunk['chunk']}.npy") for chunk in chunks])
seen_after = {(end['step'], end['environment']): (end['q0'], end['v0']) for end in ends}

data = minari.MinariDataset('episodes/data')
assert data.spec.dataset_id == 'libration/oscillator-regulate-v0'
assert data.total_steps == 20 * 130, data.total_steps
assert data.observation_space.shape == (2,) and data.observation_space.dtype == np.float32
assert data.action_space.low[0] == -9 and data.action_space.high[0] == 9
told = list(data.storage.get_episode_metadata(range(data.total_episodes)))
covered = np.zeros((130, 20), int)
kinds = set()
for episode, about in zip(data.iterate_episodes(), told, strict=True):
    assert episode.id == about['id'] and len(episode) == about['total_steps'] <= 40
    i, first, last = about['environment'], about['step'], about['step'] + len(episode) - 1
    covered[first:last + 1, i] += 1
    there = slice(first, last + 1), i
    same = lambda a, b: a.dtype == b.dtype and a.tobytes() == b.tobytes()
    assert same(episode.observations[:-1], tensors['observation'][there])
    assert same(episode.actions, tensors['action'][there])
    assert same(episode.rewards, tensors['reward'][there])
    assert tuple(episode.observations[-1]) == tuple(seen_after[last + 1, i])
    assert not (episode.terminations[:-1] | episode.truncations[:-1]).any()
    over, cut = episode.terminations[-1], episode.truncations[-1]
    assert over == tensors['terminated'][last, i]
    # A limit cuts off, and so does the end of the data set.
    assert cut == ((tensors['truncated'][last, i] or last == 129) and not over)
    kinds.add((bool(over), len(episode) == 40, last == 129))
    assert episode.observations[0] in data.observation_space
    assert all(action in data.action_space for action in episode.actions)
assert (covered == 1).all()
assert {(True, False, False), (False, True, False), (False, False, True)} <= kinds, kinds
"#;
    run(&dir, script);
}

#[test]
fn the_schema_admits_the_default_and_refuses_what_the_parser_refuses() {
    let dir = TempDir::new().unwrap();
    for (flag, file) in [("--schema", "schema.json"), ("--print-config", "default.toml")] {
        let printed =
            Command::cargo_bin("libration").unwrap().args(["lab", flag]).output().unwrap();
        std::fs::write(dir.path().join(file), printed.stdout).unwrap();
    }
    let script = r#"
import copy, json, tomllib, jsonschema
schema = json.load(open('schema.json'))
default = tomllib.load(open('default.toml', 'rb'))
valid = jsonschema.validators.validator_for(schema)(schema).is_valid
# Fails here if the schema and the configuration have different keys.
jsonschema.validate(default, schema)
for path, bad in [
    ('system/oscillator/k', 0),
    ('system/oscillator/m', '1'),
    ('drift/dt', []),
    ('drift/dt', [0.1, 0.1]),
    ('drift/steps', 0),
    ('drift/steps', 1_000_000_001),
    ('convergence/coarsest', 40),
    ('convergence/systems', []),
    ('nonlinear/systems', ['keppler']),
    ('nonlinear/steps', 15),
    ('nonlinear/turns', 99),
    ('precision/dt', [0]),
    ('integrators', ['rk5']),
    ('effort', 'quik'),
    ('start', {'x': 1}),
]:
    changed = copy.deepcopy(default)
    *tables, key = path.split('/')
    table = changed
    for name in tables:
        table = table[name]
    table[key] = bad
    assert not valid(changed), path
"#;
    run(&dir, script);
}
