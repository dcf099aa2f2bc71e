//! Tables that NumPy and pyarrow wrote.

use libration_logs::{ClockChoice, Log, ReadOptions, StampOptions, read_time_stamps};

use crate::{open, path};

#[test]
fn archives_of_numpy_keep_all_digits_of_time_stamps() {
    let log = open("table.npz", ClockChoice::Log);
    let stamps = log.stamps("stamp").unwrap();
    assert_eq!(stamps.len(), 50);
    assert_eq!(stamps[49], 49.0 * 1_000_003.0 / 1e9);
    let pair = log.series("pair[1]").unwrap();
    let x = log.series("x").unwrap();
    assert_eq!(pair.values[7], 2.0 * x.values[7]);
    assert_eq!(pair.time, stamps);
}

#[test]
fn an_array_of_numpy_has_the_time_in_its_first_column() {
    let log = open("matrix.npy", ClockChoice::Log);
    let series = log.series("column_2").unwrap();
    assert_eq!((series.time[3], series.values[3]), (0.03, (0.1_f64 * 3.0).sin()));
}

#[test]
fn records_of_numpy_have_a_column_for_each_field() {
    let log = open("records.npy", ClockChoice::Log);
    let series = log.series("x[1]").unwrap();
    assert_eq!((series.time[3], series.values[3]), (0.75, 3.0));
}

#[test]
fn parquet_has_units_of_time_and_holes() {
    let log = open("table.parquet", ClockChoice::Log);
    assert_eq!(log.stamps("stamp").unwrap()[2], 2.0 * 1_000_003.0 / 1e9);
    let x = log.series("x").unwrap();
    assert_eq!(x.values.len(), 50 - 8);
    assert_eq!(x.time[0], 1_000_003.0 / 1e9);
    assert_eq!(log.series("n").unwrap().values[49], 49.0);
    let names: Vec<_> = log.signals().into_iter().map(|signal| signal.name).collect();
    assert_eq!(names, ["x", "stamp", "n"]);
}

#[test]
fn durations_of_parquet_have_the_units_of_the_schema_of_arrow() {
    for (name, last) in [("s", 47_500.0), ("ms", 47.5), ("us", 0.0475), ("ns", 47.5e-6)] {
        let options = ReadOptions { time: Some(name.to_owned()), ..Default::default() };
        let log = Log::open(&path("durations.parquet"), &options).unwrap();
        assert_eq!(log.stamps(name).unwrap()[19], last, "{name}");
        assert_eq!(log.notes(), [format!("the column of time is `{name}`")]);
    }
}

#[test]
fn texts_in_other_encodings_and_with_other_ends_of_lines_are_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("log.csv");
    let text = "Größe,time [µs]\n1,10\n2,2510\n";
    let utf_16 = |unit: fn(u16) -> [u8; 2]| {
        format!("\u{feff}{text}").encode_utf16().flat_map(unit).collect::<Vec<u8>>()
    };
    let latin_1 = || text.chars().map(|c| c as u8).collect::<Vec<u8>>();
    for bytes in [
        text.as_bytes().to_vec(),
        text.replace('\n', "\r").into_bytes(),
        text.replace('\n', "\r\n").into_bytes(),
        utf_16(u16::to_le_bytes),
        utf_16(u16::to_be_bytes),
        latin_1(),
    ] {
        std::fs::write(&file, &bytes).unwrap();
        let log = Log::open(&file, &ReadOptions::default()).unwrap();
        let series = log.series("Größe").unwrap();
        assert_eq!((series.time, series.values), (vec![0.0, 0.0025], vec![1.0, 2.0]));
        assert_eq!(read_time_stamps(&file, &StampOptions::default()).unwrap(), [0.0, 0.0025]);
        let has_note = log.notes().iter().any(|note| note.contains("read as Latin-1"));
        assert_eq!(has_note, bytes == latin_1());
    }
    // UTF-16 without a mark is no text.
    std::fs::write(&file, &utf_16(u16::to_le_bytes)[2..]).unwrap();
    let error = Log::open(&file, &ReadOptions::default()).err().unwrap().to_string();
    assert!(error.contains("UTF-16 with a byte order mark"), "{error}");
}

#[test]
fn a_column_of_time_can_be_chosen() {
    let options = |time: &str| ReadOptions { time: Some(time.to_owned()), ..Default::default() };
    let log = Log::open(&path("matrix.npy"), &options("column_2")).unwrap();
    assert_eq!(log.series("column_1").unwrap().time[3], (0.1_f64 * 3.0).sin());
    let error = Log::open(&path("table.npz"), &options("stmp")).err().unwrap().to_string();
    assert!(error.contains("no column `stmp`") && error.contains("`stamp`"), "{error}");
}

#[test]
fn time_stamps_are_those_of_the_column_of_time_wherever_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("log.csv");
    let read = |text: &str| {
        std::fs::write(&file, text).unwrap();
        read_time_stamps(&file, &StampOptions::default())
    };
    assert_eq!(read("x,time_ms\n1,10\n2,12.5\n").unwrap(), [0.0, 0.0025]);
    assert_eq!(read("name,time\na,1\nb,1.5\n").unwrap(), [0.0, 0.5]);
    assert_eq!(read("5,1\n7,1.5\n").unwrap(), [0.0, 2.0]);
    assert_eq!(read("# of a robot\nt,load\n0.5,3\n\n 1.0 \n1.75,x\n").unwrap(), [0.0, 0.5, 1.25]);
    // Milliseconds since 1970 have the unit that their size shows, as in all commands.
    assert_eq!(read("1700000000000\n1700000000005\n").unwrap(), [0.0, 0.005]);
    // A line of a log begins with its time, whatever follows.
    assert_eq!(read("0.5 started, slowly\n0.75 stopped, at once\n").unwrap(), [0.0, 0.25]);
    assert_eq!(read("time,x\n1,5\n2,6\n,\n").unwrap(), [0.0, 1.0]);
    // Errors of lines have their numbers.
    assert!(read("time\n0\nfoo\n").unwrap_err().starts_with("line 3 is `foo`"));
    assert!(read("t\n0.5\n\nt\n1\n").unwrap_err().starts_with("line 4 is `t`"));
    assert!(read("0.5\n1.0s\n2\n").unwrap_err().contains("line 2 is `1.0s`"));
    assert!(read(",1\n1,2\n2,3\n").unwrap_err().contains("line 1 is `,1`"));
    assert!(read("x,time\n0,1\n1,\n2,3\n").unwrap_err().contains("line 3 is `1,`"));
    // A number that is damaged is not the name of a column.
    assert!(read("O.01\n0.02\n0.03\n").unwrap_err().contains("line 1 is `O.01`"));
    assert!(read("x,time\n0,5\n1,4\n").unwrap_err().contains("time stamp 2"));
}
