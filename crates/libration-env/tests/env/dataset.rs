//! Tests of data sets against the engine.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use libration::State;
use libration::ensemble::{All, Execution};
use libration::integrator::VelocityVerlet;
use libration::rl::policy::Linear;
use libration::rl::start::UniformStart;
use libration::rl::task::SwingUp;
use libration::rl::{Environment, Environments, Plan, Rollout};
use libration::system::{BaselineOnly, Pendulum};
use libration_env::dataset::{
    DataFormat, Dataset, Monitor, VerifyOptions, WriteJob, parse, verify, write,
};
use libration_settings::ConfigCommand;

const SETTINGS: &str = "\
seed = 3
num_envs = 100
steps = 75
max_episode_steps = 40
integrator = \"velocity-verlet\"
dt = 0.05
[chunk]
num_envs = 64
steps = 30
[system.pendulum]
omega2 = 4.0
[task.swing-up]
velocity = 0.2
effort = 0.01
[start]
q = [-0.5, 0.5]
[policy.linear]
weights = [1.0, 0.5, -0.25]
bias = 0.125
";

/// Counts what is done.
#[derive(Default)]
struct Count(AtomicU64, AtomicU64);

impl Monitor for Count {
    fn on_written(&self, transitions: u64, bytes: u64) {
        self.0.fetch_add(transitions, Ordering::Relaxed);
        self.1.fetch_add(bytes, Ordering::Relaxed);
    }
}

/// The numbers of an array of floats.
fn floats(path: &Path) -> Vec<f32> {
    let bytes = fs::read(path).unwrap();
    let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let (numbers, rest) = bytes[header..].as_chunks();
    assert!(rest.is_empty());
    numbers.iter().map(|&four| f32::from_le_bytes(four)).collect()
}

#[test]
fn a_data_set_holds_the_bits_of_the_environments_of_the_engine() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("set");
    let dataset = parse(SETTINGS, "set.toml").unwrap();
    assert_eq!((dataset.len(), dataset.share([1, 2]), dataset.share([2, 2])), (7500, 4800, 2700));
    let job = WriteJob {
        dataset: &dataset,
        format: DataFormat::Npy,
        shard: [1, 1],
        out: &out,
        resume: false,
        execution: Execution::serial(),
    };
    let count = Count::default();
    let manifest = write(&job, &count).unwrap();
    assert_eq!(count.0.into_inner(), 7500);
    let bytes: u64 = manifest.chunks.iter().flat_map(|c| &c.files).map(|file| file.bytes).sum();
    assert_eq!(count.1.into_inner(), bytes);

    let task = SwingUp { velocity: 0.2, effort: 0.01 };
    let start = UniformStart(State { q: [-0.5], v: [0.0] }, State { q: [0.5], v: [0.0] });
    let pendulum = All(BaselineOnly(Pendulum { omega2: 4.0_f32 }));
    let world = Environment::new(pendulum, VelocityVerlet, 0.05, task, start).limit(40);
    let mut all = Environments::<f32, _, 3, 1>::new(world, 100, 3, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(Plan::new(75, 100).truncated()).unwrap();
    let policy = Linear { weights: [[1.0, 0.5, -0.25]], bias: [0.125] };
    all.rollout(policy, &mut rollout).unwrap();
    for (group, first, len) in [(0, 0, 64), (1, 64, 36)] {
        for (chunk, from, steps) in [(0, 0, 30), (1, 30, 30), (2, 60, 15)] {
            let file =
                |folder: &str| floats(&out.join(format!("{folder}/{group:06}-{chunk:08}.npy")));
            let (seen, done, paid) = (file("observation"), file("action"), file("reward"));
            assert_eq!(
                [seen.len(), done.len(), paid.len()],
                [3 * steps * len, steps * len, steps * len]
            );
            for at in 0..steps * len {
                let (t, n) = (from + at / len, first + at % len);
                assert_eq!(seen[3 * at..][..3], rollout.seen(t, n));
                assert_eq!(
                    (done[at], paid[at]),
                    (rollout.done(t, n)[0], rollout.reward()[t * 100 + n])
                );
            }
        }
    }
}

#[test]
fn settings_are_read_back_from_a_manifest_whatever_they_are() {
    for text in [
        "",
        SETTINGS,
        "dtype = \"f64\"\nnum_envs = 3\nsteps = 5\n[task.regulate]\nbound = inf\n[policy.constant]\naction = -1",
        "num_envs = 3\nsteps = 5\n[system.duffing]\n[task.track]\nphase = 0.1\n[policy.random]\n[noise]\nskew = 0.1",
    ] {
        let dir = tempfile::tempdir().unwrap();
        let out = dir.path().join("set");
        let dataset = parse(text, "set.toml").unwrap();
        let dataset = if text.is_empty() { dataset.transitions(4096).unwrap() } else { dataset };
        let job = WriteJob {
            dataset: &dataset,
            format: DataFormat::Parquet,
            shard: [1, 1],
            out: &out,
            resume: false,
            execution: Execution::serial(),
        };
        write(&job, &Count::default()).unwrap();
        let again = Execution::serial().threads(3).unwrap();
        let count = Count::default();
        let verification =
            verify(&out, VerifyOptions { replay: Some(&again), repair: None }, &count).unwrap();
        assert_eq!(verification.flaws, [], "{text}");
        assert_eq!(u128::from(count.0.into_inner()), dataset.len());
    }
    assert_eq!(Dataset::default().len(), 4096 * 1024);
}

#[test]
fn the_printed_settings_are_the_defaults() {
    assert_eq!(parse("", "set.toml").unwrap(), Dataset::default());
}

#[test]
fn each_key_of_the_command_is_read_and_no_other() {
    for key in ConfigCommand::all_keys() {
        let own = ConfigCommand::ROLLOUT.keys.contains(&key);
        match parse(&format!("{key} = true"), "set.toml") {
            Ok(_) => assert!(!own, "{key}"),
            Err(error) => assert!(own && error.message().contains(key), "{error}"),
        }
    }
}

/// The settings above with a system and a task by equations that have the operations of the compiled ones.
fn by_equations(system: &Path) -> String {
    let file = "\
[system]
name = 'swing'
coordinates = ['x']
inputs = ['u']
parameters = { omega2 = 1.0 }
acceleration.x = '-omega2*sin(x) + u'
start = { x = 0.0 }
";
    fs::write(system, file).unwrap();
    let task = "\
[system.equations]
of = '<FILE>'
parameters = { omega2 = 4.0 }
[task.expressions]
observe = ['-cos(x)', '-sin(x)', \"x'\"]
reward = \"-cos(before(x)) - 1 - 0.2*before(x')^2 - 0.01*u^2\"
start = { x = [-0.5, 0.5] }
";
    let task = task.replace("<FILE>", system.to_str().unwrap());
    let (head, tail) = SETTINGS.split_once("[system.pendulum]").unwrap();
    let (_, policy) = tail.split_once("[policy.linear]").unwrap();
    format!("{head}{task}[policy.linear]{policy}")
}

#[test]
fn a_data_set_of_equations_holds_the_bits_of_the_compiled_system_in_each_format() {
    let dir = tempfile::tempdir().unwrap();
    let system = dir.path().join("swing.toml");
    let text = by_equations(&system);
    let compiled = SETTINGS.replace("q = [-0.5, 0.5]", "q = [-0.5, 0.5]\nv = [0.0, 0.0]");
    for format in [DataFormat::Npy, DataFormat::Parquet, DataFormat::Minari] {
        let write_all = |name: &str, text: &str| {
            let out = dir.path().join(format!("{name}-{}", format.name()));
            let dataset = parse(text, "set.toml").unwrap();
            let execution = Execution::serial();
            let job = WriteJob {
                dataset: &dataset,
                format,
                shard: [1, 1],
                out: &out,
                resume: false,
                execution,
            };
            write(&job, &Count::default()).unwrap();
            out
        };
        let (wanted, found) = (write_all("compiled", &compiled), write_all("equations", &text));
        if format == DataFormat::Npy {
            for folder in ["observation", "action", "reward", "terminated", "truncated"] {
                for entry in fs::read_dir(wanted.join(folder)).unwrap() {
                    let name = entry.unwrap().file_name();
                    let [wanted, found] = [&wanted, &found]
                        .map(|out| fs::read(out.join(folder).join(&name)).unwrap());
                    assert!(wanted == found, "{folder}/{name:?}");
                }
            }
        }
        // A manifest needs no other file.
        fs::rename(&system, dir.path().join("elsewhere")).unwrap();
        let execution = Execution::serial();
        let how = VerifyOptions { replay: Some(&execution), repair: None };
        let flaws = verify(&found, how, &Count::default()).unwrap().flaws;
        assert!(flaws.is_empty(), "{flaws:?}");
        fs::rename(dir.path().join("elsewhere"), &system).unwrap();
    }
}

#[test]
fn what_is_wrong_with_a_data_set_of_equations_is_said() {
    let dir = tempfile::tempdir().unwrap();
    let text = by_equations(&dir.path().join("swing.toml"));
    // Weights may be rows.
    let rows = text.replace("weights = [1.0, 0.5, -0.25]", "weights = [[1.0, 0.5, -0.25]]");
    assert_eq!(parse(&rows, "set.toml").unwrap(), parse(&text, "set.toml").unwrap());
    // A column of its own name.
    let column = by_equations(&dir.path().join("column.toml"));
    let file = dir.path().join("column.toml");
    fs::write(
        &file,
        fs::read_to_string(&file).unwrap().replace("'u'", "'lost'").replace("+ u", "+ lost"),
    )
    .unwrap();
    let column = column.replace("0.01*u^2", "0.01*lost^2");
    let error = parse(&column, "set.toml").unwrap_err().to_string();
    assert!(error.contains("`lost` is the name of a column already"), "{error}");
    for (old, new, wanted) in [
        ("swing.toml", "swong.toml", "cannot read"),
        ("omega2 = 4.0", "omega = 4.0", "unknown parameter `omega`"),
        ("-cos(before(x))", "-cos(before(y))", "unknown name `before(y)`"),
        ("{ x = [-0.5, 0.5] }", "{ y = 1 }", "unknown state `y`"),
        (
            "[policy.linear]\nweights = [1.0, 0.5, -0.25]",
            "[policy.linear]\nweights = [1]",
            "it must have 3",
        ),
        ("bias = 0.125", "bias = [1, 2]", "`policy` has 2 numbers"),
        (
            "weights = [1.0, 0.5, -0.25]",
            "weights = [[1, 2], [3, 4]]",
            "has 4 numbers, but it must have 3",
        ),
        ("observe = ['-cos(x)'", "observe = ['x', 'x'", "`x` is the name of a column already"),
        (
            "observe = ['-cos(x)'",
            "observe = [\"x''\"",
            "depends on inputs through `acceleration.x`",
        ),
        (
            "[system.equations]",
            "[start]\nq = [0, 1]\n[system.equations]",
            "`start` belongs to systems",
        ),
        (
            "[system.equations]",
            "[system.pendulum]\n[system.equations]",
            "`system` must be one table",
        ),
        ("[task.expressions]", "[task.regulate]\n[task.expressions]", "expected"),
    ] {
        let bad = text.replace(old, new);
        assert_ne!(bad, text, "{old}");
        let error = parse(&bad, "set.toml").unwrap_err().to_string();
        assert!(error.contains(wanted) && error.contains("set.toml:"), "{error}");
    }
}
