//! Bags, compared with what the packages `mcap` and `mcap-ros2-support` read.

use std::collections::BTreeMap;

use libration_logs::{ClockChoice, Log, LogError};

use crate::{open, path};

/// Log time, publish time and header stamp in ns, and a value, of each message of each topic.
type Expected = BTreeMap<String, Vec<(i64, i64, i64, f64)>>;

fn expected(name: &str) -> Expected {
    let text = std::fs::read_to_string(path(name)).expect(name);
    serde_json::from_str(&text).expect(name)
}

const VALUES: [(&str, &str); 3] = [
    ("/joint_states", "/joint_states.position[3]"),
    ("/cmd", "/cmd.twist.angular.z"),
    ("/statistics", "/statistics.pairs[1].b"),
];

#[test]
fn stamps_of_all_clocks_and_values_are_those_of_the_reference() {
    for name in ["lz4", "none"] {
        let log = open(&format!("{name}.mcap"), ClockChoice::Header);
        let expected = expected(&format!("{name}.json"));
        for (topic, signal) in VALUES {
            let rows = &expected[topic];
            let columns: [Vec<_>; 3] = [
                rows.iter().map(|row| Some(row.0)).collect(),
                rows.iter().map(|row| Some(row.1)).collect(),
                rows.iter().map(|row| Some(row.2)).collect(),
            ];
            for (clock, wanted) in ClockChoice::ALL.into_iter().zip(columns) {
                if topic == "/statistics" && clock == ClockChoice::Publish {
                    continue;
                }
                assert_eq!(log.exact_stamps(topic, clock).unwrap(), wanted, "{topic} {clock:?}");
            }
            let series = log.series(signal).unwrap();
            let values: Vec<f64> = rows.iter().map(|row| row.3).collect();
            assert_eq!(series.values, values);
            // The zero of all clocks is the first log time.
            let first = expected.values().map(|rows| rows[0].0).min().unwrap();
            let seconds: Vec<f64> = rows.iter().map(|row| (row.2 - first) as f64 / 1e9).collect();
            assert_eq!(series.time, seconds);
            assert_eq!(log.stamps(topic).unwrap(), seconds);
        }
    }
}

#[test]
fn a_bag_lists_its_topics_types_clocks_and_signals() {
    let log = open("zstd.mcap", ClockChoice::Log);
    let topics: Vec<_> = log
        .topics()
        .into_iter()
        .map(|t| (t.name, t.message_type, t.count, t.clocks.len()))
        .collect();
    let row =
        |name: &str, kind: &str, count, clocks| (name.to_owned(), kind.to_owned(), count, clocks);
    assert_eq!(
        topics,
        [
            row("/joint_states", "sensor_msgs/msg/JointState", 160, 3),
            row("/cmd", "geometry_msgs/msg/TwistStamped", 144, 3),
            row("/statistics", "test_msgs/msg/Statistics", 16, 2),
        ]
    );
    let names: Vec<_> = log.signals().into_iter().map(|signal| signal.name).collect();
    for wanted in [
        "/joint_states.header.stamp.nanosec",
        "/joint_states.velocity[0]",
        "/cmd.twist.linear.x",
        "/statistics.small[2]",
        "/statistics.some[1]",
        "/statistics.last",
    ] {
        assert!(names.iter().any(|name| name == wanted), "{wanted} in {names:?}");
    }
    assert_eq!(log.series("/statistics.small[2]").unwrap().values, [-3.0; 16]);
    assert_eq!(log.series("/statistics.active").unwrap().values, [1.0; 16]);
    assert_eq!(log.series("cmd.twist.linear.x").unwrap().values[2], 1.0);
}

#[test]
fn stamps_stay_in_file_order_and_those_that_go_back_are_counted() {
    let log = open("zstd.mcap", ClockChoice::Log);
    let stamps = log.stamps("/joint_states").unwrap();
    assert_eq!(stamps.windows(2).filter(|pair| pair[1] < pair[0]).count(), 2);
    let notes = log.notes();
    assert!(notes.iter().any(|note| note.contains("out of order")), "{notes:?}");
}

#[test]
fn a_truncated_bag_is_read_as_far_as_it_goes() {
    let whole = open("zstd.mcap", ClockChoice::Log);
    let part = open("truncated.mcap", ClockChoice::Log);
    let [whole, stamps] = [&whole, &part].map(|log| log.stamps("/joint_states").unwrap());
    assert!(stamps.len() > 30 && stamps.len() < whole.len(), "{}", stamps.len());
    assert_eq!(stamps, whole[..stamps.len()]);
    let notes = part.notes();
    assert!(notes.iter().any(|note| note.contains("the end of the file is missing")), "{notes:?}");
}

#[test]
fn json_messages_have_signals() {
    let log = open("json.mcap", ClockChoice::Log);
    assert_eq!(log.series("/pose.x").unwrap().values[..3], [0.0, 0.25, 0.5]);
    assert_eq!(log.series("/pose.list[1].y").unwrap().values[3], -3.0);
    assert_eq!(log.series("/pose.ok").unwrap().values[..2], [1.0, 0.0]);
    let error = log.stamps_of("/pose", ClockChoice::Header).unwrap_err();
    assert!(matches!(error, LogError::NoClock { .. }), "{error}");
}

#[test]
fn unknown_names_are_reported_with_the_nearest() {
    let log = open("none.mcap", ClockChoice::Log);
    let text = |error: LogError| error.to_string();
    let error = text(log.series("/joint_state.position[3]").unwrap_err());
    assert!(error.contains("help: the nearest names are `/joint_states.position[3]`"), "{error}");
    let error = text(log.series("/joint_states.position[9]").unwrap_err());
    assert!(error.contains("no signal") && error.contains("position[3]"), "{error}");
    let error = text(log.stamps("/cmds").unwrap_err());
    assert!(error.contains("the file has no topic `/cmds`; expected one of"), "{error}");
    let error = text(Log::open(&path("no.mcap"), &Default::default()).err().unwrap());
    assert!(error.contains("cannot be read"), "{error}");
}
