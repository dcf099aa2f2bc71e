//! Series of records as Parquet files.

use bytes::Bytes;
use libration_lab::session::series_to_parquet;
use libration_report::record::Series;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;

fn reader(bytes: Vec<u8>) -> SerializedFileReader<Bytes> {
    SerializedFileReader::new(Bytes::from(bytes)).unwrap()
}

#[test]
fn a_series_longer_than_a_row_group_is_whole() {
    let values: Vec<f64> = (0..(1 << 20) + 3).map(|i| f64::from(i).sqrt()).collect();
    let series = Series::new("long").with("x", "m", values.clone());
    let reader = reader(series_to_parquet(&series).unwrap());
    assert_eq!(reader.num_row_groups(), 2);
    let back = reader.get_row_iter(None).unwrap().map(|row| row.unwrap().get_double(0).unwrap());
    assert!(back.map(f64::to_bits).eq(values.into_iter().map(f64::to_bits)));
}

#[test]
fn empty_and_ragged_series() {
    let empty = Series::new("empty").with("x", "m", vec![]);
    let reader = reader(series_to_parquet(&empty).unwrap());
    assert_eq!(reader.metadata().file_metadata().num_rows(), 0);
    series_to_parquet(&Series::new("none")).unwrap();
    let mut ragged = Series::new("ragged").with("x", "m", vec![1.0]);
    ragged.columns.push(libration_report::record::Column::default());
    let error = series_to_parquet(&ragged).unwrap_err();
    let said = "column `` has 0 values where the first column has 1";
    assert_eq!(error.to_string(), said);
}
