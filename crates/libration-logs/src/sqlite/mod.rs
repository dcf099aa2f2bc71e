//! Tables of SQLite databases.
//!
//! The format is that of <https://www.sqlite.org/fileformat2.html>: pages, of which those of a table are the nodes of a tree. A record
//! that does not fit continues on overflow pages. A file is read as it is: changes in a write-ahead log beside it are not in it.

mod pages;
mod record;
mod schema;

pub(crate) use record::{Record, Value};
pub(crate) use schema::TableInfo;

use pages::Pages;

use crate::error::LogError;
use crate::input::Input;

/// The first bytes of a file.
pub(crate) const MAGIC: &[u8] = b"SQLite format 3\0";

/// Largest record in bytes.
const LONGEST: u64 = 1 << 28;
/// Most levels of a tree; one of 2^64 rows has fewer.
const MOST_LEVELS: usize = 40;

const INTERIOR: u8 = 5;
const LEAF: u8 = 13;

/// An opened database.
pub(crate) struct Database {
    pages: Pages,
}

/// How the reading of a table ended.
#[derive(Default)]
pub(crate) struct Damage {
    /// Number of pages and records that cannot be read.
    pub(crate) count: usize,
    /// Number of records that are too long.
    pub(crate) long: usize,
}

impl Damage {
    pub(crate) fn add(&mut self, other: Damage) {
        self.count += other.count;
        self.long += other.long;
    }
}

impl Database {
    /// Opens a database.
    ///
    /// # Errors
    /// If the file cannot be read or its header is damaged.
    pub(crate) fn open(input: &Input) -> Result<Self, LogError> {
        Ok(Database { pages: Pages::open(input)? })
    }

    /// Whether the file is shorter than its header says.
    pub(crate) fn is_truncated(&self) -> bool {
        self.pages.is_truncated()
    }

    /// The tables.
    pub(crate) fn tables(&mut self) -> Result<(Vec<TableInfo>, Damage), LogError> {
        let mut tables = Vec::new();
        let damage = self.visit(1, &mut |_, record| {
            tables.extend(TableInfo::of(record));
            tables.len() < schema::MOST
        })?;
        Ok((tables, damage))
    }

    /// Calls `visit` with the number and the record of each row of the table with this first page, until it returns false.
    ///
    /// # Errors
    /// If the system cannot read the file. Damaged parts are counted.
    pub(crate) fn visit(
        &mut self,
        root: u32,
        visit: &mut dyn FnMut(i64, &Record<'_>) -> bool,
    ) -> Result<Damage, LogError> {
        let mut damage = Damage::default();
        // A page belongs to one tree or record: a file in which pages lead back to others has an end nevertheless.
        let mut left = u64::from(self.pages.count());
        let mut nodes = Vec::new();
        let mut payload = Vec::new();
        self.enter(root, &mut nodes, &mut left, &mut damage)?;
        while let Some(node) = nodes.last_mut() {
            let Some(cell) = node.next() else {
                nodes.pop();
                continue;
            };
            match cell {
                Cell::Child(page) => self.enter(page, &mut nodes, &mut left, &mut damage)?,
                Cell::Damaged => damage.count += 1,
                Cell::Row { length, .. } if length > LONGEST => damage.long += 1,
                Cell::Row { rowid, length, local, overflow } => {
                    payload.clear();
                    payload.extend_from_slice(&node.bytes[local]);
                    let is_whole = match overflow {
                        None => true,
                        Some(page) => self.pages.overflow(page, length, &mut payload, &mut left)?,
                    };
                    match Record::new(&payload).filter(|_| is_whole) {
                        Some(record) if !visit(rowid, &record) => return Ok(damage),
                        Some(_) => {}
                        None => damage.count += 1,
                    }
                }
            }
        }
        Ok(damage)
    }

    /// Reads a page of a tree, unless it is damaged.
    fn enter(
        &mut self,
        page: u32,
        nodes: &mut Vec<Node>,
        left: &mut u64,
        damage: &mut Damage,
    ) -> Result<(), LogError> {
        let mut bytes = Vec::new();
        let is_there = *left > 0 && self.pages.read(page, &mut bytes)?;
        *left = left.saturating_sub(1);
        let node = match is_there && nodes.len() < MOST_LEVELS {
            true => {
                Node::new(bytes, if page == 1 { pages::HEADER } else { 0 }, self.pages.usable())
            }
            false => None,
        };
        match node {
            Some(node) => nodes.push(node),
            None => damage.count += 1,
        }
        Ok(())
    }
}

/// A page of a tree while its cells are read.
struct Node {
    bytes: Vec<u8>,
    is_leaf: bool,
    /// Where the places of the cells are.
    places: usize,
    cells: usize,
    /// The next cell.
    at: usize,
    usable: usize,
    /// Bytes of the records up to here: cells do not overlap.
    used: usize,
}

/// A cell.
enum Cell {
    /// Another page of the tree.
    Child(u32),
    /// A row: its number, the length of its record, the part on this page, and the first overflow page.
    Row {
        rowid: i64,
        length: u64,
        local: std::ops::Range<usize>,
        overflow: Option<u32>,
    },
    Damaged,
}

impl Node {
    /// The page with a header at a place; none if it belongs to no table.
    fn new(bytes: Vec<u8>, header: usize, usable: usize) -> Option<Self> {
        let is_leaf = match *bytes.get(header)? {
            LEAF => true,
            INTERIOR => false,
            _ => return None,
        };
        let cells = usize::from(u16::from_be_bytes(*bytes.get(header + 3..)?.first_chunk()?));
        let places = header + if is_leaf { 8 } else { 12 };
        Some(Node { bytes, is_leaf, places, cells, at: 0, usable, used: 0 })
    }

    fn next(&mut self) -> Option<Cell> {
        let index = self.at;
        self.at += 1;
        if index < self.cells {
            return Some(self.cell(index).unwrap_or(Cell::Damaged));
        }
        // The last child is in the header.
        let is_last = index == self.cells && !self.is_leaf;
        is_last.then(|| self.u32(self.places - 4).map_or(Cell::Damaged, Cell::Child))
    }

    fn u32(&self, at: usize) -> Option<u32> {
        Some(u32::from_be_bytes(*self.bytes.get(at..)?.first_chunk()?))
    }

    fn cell(&mut self, index: usize) -> Option<Cell> {
        let place = self.bytes.get(self.places + 2 * index..)?.first_chunk()?;
        let place = usize::from(u16::from_be_bytes(*place));
        if !self.is_leaf {
            return self.u32(place).map(Cell::Child);
        }
        let rest = self.bytes.get(place..self.usable)?;
        let (length, rest) = record::varint(rest)?;
        let (rowid, rest) = record::varint(rest)?;
        let (length, from) = (u64::try_from(length).ok()?, self.usable - rest.len());
        // The part of a record on its first page: section 1.6 of the format.
        let (most, least) = (self.usable - 35, (self.usable - 12) * 32 / 255 - 23);
        let local = match usize::try_from(length) {
            Ok(length) if length <= most => length,
            _ => {
                let part = least + ((length - least as u64) % (self.usable as u64 - 4)) as usize;
                if part <= most { part } else { least }
            }
        };
        let end = from.checked_add(local).filter(|&end| end <= self.usable)?;
        self.used = self.used.checked_add(local).filter(|&used| used <= self.usable)?;
        let overflow = if local as u64 == length { None } else { Some(self.u32(end)?) };
        Some(Cell::Row { rowid, length, local: from..end, overflow })
    }
}
