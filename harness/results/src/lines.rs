//! The file of lines: appending so that a kill at any moment loses at most the line in flight, and reading it back.
//!
//! A writer that dies in the middle of a line leaves a torn last line without a line feed. The next append first closes
//! that line with the control character CANCEL and a line feed, so the torn text can never run into a good line, and
//! readers know it from a line that was damaged later: JSON escapes control characters, so no whole line ends in one.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

const CANCEL: u8 = 0x18;

/// A line of the file.
pub(crate) struct Line<'a> {
    /// Counted from 1.
    pub(crate) number: usize,
    pub(crate) bytes: &'a [u8],
    /// Its writer did not finish it: it counts only if it is whole all the same.
    pub(crate) torn: bool,
}

/// All lines of a file's content; blank ones are left out.
pub(crate) fn split(content: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let ends_in_feed = content.last().is_none_or(|b| *b == b'\n');
    let count = content.split(|b| *b == b'\n').count();
    content.split(|b| *b == b'\n').enumerate().filter_map(move |(i, bytes)| {
        let (bytes, cancelled) = match bytes {
            [start @ .., CANCEL] => (start, true),
            _ => (bytes, false),
        };
        let last = i + 1 == count && !ends_in_feed;
        let blank = bytes.iter().all(u8::is_ascii_whitespace);
        (!blank).then_some(Line { number: i + 1, bytes, torn: cancelled || last })
    })
}

/// Appends one line, `text` without its line feed, to the file at `path`, which is made if absent.
///
/// The line goes out in one write in append mode, under the file's lock: writers in several processes neither mix their
/// lines nor take another's unfinished line for a torn one, and a killed writer's lock is released by the system.
pub(crate) fn append(path: &Path, text: &str) -> io::Result<()> {
    let mut file = OpenOptions::new().create(true).read(true).append(true).open(path)?;
    file.lock()?;
    let mut bytes = Vec::with_capacity(text.len() + 3);
    if ends_torn(&mut file)? {
        bytes.extend_from_slice(&[CANCEL, b'\n']);
    }
    bytes.extend_from_slice(text.as_bytes());
    bytes.push(b'\n');
    file.write_all(&bytes)
    // Closing the file releases its lock.
}

fn ends_torn(file: &mut File) -> io::Result<bool> {
    if file.seek(SeekFrom::End(0))? == 0 {
        return Ok(false);
    }
    file.seek(SeekFrom::End(-1))?;
    let mut last = [0];
    file.read_exact(&mut last)?;
    Ok(last != *b"\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(content: &[u8]) -> Vec<(usize, String, bool)> {
        split(content).map(|l| (l.number, String::from_utf8_lossy(l.bytes).into_owned(), l.torn)).collect()
    }

    #[test]
    fn split_numbers_lines_and_marks_torn_ones() {
        assert_eq!(read(b""), []);
        assert_eq!(read(b"a\nb\n"), [(1, "a".into(), false), (2, "b".into(), false)]);
        assert_eq!(read(b"a\n\n{\"b"), [(1, "a".into(), false), (3, "{\"b".into(), true)]);
        assert_eq!(read(b"{\"b\x18\nc\n"), [(1, "{\"b".into(), true), (2, "c".into(), false)]);
    }

    #[test]
    fn append_closes_a_torn_line() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("lines");
        append(&path, "one").unwrap();
        append(&path, "two").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"one\ntwo\n");
        std::fs::write(&path, b"one\ntw").unwrap();
        append(&path, "three").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"one\ntw\x18\nthree\n");
    }
}
