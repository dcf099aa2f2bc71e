//! The memory of a replay buffer: what it holds, how far it is, and its fields, in one piece.

use core::ops::Range;
use core::sync::atomic::{Ordering, fence};

use bytemuck::Pod;
use libration_core::Float;
use memmap2::MmapMut;

use super::capacity::{Fields, PAGE};
use super::{Capacity, ReplayError};
use libration_batch::ensemble::{Buffer, Pages};

/// The first eight bytes.
const MAGIC: u64 = u64::from_le_bytes(*b"LIBRTNRB");
/// The version of the format.
const VERSION: u64 = 1;
/// The offsets of the two records of the counters, in separate cache lines.
const RECORDS: [usize; 2] = [512, 1024];

/// The counters of a replay buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Marks {
    /// Steps that were ever inserted.
    pub(super) head: u64,
    /// The first of them that is still there.
    pub(super) tail: u64,
    /// Ends that were ever inserted, and the first of them that is still there.
    pub(super) ends: Range64,
    /// Transitions that are there.
    pub(super) live: u64,
    /// The largest weight that any transition ever had.
    pub(super) largest: f64,
}

impl Marks {
    /// The counters of an empty buffer.
    pub(super) const NONE: Self =
        Marks { head: 0, tail: 0, ends: Range64 { first: 0, end: 0 }, live: 0, largest: 1.0 };
}

/// The range from `first` to before `end`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Range64 {
    pub(super) first: u64,
    pub(super) end: u64,
}

/// All that a replay buffer holds.
#[derive(Debug)]
pub(super) struct Memory {
    map: MmapMut,
    pub(super) fields: Fields,
    /// The number of the record that counts.
    sequence: u64,
}

/// The header.
fn description<T: Float>(capacity: &Capacity, numbers: [usize; 2]) -> [u64; 9] {
    let mut name = [0; 8];
    name.iter_mut().zip(T::NAME.bytes()).for_each(|(to, byte)| *to = byte);
    let Capacity { steps, environments, ends, priorities } = *capacity;
    let [observation, action] = numbers;
    let counts = [observation, action, steps, environments, ends, usize::from(priorities)];
    let [a, b, c, d, e, f] = counts.map(|count| count as u64);
    [MAGIC, VERSION, u64::from_le_bytes(name), a, b, c, d, e, f]
}

/// Tells words from others, and from those of which a part is older (FNV-1a of words, G. Fowler, L. C. Noll, K.-P. Vo).
fn check(words: &[u64]) -> u64 {
    words.iter().fold(0xcbf2_9ce4_8422_2325, |sum, word| {
        let mixed = (sum ^ word).wrapping_mul(0x100_0000_01b3);
        mixed ^ (mixed >> 29)
    })
}

impl Memory {
    /// Untouched anonymous memory.
    pub(super) fn anonymous<T: Float + Pod>(
        capacity: &Capacity,
        numbers: [usize; 2],
    ) -> Result<Self, ReplayError> {
        let fields = capacity.fields(numbers, size_of::<T>())?;
        let map = Buffer::<u8>::new(fields.len, Pages::Huge)?.into_map();
        Memory::create::<T>(map, capacity, numbers)
    }

    /// An empty buffer in memory that is all zeros.
    pub(super) fn create<T: Float + Pod>(
        map: MmapMut,
        capacity: &Capacity,
        numbers: [usize; 2],
    ) -> Result<Self, ReplayError> {
        let fields = capacity.fields(numbers, size_of::<T>())?;
        if map.len() < fields.len {
            let (found, capacity) = (fields.len, map.len());
            return Err(ReplayError::Capacity { name: "bytes", found, capacity });
        }
        let mut memory = Memory { map, fields, sequence: 0 };
        memory.commit(Marks::NONE);
        let words = description::<T>(capacity, numbers);
        let first = memory.words_mut(0, words.len() + 1);
        first[..words.len()].copy_from_slice(&words);
        first[words.len()] = check(&words);
        Ok(memory)
    }

    /// Opens memory with a replay buffer.
    pub(super) fn open<T: Float + Pod>(
        map: MmapMut,
        numbers: [usize; 2],
    ) -> Result<(Self, Capacity, Marks), ReplayError> {
        let other = |what, found: &dyn ToString, wanted: &dyn ToString| {
            let (found, wanted) = (found.to_string(), wanted.to_string());
            Err(ReplayError::Other { what, found, wanted })
        };
        if map.len() < PAGE {
            return other("its length", &format!("{} bytes", map.len()), &"at least a page");
        }
        let mut memory = Memory { map, fields: Fields::none(), sequence: 0 };
        let mut words = [0; 10];
        words.copy_from_slice(memory.words(0, 10));
        let [magic, version, name, observation, action, steps, environments, ends, priorities, sum] =
            words;
        if magic != MAGIC {
            return other("its beginning", &"another", &"that of a replay buffer");
        }
        if version != VERSION {
            return other("its version", &version, &VERSION);
        }
        if check(&words[..9]) != sum {
            return Err(ReplayError::Damaged("its description does not match its checksum".into()));
        }
        let name = name.to_le_bytes();
        let name = String::from_utf8_lossy(&name);
        let name = name.trim_end_matches('\0');
        if name != T::NAME {
            return other("the float type", &name, &T::NAME);
        }
        let [seen, done] = numbers;
        if [observation, action] != [seen as u64, done as u64] {
            let found = format!("{observation} numbers seen, {action} done");
            return other("a transition", &found, &format!("{seen} numbers seen, {done} done"));
        }
        let count = |x: u64| usize::try_from(x).unwrap_or(usize::MAX - 1);
        let [steps, environments, ends] = [steps, environments, ends].map(count);
        let capacity = Capacity { steps, environments, ends, priorities: priorities != 0 };
        memory.fields = capacity.fields(numbers, size_of::<T>())?;
        if memory.map.len() < memory.fields.len {
            let (found, wanted) = (memory.map.len(), memory.fields.len);
            return Err(ReplayError::Damaged(format!("it has {found} bytes of {wanted}")));
        }
        let marks = memory.newest()?;
        Ok((memory, capacity, marks))
    }

    /// The newer one of the records that are whole.
    fn newest(&mut self) -> Result<Marks, ReplayError> {
        let records = RECORDS.map(|at| {
            let mut words = [0; 8];
            words.copy_from_slice(self.words(at, 8));
            words
        });
        let whole = records.iter().filter(|words| check(&words[..7]) == words[7]);
        let newest = whole.max_by_key(|words| words[0]);
        let &[sequence, head, tail, first, end, live, largest, _] = newest.ok_or_else(|| {
            ReplayError::Damaged("neither record of its counters matches its checksum".into())
        })?;
        self.sequence = sequence;
        let largest = f64::from_bits(largest);
        Ok(Marks { head, tail, ends: Range64 { first, end }, live, largest })
    }

    /// From here on, this counts: all that was written before is there before, whenever the process dies.
    pub(super) fn commit(&mut self, marks: Marks) {
        let Marks { head, tail, ends, live, largest } = marks;
        self.sequence += 1;
        let mut words =
            [self.sequence, head, tail, ends.first, ends.end, live, largest.to_bits(), 0];
        words[7] = check(&words[..7]);
        // The other record stays whole until this one is.
        let at = RECORDS[(self.sequence % 2) as usize];
        fence(Ordering::SeqCst);
        self.words_mut(at, 8).copy_from_slice(&words);
        fence(Ordering::SeqCst);
    }

    /// All bytes, as they may be kept in a file.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.map[..self.fields.len]
    }

    /// Holds from now on what another holds, which is as large.
    pub(super) fn copy_from(&mut self, other: &Memory) {
        let len = self.fields.len;
        self.map[..len].copy_from_slice(&other.map[..len]);
        self.sequence = other.sequence;
    }

    /// The memory map, for a caller that keeps it in a file.
    pub(super) fn map(&self) -> &MmapMut {
        &self.map
    }

    /// Copies bytes to another place.
    pub(super) fn copy_within(&mut self, from: Range<usize>, to: usize) {
        self.map.copy_within(from, to);
    }

    fn words(&self, at: usize, count: usize) -> &[u64] {
        self.field(&(at..at + 8 * count))
    }

    fn words_mut(&mut self, at: usize, count: usize) -> &mut [u64] {
        self.field_mut(at..at + 8 * count)
    }

    /// A field.
    #[inline(always)]
    pub(super) fn field<X: Pod>(&self, range: &Range<usize>) -> &[X] {
        bytemuck::cast_slice(&self.map[range.clone()])
    }

    /// A field, to be written.
    #[inline(always)]
    pub(super) fn field_mut<X: Pod>(&mut self, range: Range<usize>) -> &mut [X] {
        bytemuck::cast_slice_mut(&mut self.map[range])
    }
}
