//! Estimates that are not finished yet: what is done goes to a file as it is done, so that a kill loses the last second alone.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use halflight_scenes::{Content, Rgb};

use crate::Estimate;

/// A file of slabs, one after the other: the number of receivers, their values, and a checksum.
pub(crate) struct Partial {
    path: PathBuf,
    file: Option<File>,
}

/// Bytes a receiver: mean, variance, samples.
const RECEIVER: usize = 28;
const COUNT: usize = 8;
const CHECKSUM: usize = 8;

impl Partial {
    /// The file of a path, which need not be there.
    pub(crate) fn at(path: PathBuf) -> Self {
        Partial { path, file: None }
    }

    /// What is whole of it; what follows is cut off.
    pub(crate) fn resume(&mut self) -> Estimate {
        let bytes = fs::read(&self.path).unwrap_or_default();
        let mut estimate = Estimate::default();
        let mut rest = &bytes[..];
        while let Some((slab, after)) = slab(rest) {
            read(slab, &mut estimate);
            rest = after;
        }
        let whole = (bytes.len() - rest.len()) as u64;
        if !rest.is_empty() {
            let cut = OpenOptions::new().write(true).open(&self.path).and_then(|file| file.set_len(whole));
            if cut.is_err() {
                return Estimate::default();
            }
        }
        estimate
    }

    /// Adds the receivers from `first` on.
    pub(crate) fn keep(&mut self, estimate: &Estimate, first: usize) -> io::Result<()> {
        let mut bytes = ((estimate.mean.len() - first) as u64).to_le_bytes().to_vec();
        for i in first..estimate.mean.len() {
            let floats = estimate.mean[i].to_array().into_iter().chain(estimate.variance[i].to_array());
            floats.for_each(|value| bytes.extend(value.to_le_bytes()));
            bytes.extend(estimate.samples[i].to_le_bytes());
        }
        bytes.extend(checksum(&bytes));
        let file = match &mut self.file {
            Some(file) => file,
            None => self.file.insert(OpenOptions::new().append(true).create(true).open(&self.path)?),
        };
        file.write_all(&bytes)
    }

    /// Takes the file away.
    pub(crate) fn remove(self) {
        let _ = fs::remove_file(&self.path);
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

/// The first slab without its count and checksum, and what follows; `None` if it is not whole.
fn slab(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let count = usize::try_from(u64::from_le_bytes(*bytes.first_chunk::<COUNT>()?)).ok()?;
    let length = count.checked_mul(RECEIVER)?.checked_add(COUNT)?;
    let (slab, rest) = bytes.split_at_checked(length)?;
    let (sum, rest) = rest.split_at_checked(CHECKSUM)?;
    (count > 0 && sum == checksum(slab)).then_some((&slab[COUNT..], rest))
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
