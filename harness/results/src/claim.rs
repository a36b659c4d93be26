//! Claims: which cells are being run now, so that several processes on one directory share the work.
//!
//! A claim is the lock of the file `claims/<cell>`. The system releases the lock of a process that was killed, so a file
//! that was left behind claims nothing.

use crate::Key;
use std::fs::{File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// The right to run a cell, until it is dropped.
///
/// It saves work and is not what results rest on: where a claim changes hands, two processes may in rare cases hold it at
/// once. Look into the store anew after taking one: its last holder may have finished the cell.
#[derive(Debug)]
pub struct Claim {
    path: PathBuf,
    // Holds the lock.
    _file: File,
}

impl Claim {
    /// Claims a cell in a folder, which is made if there is none; `None` if another has it, unless `waiting` for that one.
    pub(crate) fn take(folder: &Path, cell: &Key, waiting: bool) -> io::Result<Option<Self>> {
        let path = folder.join(cell.as_str());
        let file = make(&path)?;
        if waiting {
            file.lock()?;
        } else {
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Ok(None),
                Err(TryLockError::Error(error)) => return Err(error),
            }
        }
        Ok(Some(Self { path, _file: file }))
    }
}

fn make(path: &Path) -> io::Result<File> {
    loop {
        path.parent().map_or(Ok(()), std::fs::create_dir_all)?;
        match File::create(path) {
            // Another has just cleared the folder away.
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            made => return made,
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // What is left behind claims nothing, so neither failure matters; a folder with other claims stays.
        let _ = std::fs::remove_file(&self.path);
        let _ = self.path.parent().map(std::fs::remove_dir);
    }
}
