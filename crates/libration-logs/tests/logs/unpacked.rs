//! Compressed files that unpack to far more than recordings do.

use std::borrow::Cow;
use std::fs;
use std::io::Write;
use std::path::Path;

use libration_data::{Column, Table, Values, write_parquet};
use libration_logs::{Log, ReadOptions};

/// A record of MCAP.
fn record(code: u8, body: &[u8]) -> Vec<u8> {
    let length = (body.len() as u64).to_le_bytes();
    [&[code][..], &length, body].concat()
}

fn text(text: &[u8]) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes(), text].concat()
}

/// An MCAP file with a channel and a message of so many zeros.
fn mcap(compression: &str, zeros: usize) -> Vec<u8> {
    let channel = [&[1, 0, 0, 0][..], &text(b"/topic"), &text(b"cdr"), &[0; 4]].concat();
    let message = [&[1, 0][..], &[0; 20], &vec![0; zeros]].concat();
    let records = [record(4, &channel), record(5, &message)].concat();
    let packed = match compression {
        "zstd" => zstd::stream::encode_all(&records[..], 1).unwrap(),
        "lz4" => {
            let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
            encoder.write_all(&records).unwrap();
            encoder.finish().unwrap()
        }
        _ => records.clone(),
    };
    let head = [[0; 8], [0; 8], (records.len() as u64).to_le_bytes()].concat();
    let sizes = [&[0; 4][..], &text(compression.as_bytes()), &(packed.len() as u64).to_le_bytes()];
    let chunk = record(6, &[head, sizes.concat(), packed].concat());
    [&b"\x89MCAP0\r\n"[..], &chunk, &record(15, &[0; 4])].concat()
}

/// A bag of ROS 1 with a chunk of LZ4, of so many zeros.
fn rosbag(zeros: usize) -> Vec<u8> {
    let field = |name: &str, value: &[u8]| {
        let both = [name.as_bytes(), b"=", value].concat();
        [&(both.len() as u32).to_le_bytes(), &both[..]].concat()
    };
    let record = |fields: &[Vec<u8>], data: &[u8]| {
        let head = fields.concat();
        let [a, b] = [head.len(), data.len()].map(|length| (length as u32).to_le_bytes());
        [&a[..], &head, &b, data].concat()
    };
    let message = record(
        &[field("op", &[2]), field("conn", &[0; 4]), field("time", &[0; 8])],
        &vec![0; zeros],
    );
    let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
    encoder.write_all(&message).unwrap();
    let chunk = encoder.finish().unwrap();
    let size = (message.len() as u32).to_le_bytes();
    let chunk =
        record(&[field("op", &[5]), field("compression", b"lz4"), field("size", &size)], &chunk);
    [&b"#ROSBAG V2.0\n"[..], &chunk].concat()
}

fn error(name: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    open(&path).err().map(|error| error.to_string()).unwrap_or_default()
}

fn open(path: &Path) -> Result<Log, libration_logs::LogError> {
    Log::open(path, &ReadOptions::default())
}

#[test]
fn a_small_file_that_unpacks_to_many_zeros_is_refused() {
    // More than 64 MiB, which any file may unpack to, and than 200 times the file.
    let zeros = 70 << 20;
    for (name, bytes) in
        [("a.mcap", mcap("zstd", zeros)), ("b.mcap", mcap("lz4", zeros)), ("c.bag", rosbag(zeros))]
    {
        assert!(bytes.len() < 1 << 20, "{name}: {}", bytes.len());
        let said = error(name, &bytes);
        assert!(said.contains("unpacks to more than 67108864 bytes"), "{name}: {said}");
        assert!(said.contains("at most 200 times its own size"), "{name}: {said}");
    }
    for compression in ["zstd", "lz4", ""] {
        assert_eq!(error("d.mcap", &mcap(compression, 1 << 20)), "", "{compression}");
    }
}

#[test]
fn a_small_table_with_many_cells_is_refused() {
    let file = |rows: usize| {
        let values = Values::F64(Cow::Owned(vec![1.0; rows]));
        let column = Column { name: "x".into(), unit: "1".into(), values };
        let mut bytes = Vec::new();
        write_parquet(&Table::new(vec![column]).unwrap(), &[], 1, &mut bytes).unwrap();
        bytes
    };
    // Cells beyond 2^20, which any file may have, need a byte for 32 of them.
    let bytes = file((1 << 20) + 1);
    assert!(bytes.len() < 1 << 15, "{}", bytes.len());
    let said = error("a.parquet", &bytes);
    assert!(
        said.contains("cells of a file of this size is 1048577; expected at most 1048576"),
        "{said}"
    );
    let said = error("b.parquet", &file(1000));
    assert!(!said.contains("cells"), "{said}");
}
