//! Exchange formats.

use half::f16;
use libration_data::{Column, Table, Values, write_npy, write_parquet};

fn column<'a>(name: &'static str, values: Values<'a>) -> Column<'a> {
    Column { name: name.into(), unit: "1".into(), values }
}

#[test]
fn the_bytes_of_a_parquet_file_do_not_depend_on_the_number_of_threads() {
    let count = (1 << 20) + 1000;
    let x: Vec<f32> = (0..count).map(|i| (i as f32).sin()).collect();
    let short: Vec<f16> = x.iter().map(|&x| f16::from_f32(x)).collect();
    let n: Vec<u32> = (0..count).map(|i| i % 64).collect();
    let flag: Vec<u8> = (0..count).map(|i| u8::from(i % 100 == 0)).collect();
    let table = Table::new(vec![
        column("n", Values::U32(n.into())),
        column("x", Values::F32(x.into())),
        column("h", Values::F16(short.into())),
        column("flag", Values::Bool(flag.into())),
    ])
    .unwrap();
    let bytes = |threads| {
        let mut bytes = Vec::new();
        write_parquet(&table, &[("about", "a test")], threads, &mut bytes).unwrap();
        bytes
    };
    let alone = bytes(1);
    assert!([2, 3, 9].into_iter().all(|threads| bytes(threads) == alone));
}

#[test]
fn flags_and_counts_are_records_of_numpy() {
    let table = Table::new(vec![
        column("n", Values::U32(vec![1, 2].into())),
        column("flag", Values::Bool(vec![0, 1].into())),
    ])
    .unwrap();
    let mut bytes = Vec::new();
    write_npy(&table, &mut bytes).unwrap();
    let text = String::from_utf8_lossy(&bytes).into_owned();
    assert!(text.contains("[('n', '<u4'), ('flag', '|b1'),]"), "{text}");
    assert!(bytes.ends_with(&[1, 0, 0, 0, 0, 2, 0, 0, 0, 1]));
}
