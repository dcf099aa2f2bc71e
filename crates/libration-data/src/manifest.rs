//! The manifest of a data set.

use std::collections::HashSet;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::DataError;
use crate::bounded_read::read_regular;

/// Its name in the folder.
pub(crate) const NAME: &str = "manifest.jsonl";

/// Bytes of the longest manifest.
pub(crate) const LIMIT: u64 = 1 << 30;

/// Bytes of the line of a chunk, and of each file in it, at most: names and numbers of data sets are short.
const LINE: [u64; 2] = [220, 130];

/// The manifest of a data set: its settings and its chunks. In the file, each has a line of JSON.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Manifest {
    /// The settings.
    pub settings: Map<String, Value>,
    /// Its chunks so far.
    pub chunks: Vec<Chunk>,
}

/// A chunk of a data set.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Chunk {
    /// Its name.
    pub chunk: String,
    /// The contents of the chunk.
    pub holds: Map<String, Value>,
    /// Its files.
    pub files: Vec<Stored>,
}

/// A file of a chunk.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Stored {
    /// The path relative to the folder.
    pub path: PathBuf,
    /// Its length.
    pub bytes: u64,
    /// BLAKE3 of all of it, in hexadecimal.
    pub blake3: String,
}

impl Chunk {
    /// Bytes of all its files.
    pub fn bytes(&self) -> u64 {
        // A manifest of somebody else may have any numbers.
        self.files.iter().fold(0, |sum, file| file.bytes.saturating_add(sum))
    }
}

impl Manifest {
    /// The most chunks of `files` files that a manifest may have.
    pub fn most_chunks(files: u64) -> u64 {
        LIMIT / (LINE[0] + LINE[1] * files)
    }

    /// Bytes of all files of all chunks.
    pub fn bytes(&self) -> u64 {
        self.chunks.iter().fold(0, |sum, chunk| chunk.bytes().saturating_add(sum))
    }

    /// Reads the text of one, and how much of it that is: a last line without its end was never written.
    pub(crate) fn parse(text: &[u8], path: &Path) -> Result<(Option<Self>, usize), DataError> {
        let len = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
        let wrong = |line: usize, what: String| {
            let path = path.to_owned();
            DataError::Manifest { path, line: line + 1, what }
        };
        let mut lines =
            text[..len].split(|&byte| byte == b'\n').take_while(|line| !line.is_empty());
        let Some(first) = lines.next() else { return Ok((None, 0)) };
        let settings = serde_json::from_slice(first)
            .map_err(|error| wrong(0, format!("has no settings: {error}")))?;
        let mut manifest = Manifest { settings, chunks: Vec::new() };
        let (mut read, mut names) = (first.len() + 1, HashSet::new());
        for (i, line) in lines.enumerate() {
            let chunk: Chunk = serde_json::from_slice(line)
                .map_err(|error| wrong(i + 1, format!("is not a chunk: {error}")))?;
            // They would be part of messages.
            let paths = chunk.files.iter().map(|file| file.path.as_os_str().to_string_lossy());
            if paths
                .chain([chunk.chunk.as_str().into()])
                .any(|name| name.contains(char::is_control))
            {
                return Err(wrong(i + 1, "has a name with a control character".to_owned()));
            }
            let plain = |path: &Path| path.components().all(|c| matches!(c, Component::Normal(_)));
            let mut paths = HashSet::new();
            if let Some(file) = chunk.files.iter().find(|file| !paths.insert(&file.path)) {
                return Err(wrong(i + 1, format!("names `{}` twice", file.path.display())));
            }
            if let Some(file) = chunk.files.iter().find(|file| !plain(&file.path)) {
                let what = format!("names `{}`, which is not in the folder", file.path.display());
                return Err(wrong(i + 1, what));
            }
            if let Some(file) = chunk.files.iter().find(|file| file.path == Path::new(NAME)) {
                return Err(wrong(i + 1, format!("names `{}` itself", file.path.display())));
            }
            if !names.insert(chunk.chunk.clone()) {
                return Err(wrong(i + 1, format!("repeats chunk {}", chunk.chunk)));
            }
            manifest.chunks.push(chunk);
            read += line.len() + 1;
        }
        if read != len {
            return Err(wrong(manifest.chunks.len() + 1, "is empty".to_owned()));
        }
        Ok((Some(manifest), len))
    }

    /// Reads that of a folder.
    ///
    /// # Errors
    /// If there is none, or what there is is none.
    pub fn read(folder: &Path) -> Result<Self, DataError> {
        let path = folder.join(NAME);
        let text = match read_regular(&path, LIMIT) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Err(DataError::Missing(folder.to_owned()));
            }
            Err(error) => return Err(DataError::io("read", &path)(error)),
        };
        let (manifest, _) = Manifest::parse(&text, &path)?;
        let what = || "has no end: nothing was ever written".to_owned();
        manifest.ok_or_else(|| DataError::Manifest { path, line: 1, what: what() })
    }
}
