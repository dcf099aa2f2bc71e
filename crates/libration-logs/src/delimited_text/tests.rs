//! Tests of tables in text.

use super::*;
use crate::signal::ClockChoice;
use crate::source::Source;

fn table(text: &str) -> Table {
    let Text { columns, notes, .. } = read(text.as_bytes()).unwrap();
    Table::new("text", columns, &ReadOptions::default(), notes).unwrap()
}

fn series(text: &str, name: &str) -> (Vec<f64>, Vec<f64>) {
    let series = table(text).series(name, ClockChoice::Log).unwrap();
    (series.time, series.values)
}

#[test]
fn commas_semicolons_tabs_and_spaces_separate_cells() {
    for text in
        ["t,x\n0,1\n0.5,2\n", "t;x\n0;1\n0.5;2\n", "t\tx\n0\t1\n0.5\t2\n", "# t x\n0 1\n0.5 2\n"]
    {
        assert_eq!(series(text, "x"), (vec![0.0, 0.5], vec![1.0, 2.0]), "{text}");
    }
    assert_eq!(series("0 1\n1 2\n", "column_2"), (vec![0.0, 1.0], vec![1.0, 2.0]));
}

#[test]
fn stamps_since_1970_keep_nanoseconds() {
    let wanted = vec![0.0, 0.001_000_017];
    let text = "%time,field.x\n1700000000000000000,1\n1700000000001000017,2\n";
    assert_eq!(series(text, "field.x").0, wanted);
    let text = "x,stamp\n1,1700000000.000000000\n2,1700000000.001000017\n";
    assert_eq!(series(text, "x").0, wanted);
    let log = "(1436509052.249713) vcan0 044#2A36\n(1436509052.250714) vcan0 044#2A37\n";
    assert_eq!(table(log).stamps("column_1", ClockChoice::Log).unwrap(), [0.0, 0.001_001]);
}

#[test]
fn cells_without_a_number_are_left_out_and_nan_is_a_value() {
    let (time, values) = series("t,x [m]\n0,1\n1,\n2,nan\n3,4\n", "x");
    assert_eq!(time, [0.0, 2.0, 3.0]);
    assert!(values[1].is_nan() && values[2] == 4.0);
}

#[test]
fn every_column_of_epochs_is_a_topic_with_the_same_zero() {
    let text = "callback_start,callback_end\n1700000000000000000,1700000000000400000\n1700000000010000000,\n";
    let table = table(text);
    let names: Vec<_> = table.topics().into_iter().map(|topic| (topic.name, topic.count)).collect();
    assert_eq!(names, [("callback_start".to_owned(), 2), ("callback_end".to_owned(), 1)]);
    assert_eq!(table.stamps("callback_end", ClockChoice::Log).unwrap(), [0.0004]);
}

#[test]
fn epochs_in_decimals_have_the_unit_of_their_size() {
    let text = "start,end\n1700000000000000000,1.7000000000004175e+18\n1700000000010000000,\n";
    assert_eq!(table(text).stamps("end", ClockChoice::Log).unwrap(), [0.000_417_5]);
    let text = "time,x\n1760000000000.000,0\n1760000000005.250,1\n";
    assert_eq!(series(text, "x").0, [0.0, 0.005_25]);
    let error = table("t,x\n0,1\n1e300,2\n").exact_stamps("t", ClockChoice::Log).unwrap_err();
    assert!(error.to_string().contains("expected less than 292 years"), "{error}");
}

#[test]
fn iso_8601_is_a_time_and_other_text_in_its_column_an_error() {
    let text = "time,x\n2025-10-09T08:53:20.123466+02:00,0\n2025-10-09 06:53:20.128431Z,1\n";
    assert_eq!(series(text, "x").0, [0.0, 0.004_965]);
    let stamps = table(text).exact_stamps("time", ClockChoice::Log).unwrap();
    assert_eq!(stamps[0], Some(1_759_992_800_123_466_000));
    let input = Input::Memory("time,x\n00:00:00.005,0\n00:00:00.010,1\n".into());
    let error = open(&input, &ReadOptions::default()).err().unwrap().to_string();
    assert!(error.contains("the column `time` has no numbers"), "{error}");
}

#[test]
fn seconds_and_nanoseconds_are_one_stamp() {
    for (text, name) in [
        ("secs,nsecs,x\n1760000000,0,0\n1760000000,5000000,1\n", "time"),
        ("h.stamp.sec,h.stamp.nanosec,x\n1760000000,1,0\n1760000000,5000001,1\n", "h.stamp"),
        ("x,sec,nanosec\n0,0,999000000\n1,1,4000000\n", "time"),
    ] {
        assert_eq!(series(text, "x").0, [0.0, 0.005], "{text}");
        assert_eq!(table(text).time_name().unwrap(), name);
    }
}

#[test]
fn seconds_and_nanoseconds_without_names_are_recognised_by_their_shape() {
    let epoch = "1700000000,999000000,base,0.5\n1700000001,4000000,base,0.6\n";
    let simulated = "7,980000000,0\n7,990000000,1\n8,0,2\n8,10000000,3\n";
    assert_eq!(series(epoch, "column_4").0, [0.0, 0.005]);
    assert_eq!(series(simulated, "column_3").0, [0.0, 0.01, 0.02, 0.03]);
    let notes = table(epoch).notes().join("\n");
    assert!(notes.contains("`column_1` and `column_2` are taken as the seconds"), "{notes}");
    assert!(notes.contains("the column of time is `time`"), "{notes}");
    // Rows and an encoder, a motor and an encoder, seconds and a reading, and what is above a second.
    for text in [
        "0,1000000,3\n1,1000100,3\n2,1000200,3\n",
        "5,1000000,3\n5,1000100,3\n5,1000200,3\n",
        "1700000000,512,1\n1700000001,513,1\n1700000002,514,1\n",
        "1700000000,5,1\n1700000001,1000000000,1\n",
        "1700000000,900000000,1\n1700000000,1000000,1\n",
    ] {
        assert_eq!(table(text).time_name().unwrap(), "column_1", "{text}");
    }
    let options = ReadOptions::of_time("column_2");
    let Text { columns, notes, .. } = read(epoch.as_bytes()).unwrap();
    let table = Table::new("text", columns, &options, notes).unwrap();
    assert_eq!(table.time_name().unwrap(), "column_2");
}

#[test]
fn decimal_commas_are_points_and_thousands_are_not() {
    for text in [
        "t;x\n0,25;1,5\n0,75;2,5\n",
        "\"t\",\"x\"\n\"0,25\",\"1,5\"\n\"0,75\",\"2,5\"\n",
        "t x\n0,25 1,5\n0,75 2,5\n",
    ] {
        assert_eq!(series(text, "x"), (vec![0.0, 0.5], vec![1.5, 2.5]), "{text}");
    }
    let (time, values) = series("0,25;1,5\n0,75;2,5\n", "column_2");
    assert_eq!((time, values), (vec![0.0, 0.5], vec![1.5, 2.5]));
    let text = "t,x\n0,\"1,234\"\n1,2\n";
    assert_eq!(series(text, "x").1, [2.0]);
}

#[test]
fn a_line_of_units_belongs_to_the_names() {
    for text in ["time,x\n[ms],[m]\n0,1\n5.5,2\n", "time;x\nms;-\n0;1\n5.5;2\n"] {
        assert_eq!(series(text, "x"), (vec![0.0, 0.0055], vec![1.0, 2.0]), "{text}");
    }
    assert_eq!(series("timeMs,x\n0,1\n5.5,2\n", "x").0, [0.0, 0.0055]);
}

#[test]
fn a_guessed_unit_is_noted() {
    let text = "timestamp,x\n12345687,0\n12350651,1\n12355656,2\n";
    let notes = table(text).notes().join("\n");
    assert!(notes.contains("the unit of `timestamp` is assumed to be ns"), "{notes}");
    assert!(notes.contains("warning: the rate is 20"), "{notes}");
    let notes = table("time,x\n0.01,0\n5.02,1\n9.98,2\n").notes().join("\n");
    assert!(notes.contains("assumed to be s"), "{notes}");
    let notes = table("t,x\n0.005,0\n0.01,1\n0.015,2\n").notes();
    assert_eq!(notes, ["the column of time is `t`"]);
    let options = ReadOptions { time_unit: Some(crate::TimeUnit::Us), ..ReadOptions::default() };
    let Text { columns, notes, .. } = read(text.as_bytes()).unwrap();
    let table = Table::new("text", columns, &options, notes).unwrap();
    assert_eq!(table.stamps("timestamp", ClockChoice::Log).unwrap()[1], 0.004_964);
    assert_eq!(table.notes().len(), 1);
}

#[test]
fn an_unknown_signal_is_reported_with_the_nearest() {
    let error =
        table("t,position,velocity\n0,1,2\n").series("positon", ClockChoice::Log).unwrap_err();
    let text = error.to_string();
    assert!(
        text.contains("no signal `positon`") && text.contains("nearest names are `position`"),
        "{text}"
    );
}
