//! Estimates that are not finished yet: what is done goes to a file as it is done, so that a kill loses the last second alone.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};

use halflight_scenes::{Content, Rgb};

use crate::{Estimate, Provenance};

/// A file that says what is being made, then holds slabs of receivers, one after the other. Each part is its length, its
/// bytes, and a checksum. Whoever works on it has it locked, and the system unlocks it when he is killed.
pub(crate) struct Partial {
    path: PathBuf,
    /// None where files cannot be locked: then nothing is kept, for two writers would spoil it.
    file: Option<File>,
}

/// What a file says, read by one who does not work on it.
pub(crate) struct Begun {
    pub(crate) provenance: Provenance,
    /// Receivers that are done.
    pub(crate) done: usize,
}

/// Bytes a receiver: mean, variance, samples.
const RECEIVER: usize = 28;
const COUNT: usize = 8;
const CHECKSUM: usize = 8;

impl Partial {
    /// The file of a path, made if there is none; `None` while someone else works on it.
    pub(crate) fn lock(path: PathBuf) -> io::Result<Option<Self>> {
        let file = OpenOptions::new().read(true).append(true).create(true).open(&path)?;
        match file.try_lock() {
            Ok(()) => Ok(Some(Partial { path, file: Some(file) })),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(_)) => Ok(Some(Partial { path, file: None })),
        }
    }

    /// What is whole of it if it was begun for the same; anything else is cut off.
    pub(crate) fn resume(&mut self, provenance: &Provenance) -> io::Result<Estimate> {
        let Some(file) = &mut self.file else { return Ok(Estimate::default()) };
        let mut bytes = Vec::new();
        file.rewind()?;
        file.read_to_end(&mut bytes)?;
        if let Some((_, slabs)) = header(&bytes).filter(|(begun, _)| begun.key == provenance.key) {
            let (estimate, rest) = receivers(slabs);
            if !rest.is_empty() {
                file.set_len((bytes.len() - rest.len()) as u64)?;
            }
            return Ok(estimate);
        }
        file.set_len(0)?;
        file.write_all(&part(provenance.to_ascii().into_bytes()))?;
        Ok(Estimate::default())
    }

    /// Adds the receivers from `first` on.
    pub(crate) fn keep(&mut self, estimate: &Estimate, first: usize) -> io::Result<()> {
        let Some(file) = &mut self.file else { return Ok(()) };
        let mut slab = Vec::with_capacity((estimate.mean.len() - first) * RECEIVER);
        for i in first..estimate.mean.len() {
            let floats = estimate.mean[i].to_array().into_iter().chain(estimate.variance[i].to_array());
            floats.for_each(|value| slab.extend(value.to_le_bytes()));
            slab.extend(estimate.samples[i].to_le_bytes());
        }
        file.write_all(&part(slab))
    }

    /// Takes the file away.
    pub(crate) fn remove(self) {
        let _ = std::fs::remove_file(&self.path);
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Begun {
    /// What the bytes of a file say; `None` if they do not say what is being made.
    pub(crate) fn read(bytes: &[u8]) -> Option<Self> {
        let (provenance, slabs) = header(bytes)?;
        Some(Begun { provenance, done: receivers(slabs).0.mean.len() })
    }
}

/// What is being made, and what follows.
fn header(bytes: &[u8]) -> Option<(Provenance, &[u8])> {
    let (header, rest) = first_part(bytes)?;
    Some((Provenance::read(std::str::from_utf8(header).ok()?)?, rest))
}

/// The receivers of all slabs that are whole, and what follows.
fn receivers(mut bytes: &[u8]) -> (Estimate, &[u8]) {
    let mut estimate = Estimate::default();
    while let Some((slab, rest)) = first_part(bytes).filter(|(slab, _)| slab.len() % RECEIVER == 0) {
        read(slab, &mut estimate);
        bytes = rest;
    }
    (estimate, bytes)
}

/// Bytes with their length before and their checksum after them.
fn part(bytes: Vec<u8>) -> Vec<u8> {
    let mut part = (bytes.len() as u64).to_le_bytes().to_vec();
    part.extend(bytes);
    part.extend(checksum(&part));
    part
}

/// The bytes of the first part, and what follows; `None` if it is not whole.
fn first_part(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let count = usize::try_from(u64::from_le_bytes(*bytes.first_chunk::<COUNT>()?)).ok()?;
    let (part, rest) = bytes.split_at_checked(count.checked_add(COUNT)?)?;
    let (sum, rest) = rest.split_at_checked(CHECKSUM)?;
    (count > 0 && sum == checksum(part)).then_some((&part[COUNT..], rest))
}

fn checksum(bytes: &[u8]) -> [u8; CHECKSUM] {
    Content::of(bytes).revision().0.to_le_bytes()
}

fn read(slab: &[u8], estimate: &mut Estimate) {
    for receiver in slab.chunks_exact(RECEIVER) {
        let word = |i: usize| [0, 1, 2, 3].map(|byte| receiver[4 * i + byte]);
        let rgb = |i: usize| {
            Rgb::new(f32::from_le_bytes(word(i)), f32::from_le_bytes(word(i + 1)), f32::from_le_bytes(word(i + 2)))
        };
        estimate.mean.push(rgb(0));
        estimate.variance.push(rgb(3));
        estimate.samples.push(u32::from_le_bytes(word(6)));
    }
}
