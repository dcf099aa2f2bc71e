//! Bags of ROS 2 that SQLite wrote.

use std::fs;

use libration_logs::{ClockChoice, Log, ReadOptions};

use crate::{open, path};

/// The log time of a message of `/joint_states` in ns, as `tools/make_db3_files.py` writes it.
fn log_time(i: i64) -> i64 {
    1_700_000_000_000_000_000 + 10_000_000 * i + 1000 * (i * i % 7)
}

#[test]
fn a_bag_of_humble_has_stamps_of_both_clocks_and_fields_of_common_types() {
    let log = open("humble.db3", ClockChoice::Log);
    let topics: Vec<_> =
        log.topics().into_iter().map(|t| (t.name, t.count, t.clocks.len())).collect();
    let row = |name: &str, count, clocks| (name.to_owned(), count, clocks);
    let rows = [
        row("/joint_states", 40, 2),
        row("/load", 40, 1),
        row("/camera", 2, 2),
        row("/array", 3, 1),
    ];
    assert_eq!(topics, rows);
    let stamps = |topic: &str, clock| log.exact_stamps(topic, clock).unwrap();
    let logged: Vec<_> = (0..40).map(|i| Some(log_time(i))).collect();
    let stamped: Vec<_> = (0..40).map(|i| Some(log_time(i) - 1_000_000)).collect();
    assert_eq!(stamps("/joint_states", ClockChoice::Log), logged);
    assert_eq!(stamps("/joint_states", ClockChoice::Header), stamped);
    // Its messages need overflow pages.
    assert_eq!(stamps("/camera", ClockChoice::Header), [stamped[3], stamped[23]]);
    assert_eq!(log.series("/array.data[125]").unwrap().values, [125.0, 125.25, 125.5]);
    assert_eq!(log.series("/array.data[129]").unwrap().values, [129.5]);
    let values: Vec<f64> = (0..40).map(|i| f64::from(i) + 0.25).collect();
    assert_eq!(log.series("/joint_states.position[1]").unwrap().values, values);
    let error = log.exact_stamps("/load", ClockChoice::Header).unwrap_err().to_string();
    assert!(error.contains("no definition of `my_msgs/msg/Load`"), "{error}");
    let notes = log.notes();
    assert!(notes.iter().any(|note| note.contains("no definitions of messages")), "{notes:?}");
}

#[test]
fn definitions_of_the_file_decode_other_types() {
    let log = open("iron.db3", ClockChoice::Header);
    assert_eq!(log.series("/load.newtons").unwrap().values, [0.0, 0.5, 1.0, 1.5, 2.0]);
    assert_eq!(log.notes(), Vec::<String>::new());
}

#[test]
fn a_write_ahead_log_beside_the_file_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("run.db3");
    fs::copy(path("humble.db3"), &bag).unwrap();
    let warning = || {
        let log = Log::open(&bag, &ReadOptions::default()).unwrap();
        log.notes().into_iter().find(|note| note.starts_with("warning: "))
    };
    assert_eq!(warning(), None);
    fs::write(folder.path().join("run.db3-wal"), [0; 32]).unwrap();
    assert_eq!(warning(), None, "a log without changes");
    fs::write(folder.path().join("run.db3-wal"), [0; 100]).unwrap();
    let text = warning().unwrap();
    assert!(text.contains("messages may be missing: `run.db3-wal`"), "{text}");
}

#[test]
fn a_truncated_database_is_read_as_far_as_it_goes_and_others_are_no_bags() {
    let whole = fs::read(path("humble.db3")).unwrap();
    let read = |bytes: Vec<u8>| Log::from_bytes(bytes, &ReadOptions::default());
    let part = read(whole[..whole.len() * 3 / 4].to_vec()).unwrap();
    let stamps = part.exact_stamps("/joint_states", ClockChoice::Log).unwrap();
    assert!(!stamps.is_empty() && stamps.len() < 40, "{}", stamps.len());
    assert!(part.notes().iter().any(|note| note.contains("the end of the file is missing")));
    let error = read(whole[..50].to_vec()).err().unwrap().to_string();
    assert!(error.contains("ends within its header"), "{error}");
    let mut other = whole;
    let at = other.windows(12).position(|bytes| bytes == b"CREATE TABLE").unwrap();
    other[at..at + 512].fill(0);
    let error = read(other).err().unwrap().to_string();
    assert!(error.contains("expected those of a ROS 2 bag"), "{error}");
}

#[test]
fn errors_have_the_reason() {
    let error =
        |name: &str| Log::open(&path(name), &ReadOptions::default()).err().unwrap().to_string();
    assert_eq!(error("empty.db3"), "it has no messages");
    let text = error("without_rowid.db3");
    assert!(text.contains("`messages` is WITHOUT ROWID, which is not supported"), "{text}");
    let text = error("text_stamps.db3");
    assert!(text.contains("3 messages has text or decimals, which is not supported"), "{text}");
    let log = open("commented.db3", ClockChoice::Log);
    assert_eq!(log.stamps("/load").unwrap(), [0.0, 0.01, 0.02]);
    assert_eq!(log.series("/load.data").unwrap().values, [0.0, 0.5, 1.0]);
}

#[test]
fn a_directory_is_read_if_it_has_one_file() {
    let folder = tempfile::tempdir().unwrap();
    let open = || Log::open(folder.path(), &ReadOptions::default());
    let error = || open().err().unwrap().to_string();
    assert!(error().contains("the directory is empty"));
    let metadata = folder.path().join("metadata.yaml");
    fs::write(&metadata, "rosbag2_bagfile_information:\n  version: 5\n").unwrap();
    assert!(
        error().contains("no .db3 or .mcap file; expected a ROS 2 bag; it has `metadata.yaml`")
    );
    let text = Log::open(&metadata, &ReadOptions::default()).err().unwrap().to_string();
    assert!(text.contains("expected the directory of the bag"), "{text}");
    fs::copy(path("humble.db3"), folder.path().join("run_0.db3")).unwrap();
    assert_eq!(open().unwrap().topics().len(), 4);
    fs::copy(path("zstd.mcap"), folder.path().join("run_1.mcap")).unwrap();
    assert!(error().contains("2 files of bags; expected one of them: `run_0.db3`, `run_1.mcap`"));
}
