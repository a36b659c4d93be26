//! The file of lines: appending so that a kill at any moment loses at most the line in flight, and reading it back.
//!
//! Writers hold the file's exclusive lock and readers its shared one, in one process or many, and the system releases a
//! killed holder's lock. So whoever has the lock and sees a last line without its line feed knows that its writer died.

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// A line of the file.
#[derive(Debug, PartialEq)]
pub(crate) struct Line<'a> {
    pub(crate) bytes: &'a [u8],
    /// Whether its line feed is there.
    pub(crate) ended: bool,
}

/// All lines of a file's content, blank ones too.
pub(crate) fn split(content: &[u8]) -> impl Iterator<Item = Line<'_>> {
    content.split_inclusive(|b| *b == b'\n').map(|line| match line {
        [bytes @ .., b'\n'] => Line { bytes, ended: true },
        bytes => Line { bytes, ended: false },
    })
}

/// What the file holds from a place on; nothing if there is no file.
///
/// # Errors
/// It cannot be read, or ends before that place.
pub(crate) fn read(path: &Path, from: u64) -> io::Result<Vec<u8>> {
    let mut file = match File::open(path) {
        Ok(file) => file,
        Err(e) if e.kind() == ErrorKind::NotFound && from == 0 => return Ok(Vec::new()),
        Err(e) => return Err(e),
    };
    file.lock_shared()?;
    rest(&mut file, from)
}

/// The file, open for appending and locked until this is dropped.
pub(crate) struct Appender(File);

impl Appender {
    /// Opens the file, which is made if there is none, and waits for its lock.
    pub(crate) fn lock(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().create(true).read(true).append(true).open(path)?;
        file.lock()?;
        Ok(Self(file))
    }

    /// As [`read`].
    pub(crate) fn read(&mut self, from: u64) -> io::Result<Vec<u8>> {
        rest(&mut self.0, from)
    }

    /// Writes a line after the first `whole` bytes, all of them whole lines; whatever follows them is cut off. Returns how
    /// many bytes are whole now.
    pub(crate) fn append(&mut self, whole: u64, text: &str) -> io::Result<u64> {
        if self.0.metadata()?.len() > whole {
            self.0.set_len(whole)?;
        }
        let mut bytes = Vec::with_capacity(text.len() + 2);
        if whole > 0 && rest(&mut self.0, whole - 1)? != b"\n" {
            bytes.push(b'\n');
        }
        bytes.extend_from_slice(text.as_bytes());
        bytes.push(b'\n');
        // In one write, so that a kill leaves at most one line torn.
        self.0.write_all(&bytes)?;
        Ok(whole + bytes.len() as u64)
    }

    /// Waits until all that was written is on the disk.
    pub(crate) fn sync(&self) -> io::Result<()> {
        self.0.sync_data()
    }
}

fn rest(file: &mut File, from: u64) -> io::Result<Vec<u8>> {
    if file.metadata()?.len() < from {
        let message = "it became shorter while it was in use, expected it to grow only";
        return Err(io::Error::new(ErrorKind::InvalidData, message));
    }
    file.seek(SeekFrom::Start(from))?;
    let mut content = Vec::new();
    file.read_to_end(&mut content)?;
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn split_tells_lines_that_did_not_end() {
        let lines = |content| split(content).map(|l| (l.bytes, l.ended)).collect::<Vec<_>>();
        assert_eq!(lines(b""), []);
        assert_eq!(lines(b"a\n\nb"), [(&b"a"[..], true), (b"", true), (b"b", false)]);
    }

    #[test]
    fn append_cuts_what_is_not_whole_and_ends_what_is() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("lines");
        let append = |whole, text| Appender::lock(&path).unwrap().append(whole, text).unwrap();
        assert_eq!(append(0, "one"), 4);
        std::fs::write(&path, b"one\ntw").unwrap();
        assert_eq!(append(4, "three"), 10);
        assert_eq!(std::fs::read(&path).unwrap(), b"one\nthree\n");
        std::fs::write(&path, b"one\ntwo").unwrap();
        assert_eq!(append(7, "three"), 14);
        assert_eq!(std::fs::read(&path).unwrap(), b"one\ntwo\nthree\n");
        assert_eq!(read(&path, 4).unwrap(), b"two\nthree\n");
        assert_eq!(read(&path, 15).unwrap_err().kind(), ErrorKind::InvalidData);
    }
}
