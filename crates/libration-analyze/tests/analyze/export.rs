//! Tests that exported tables are read as the same bits.

use bytes::Bytes;
use half::{bf16, f16};
use libration_analyze::export::{
    Column, Csv, Json, Number, Rows, Table, Values, write_npy, write_parquet,
};
use parquet::basic::{Compression, Encoding, LogicalType};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;

/// One row of `values` as CSV, read back as words.
fn words<S: Number>(values: &[S]) -> Vec<String> {
    let mut bytes = Vec::new();
    let mut csv = Csv::new(&mut bytes, ["step", "t"]).unwrap();
    csv.row(&[u64::MAX], 0.1, values).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let (head, row) = text.split_once('\n').unwrap();
    assert_eq!(head, "step,t");
    let mut words = row.strip_suffix('\n').unwrap().split(',').map(str::to_owned);
    assert_eq!(words.next().unwrap(), u64::MAX.to_string());
    assert_eq!(words.next().unwrap(), "0.1");
    words.collect()
}

#[test]
fn every_half_float_reads_back_from_its_text() {
    fn check<S: Number>(of_bits: fn(u16) -> S, bits: fn(S) -> u16, digits: usize) {
        let all: Vec<S> = (0..=u16::MAX).map(of_bits).collect();
        for (&x, word) in all.iter().zip(words(&all)) {
            if x.to_f64().is_nan() {
                assert_eq!(word, "NaN");
                continue;
            }
            assert_eq!(bits(S::from_f64(word.parse().unwrap())), bits(x), "{word}");
            let significand = word.split('e').next().unwrap().replace(['-', '.'], "");
            let significant = significand.trim_matches('0').len();
            assert!(!x.is_finite() || significant <= digits, "{word}");
        }
    }
    check(f16::from_bits, f16::to_bits, 5);
    check(bf16::from_bits, bf16::to_bits, 4);
}

#[test]
fn floats_read_back_from_their_text() {
    let wide = [0.1, 1.0, -0.0, 1e16, 3.7e215, 5e-324, f64::MAX, f64::MIN_POSITIVE, 1.0 / 3.0];
    let back = words(&wide).into_iter().map(|w| w.parse::<f64>().unwrap().to_bits());
    assert!(back.eq(wide.map(f64::to_bits)));
    let narrow = [0.1, 1.0, -0.0, 1e16, 1e-45, f32::MAX, f32::MIN_POSITIVE, 1.0 / 3.0];
    let back = words(&narrow).into_iter().map(|w| w.parse::<f32>().unwrap().to_bits());
    assert!(back.eq(narrow.map(f32::to_bits)));
}

#[test]
fn a_float_is_printed_as_one_of_its_own_type() {
    assert_eq!(words(&[0.1_f64]), ["0.1"]);
    assert_eq!(words(&[0.1_f32]), ["0.1"]);
    assert_eq!(words(&[f16::from_f32(0.1), f16::MAX]), ["0.1", "65500.0"]);
    assert_eq!(words(&[bf16::from_f32(0.1), bf16::from_f32(1.0)]), ["0.1", "1.0"]);
    assert_eq!(words(&[f64::INFINITY, f64::NEG_INFINITY, f64::NAN]), ["inf", "-inf", "NaN"]);
}

#[test]
fn json_has_null_for_what_is_not_finite() {
    let mut bytes = Vec::new();
    let mut json = Json::new(&mut bytes, &[("name", "x".into())]).unwrap();
    json.row(&[0], 0.0, &[1.5_f32, f32::NAN]).unwrap();
    json.row(&[1], 1e-7, &[0.1, f32::INFINITY]).unwrap();
    json.finish(&[("stopped", serde_json::Value::Null)]).unwrap();
    let value: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
    let rows = serde_json::json!([[0, 0.0, 1.5, null], [1, 1e-7, 0.1, null]]);
    assert_eq!(value, serde_json::json!({ "name": "x", "rows": rows, "stopped": null }));
}

fn mixed() -> Table<'static> {
    let column = |name, unit, values| Column { name, unit, values };
    let (f, b) = (f16::from_f32, bf16::from_f32);
    Table::new(vec![
        column("step".into(), "1".into(), Values::U64(vec![0, u64::MAX].into())),
        column("t".into(), "s".into(), Values::F64(vec![0.1, f64::NAN].into())),
        column("x".into(), "m".into(), Values::F32(vec![0.1, f32::INFINITY].into())),
        column("y".into(), "m/s".into(), Values::F16(vec![f(0.1), f(-2.5)].into())),
        column("z".into(), "J/kg".into(), Values::Bf16(vec![b(0.1), b(-2.5)].into())),
    ])
    .unwrap()
}

#[test]
fn npy_records_are_packed_little_endian() {
    let mut bytes = Vec::new();
    write_npy(&mixed(), &mut bytes).unwrap();
    let size = 8 + 8 + 4 + 2 + 4;
    let (header, records) = bytes.split_at(bytes.len() - 2 * size);
    let second = &records[size..];
    assert_eq!(second[..8], u64::MAX.to_le_bytes());
    assert_eq!(second[16..20], f32::INFINITY.to_le_bytes());
    assert_eq!(second[20..22], f16::from_f32(-2.5).to_le_bytes());
    assert_eq!(second[22..], (-2.5_f32).to_le_bytes());
    let header = String::from_utf8_lossy(&header[10..]);
    let fields = "[('step', '<u8'), ('t', '<f8'), ('x', '<f4'), ('y', '<f2'), ('z', '<f4'),]";
    assert!(header.contains(fields), "{header}");
}

fn reader(bytes: Vec<u8>) -> SerializedFileReader<Bytes> {
    SerializedFileReader::new(Bytes::from(bytes)).unwrap()
}

#[test]
fn parquet_reads_back_with_units() {
    let mut bytes = Vec::new();
    write_parquet(&mixed(), &[("about", "a test")], 1, &mut bytes).unwrap();
    let reader = reader(bytes);
    let file = reader.metadata().file_metadata();
    let entry = |key: &str| {
        let entries = file.key_value_metadata().unwrap();
        entries.iter().find(|e| e.key == key).unwrap().value.clone().unwrap()
    };
    let units: serde_json::Value = serde_json::from_str(&entry("libration.units")).unwrap();
    let expected = serde_json::json!({"step": "1", "t": "s", "x": "m", "y": "m/s", "z": "J/kg"});
    assert_eq!(units, expected);
    assert_eq!(entry("about"), "a test");
    let half = file.schema_descr().column(3);
    assert_eq!(half.logical_type_ref(), Some(&LogicalType::Float16));
    for (i, column) in reader.metadata().row_group(0).columns().iter().enumerate() {
        assert!(matches!(column.compression(), Compression::ZSTD(_)));
        let counts = Encoding::DELTA_BINARY_PACKED;
        let encoding = if i == 0 { counts } else { Encoding::BYTE_STREAM_SPLIT };
        assert!(column.encodings().any(|e| e == encoding), "column {i}");
    }
    let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
    assert_eq!(rows[1].get_ulong(0).unwrap(), u64::MAX);
    assert_eq!(rows[0].get_double(1).unwrap(), 0.1);
    assert!(rows[1].get_double(1).unwrap().is_nan());
    assert_eq!(rows[1].get_float(2).unwrap(), f32::INFINITY);
    assert_eq!(rows[0].get_float16(3).unwrap(), f16::from_f32(0.1));
    assert_eq!(rows[0].get_float(4).unwrap(), bf16::from_f32(0.1).to_f32());
}
