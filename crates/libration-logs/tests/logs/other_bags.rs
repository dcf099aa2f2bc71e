//! Bags of ROS 1 by `rosbags`, and a log of PX4 compared with what `pyulog` reads.

use std::collections::BTreeMap;

use libration_logs::ClockChoice;

use crate::{open, path};

#[test]
fn bags_of_ros_1_have_stamps_and_numbers() {
    for name in ["ros1.bag", "ros1_lz4.bag", "ros1_bz2.bag"] {
        let log = open(name, ClockChoice::Log);
        let topics: Vec<_> =
            log.topics().into_iter().map(|t| (t.name, t.message_type, t.count)).collect();
        let wanted = ("/joint_states".to_owned(), "sensor_msgs/JointState".to_owned(), 40);
        assert_eq!(topics, [wanted]);
        let [log_times, headers] = [ClockChoice::Log, ClockChoice::Header]
            .map(|clock| log.exact_stamps("/joint_states", clock).unwrap());
        let start = 1_700_000_000_123_456_789;
        for k in 0..40 {
            let header = start + 20_000_000 * k;
            assert_eq!(headers[k as usize], Some(header));
            assert_eq!(log_times[k as usize], Some(header + 1000 * k));
        }
        assert_eq!(log.series("/joint_states.position[0]").unwrap().values[3], 1.5);
        assert_eq!(log.series("/joint_states.header.seq").unwrap().values[39], 39.0);
        assert!(log.notes().is_empty(), "{:?}", log.notes());
    }
}

#[test]
fn every_field_of_a_log_of_px4_is_that_of_pyulog() {
    let log = open("px4.ulg", ClockChoice::Log);
    let text = std::fs::read_to_string(path("px4.json")).unwrap();
    let topics: BTreeMap<String, BTreeMap<String, Vec<f64>>> = serde_json::from_str(&text).unwrap();
    assert_eq!(log.topics().len(), topics.len());
    for (topic, fields) in &topics {
        for (field, values) in fields {
            let series = log.series(&format!("{topic}.{field}")).unwrap();
            assert_eq!(&series.values, values, "{topic}.{field}");
        }
        let stamps = log.exact_stamps(topic, ClockChoice::Log).unwrap();
        let wanted: Vec<_> = fields["timestamp"].iter().map(|&us| Some(us as i64 * 1000)).collect();
        assert_eq!(stamps, wanted);
    }
    let sampled = log.exact_stamps("vehicle_imu", ClockChoice::Header).unwrap();
    assert_eq!(sampled[0], Some((topics["vehicle_imu"]["timestamp_sample"][0] as i64) * 1000));
    assert!(log.notes()[0].contains("12 ms"), "{:?}", log.notes());
}
