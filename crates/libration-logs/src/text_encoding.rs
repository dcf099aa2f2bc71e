//! Encodings of a text: UTF-8, Latin-1 or Windows-1252, and UTF-16 with a byte order mark.

use std::io::{self, BufRead, BufReader, Read};

use crate::input::Input;

/// Bytes that are read at once.
const BUFFER: usize = 1 << 13;

/// The order of the bytes of UTF-16 behind this byte order mark.
fn utf_16(prefix: &[u8]) -> Option<fn([u8; 2]) -> u16> {
    match prefix {
        [0xff, 0xfe, ..] => Some(u16::from_le_bytes),
        [0xfe, 0xff, ..] => Some(u16::from_be_bytes),
        _ => None,
    }
}

/// Reads a text in UTF-8, or in Latin-1, which [`TextLines`](crate::text_line::TextLines) converts.
pub(crate) fn reader(input: &Input) -> io::Result<Box<dyn BufRead>> {
    let reader = input.reader()?;
    Ok(match utf_16(&input.prefix(2)?) {
        None => reader,
        Some(unit) => Box::new(BufReader::with_capacity(BUFFER, Utf16::new(reader, unit))),
    })
}

/// The first bytes of a file as text; none if they are no text.
pub(crate) fn text_prefix(prefix: &[u8]) -> Option<String> {
    let text = match (utf_16(prefix), std::str::from_utf8(prefix)) {
        (Some(unit), _) => {
            let mut text = String::new();
            // The last character may be cut.
            Utf16::new(prefix, unit).read_to_string(&mut text).ok()?;
            text
        }
        (None, Ok(text)) => text.to_owned(),
        (None, Err(error)) if error.error_len().is_none() && prefix.len() > 4000 => {
            String::from_utf8_lossy(&prefix[..error.valid_up_to()]).into_owned()
        }
        (None, Err(_)) => latin_1(prefix)?,
    };
    let is_control = |c: char| c < '\t' || ('\u{e}'..' ').contains(&c) && c != '\u{1b}';
    (!text.is_empty() && !text.contains(is_control)).then_some(text)
}

/// Mostly ASCII, with some letters and signs of Latin-1 or Windows-1252.
fn latin_1(bytes: &[u8]) -> Option<String> {
    let other = bytes.iter().filter(|byte| !byte.is_ascii()).count();
    let text: String = bytes.iter().copied().map(windows_1252).collect();
    (other <= bytes.len() / 4 && !text.contains(char::REPLACEMENT_CHARACTER)).then_some(text)
}

/// The characters of the bytes 0x80 to 0x9f in Windows-1252; Latin-1 has controls there, which no text has.
const CONTROLS: &str = "€\u{fffd}‚ƒ„…†‡ˆ‰Š‹Œ\u{fffd}Ž\u{fffd}\u{fffd}‘’“”•–—˜™š›œ\u{fffd}žŸ";

/// The character of a byte in Windows-1252, which has those of Latin-1; the replacement character of a byte that it does not have.
pub(crate) fn windows_1252(byte: u8) -> char {
    match byte {
        0x80..0xa0 => CONTROLS.chars().nth(usize::from(byte - 0x80)).unwrap_or_default(),
        byte => char::from(byte),
    }
}

/// Converts UTF-16 to UTF-8. Halves of characters become replacement characters.
struct Utf16<R> {
    input: R,
    unit: fn([u8; 2]) -> u16,
    /// Bytes of an incomplete character.
    rest: Vec<u8>,
    text: Vec<u8>,
    at: usize,
}

impl<R: Read> Utf16<R> {
    fn new(input: R, unit: fn([u8; 2]) -> u16) -> Self {
        Utf16 { input, unit, rest: Vec::new(), text: Vec::new(), at: 0 }
    }

    /// Converts the next bytes; none are left at the end.
    fn convert(&mut self) -> io::Result<()> {
        let mut bytes = std::mem::take(&mut self.rest);
        let read = (&mut self.input).take(BUFFER as u64).read_to_end(&mut bytes)?;
        let mut units: Vec<u16> =
            bytes.chunks_exact(2).map(|pair| (self.unit)([pair[0], pair[1]])).collect();
        let is_first_half = |unit: &u16| (0xd800..0xdc00).contains(unit);
        if read > 0 && units.last().is_some_and(is_first_half) {
            units.pop();
        }
        self.rest = if read > 0 { bytes.split_off(2 * units.len()) } else { Vec::new() };
        let text: String = char::decode_utf16(units)
            .map(|unit| unit.unwrap_or(char::REPLACEMENT_CHARACTER))
            .collect();
        (self.text, self.at) = (text.into_bytes(), 0);
        Ok(())
    }
}

impl<R: Read> Read for Utf16<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        while self.at == self.text.len() {
            self.convert()?;
            if self.text.is_empty() && self.rest.is_empty() {
                return Ok(0);
            }
        }
        let count = (&self.text[self.at..]).read(out)?;
        self.at += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn utf_16_of_any_order_is_read_and_halves_are_replaced() {
        let text = format!("time,µ\u{1d465}\n{}", "0.5,1\n".repeat(5000));
        for (mark, bytes) in [
            ([0xff, 0xfe], text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>()),
            ([0xfe, 0xff], text.encode_utf16().flat_map(u16::to_be_bytes).collect()),
        ] {
            let mut input = mark.to_vec();
            input.extend(bytes);
            input.push(7);
            let mut read = String::new();
            reader(&Input::Memory(input.into())).unwrap().read_to_string(&mut read).unwrap();
            assert_eq!(read, format!("\u{feff}{text}"));
        }
        let half = [0xff, 0xfe, b'1', 0, 0, 0xd8];
        assert_eq!(text_prefix(&half).unwrap(), "\u{feff}1\u{fffd}");
    }

    #[test]
    fn latin_1_is_text_and_other_bytes_are_not() {
        assert_eq!(text_prefix(b"t [\xb5s],x\n0,1\n").unwrap(), "t [µs],x\n0,1\n");
        assert_eq!(text_prefix(b"t,\x93x\x94 \x80\n0,1\n").unwrap(), "t,“x” €\n0,1\n");
        assert_eq!(
            [windows_1252(0x9f), windows_1252(0xe4), windows_1252(0x81)],
            ['Ÿ', 'ä', '\u{fffd}']
        );
        for bytes in [&b"t,\x81x\x9d\n0,1\n"[..], &[0xd0; 40], b"t\0,\0x\0\n\0", b""] {
            assert_eq!(text_prefix(bytes), None);
        }
    }
}
