//! The store: a results directory opened for reading and appending.

use crate::exr::read_bytes;
use crate::lines::{self, Appender};
use crate::{
    Cell, Claim, CrossCheck, Key, Measured, Picture, PictureError, Record, ReferenceMade, ReferencePicture, Run,
    SCHEMA, Score, Times,
};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// A results directory.
#[derive(Debug)]
pub struct Store {
    dir: PathBuf,
    records: Vec<Record>,
    /// Each cell's first record stands for its place, the last for its content.
    cells: HashMap<Key, usize>,
    order: Vec<Key>,
    times: HashMap<Key, usize>,
    scores: HashMap<Key, Vec<usize>>,
    warnings: Vec<String>,
    /// Bytes of the file that were read, all of them whole lines; the last may lack its line feed.
    read: u64,
    /// Line feeds among them.
    feeds: usize,
}

/// Why a store could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// A file or folder could not be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A line is not a record.
    #[error("{path}, line {line}: not a record: {message}; repair or delete this line")]
    Corrupt {
        /// The file.
        path: PathBuf,
        /// The line's number, from 1.
        line: usize,
        /// What is wrong with it.
        message: String,
    },
    /// A line is of another schema than the one that this program reads and writes.
    #[error(
        "{path}, line {line}: written by {} Halflight: `schema` is {found}, expected {SCHEMA}; \
         read it with that Halflight, or choose another results directory",
        if *found > SCHEMA { "a newer" } else { "an older" }
    )]
    Schema {
        /// The file.
        path: PathBuf,
        /// The line's number, from 1.
        line: usize,
        /// The line's schema.
        found: u32,
    },
    /// A record would not read back as itself.
    #[error("record not written: it would not read back as itself ({0}); expected finite numbers throughout")]
    Unwritable(String),
    /// A picture could not be read or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

/// A line as it stands in the file.
#[derive(Serialize, Deserialize)]
struct Line<R> {
    schema: u32,
    /// The cell's key, for people and other programs; none on a score's line, whose `run` names the cell.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    key: Option<Key>,
    #[serde(flatten)]
    record: R,
}

impl Store {
    /// Opens a results directory; one that does not exist yet is an empty store, and is made by the first write.
    ///
    /// Files that killed writers left on their way, and claims that nobody holds, are removed once they are ten minutes old. A
    /// torn last line, left by a killed writer, is ignored, reported by [`Store::warnings`], and cut off by the next write.
    ///
    /// # Errors
    /// The file cannot be read, any other line is not a record, or a line is of another schema.
    pub fn open(dir: impl Into<PathBuf>) -> Result<Self, StoreError> {
        let mut store = Self {
            dir: dir.into(),
            records: Vec::new(),
            cells: HashMap::new(),
            order: Vec::new(),
            times: HashMap::new(),
            scores: HashMap::new(),
            warnings: Vec::new(),
            read: 0,
            feeds: 0,
        };
        crate::leftovers::sweep(&store.dir);
        if store.refresh()? {
            let (path, line) = (store.path(), store.feeds + 1);
            let why = "ignored and to be cut off, its writer was stopped in the middle of it";
            store.warnings.push(format!("{}, line {line}: {why}", path.display()));
        }
        Ok(store)
    }

    /// Takes in what others have appended since; whether a torn line follows.
    ///
    /// # Errors
    /// As [`Store::open`], or the file became shorter.
    pub fn refresh(&mut self) -> Result<bool, StoreError> {
        let content = lines::read(&self.path(), self.read).map_err(|source| self.io(source))?;
        self.take_in(&content)
    }

    /// The directory.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// The file of records, `DIR/results.jsonl`.
    pub fn path(&self) -> PathBuf {
        self.dir.join("results.jsonl")
    }

    /// What was ignored on opening, for the user to read.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Appends a record. Several stores, in one process or many, may append to the same directory. A power cut loses at most
    /// the scores since the last record of another kind.
    ///
    /// # Errors
    /// The file cannot be written, or the record holds a NaN or infinity, which JSON cannot.
    pub fn append(&mut self, record: Record) -> Result<(), StoreError> {
        let line = Line { schema: SCHEMA, key: record.cell().map(Cell::key), record: &record };
        let text = serde_json::to_string(&line).map_err(|e| StoreError::Unwritable(e.to_string()))?;
        match parse(text.as_bytes()) {
            Ok(back) if back == record => {}
            Ok(_) => return Err(StoreError::Unwritable("its fields change".into())),
            Err(Wrong::Record(message)) => return Err(StoreError::Unwritable(message)),
            Err(Wrong::Schema(_)) => unreachable!("the line has the present schema"),
        }
        self.make_dir(&self.dir)?;
        let mut file = Appender::lock(&self.path()).map_err(|source| self.io(source))?;
        let others = file.read(self.read).map_err(|source| self.io(source))?;
        self.take_in(&others)?;
        let whole = file.append(self.read, &text).map_err(|source| self.io(source))?;
        // What took long is on the disk before the next is begun; a score that a power cut loses is taken again in no time.
        if !matches!(record, Record::Score(_)) {
            file.sync().map_err(|source| self.io(source))?;
        }
        self.index(record);
        // A last line without its line feed was given it.
        self.feeds += usize::from(whole - self.read > text.len() as u64 + 1) + 1;
        self.read = whole;
        Ok(())
    }

    /// Claims a cell, to run it; `None` if another has claimed it, in this process or another.
    ///
    /// # Errors
    /// The claim's file cannot be made.
    pub fn try_claim(&self, cell: &Key) -> Result<Option<Claim>, StoreError> {
        let folder = self.dir.join("claims");
        Claim::take(&folder, cell, false).map_err(|source| StoreError::Io { path: folder, source })
    }

    /// Claims a cell, to run it, as soon as no other has claimed it.
    ///
    /// # Errors
    /// The claim's file cannot be made.
    pub fn claim(&self, cell: &Key) -> Result<Claim, StoreError> {
        let folder = self.dir.join("claims");
        let claim = Claim::take(&folder, cell, true).map_err(|source| StoreError::Io { path: folder, source })?;
        Ok(claim.expect("who waits gets the claim"))
    }

    /// The latest run, skip or failure of a cell.
    pub fn outcome(&self, cell: &Key) -> Option<&Record> {
        self.cells.get(cell).map(|i| &self.records[*i])
    }

    /// The run of a cell, where that is its latest outcome.
    pub fn run(&self, cell: &Key) -> Option<&Run> {
        match self.outcome(cell) {
            Some(Record::Run(run)) => Some(run),
            _ => None,
        }
    }

    /// The latest outcome of every cell, in the order in which cells first appeared.
    pub fn outcomes(&self) -> impl Iterator<Item = &Record> {
        self.order.iter().filter_map(|key| self.outcome(key))
    }

    /// The latest times of a run; none where it was not timed yet.
    pub fn times(&self, cell: &Key) -> Option<&Times> {
        match self.records.get(*self.times.get(cell)?) {
            Some(Record::Times(times)) => Some(times),
            _ => None,
        }
    }

    /// The scores of a run's present picture, one a reference and metrics version, the latest where there are several.
    pub fn scores(&self, cell: &Key) -> Vec<&Score> {
        let image = self.run(cell).and_then(|run| run.image.as_ref());
        let mut latest: Vec<&Score> = Vec::new();
        for &i in self.scores.get(cell).into_iter().flatten() {
            let Record::Score(score) = &self.records[i] else { continue };
            if image != Some(&score.image) {
                continue;
            }
            match latest.iter_mut().find(|s| s.reference_key == score.reference_key && s.metrics == score.metrics) {
                Some(earlier) => *earlier = score,
                None => latest.push(score),
            }
        }
        latest
    }

    /// The score of a run's present picture against one reference.
    pub fn score(&self, cell: &Key, reference: &Key, metrics: u32) -> Option<&Score> {
        self.scores(cell).into_iter().find(|s| s.reference_key == *reference && s.metrics == metrics)
    }

    /// The references that were made, in the order of their lines.
    pub fn references_made(&self) -> impl Iterator<Item = &ReferenceMade> {
        self.records.iter().filter_map(|record| match record {
            Record::Reference(made) => Some(made),
            _ => None,
        })
    }

    /// The latest cross-check of each scene, frame, quantity and program, in the order in which they first appeared.
    pub fn cross_checks(&self) -> Vec<&CrossCheck> {
        let mut latest: Vec<&CrossCheck> = Vec::new();
        for record in &self.records {
            let Record::CrossCheck(check) = record else { continue };
            match latest.iter_mut().find(|other| other.same_subject(check)) {
                Some(earlier) => *earlier = check,
                None => latest.push(check),
            }
        }
        latest
    }

    /// The figures of a claim that were taken last, in the order of their lines.
    pub fn measured(&self, row: &str) -> Vec<&Measured> {
        let figures = self.all_measured().filter(|figure| figure.row == row);
        let latest = figures.clone().map(|figure| figure.taken).max();
        figures.filter(|figure| Some(figure.taken) == latest).collect()
    }

    /// The figures of all claims, in the order of their lines.
    pub(crate) fn all_measured(&self) -> impl Iterator<Item = &Measured> + Clone {
        self.records.iter().filter_map(|record| match record {
            Record::Measured(figure) => Some(&**figure),
            _ => None,
        })
    }

    /// Where an image lies, or would lie.
    pub fn image_path(&self, image: &Key) -> PathBuf {
        self.dir.join("images").join(format!("{image}.exr"))
    }

    /// Whether an image is there and whole: a reader may have deleted it to save room, a disk may have damaged it.
    pub fn has_image(&self, image: &Key) -> bool {
        std::fs::read(self.image_path(image)).is_ok_and(|bytes| Key::of_bytes(&bytes) == *image)
    }

    /// Stores a picture and returns its content's hash.
    ///
    /// # Errors
    /// The picture's fields do not fit its layout, or the file cannot be written.
    pub fn write_picture(&self, picture: &Picture) -> Result<Key, StoreError> {
        self.write_image(&picture.to_exr()?)
    }

    /// Stores a reference and returns its content's hash.
    ///
    /// # Errors
    /// The reference's fields do not fit its layout, or the file cannot be written.
    pub fn write_reference(&self, reference: &ReferencePicture) -> Result<Key, StoreError> {
        self.write_image(&reference.to_exr()?)
    }

    /// Stores the bytes of an EXR file, such as a reference from a cache, and returns their hash. A power cut may lose it, where
    /// the system has not written it yet: the record that names it is then one without a picture, and the cell is run again.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_image(&self, bytes: &[u8]) -> Result<Key, StoreError> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let hash = Key::of_bytes(bytes);
        let path = self.image_path(&hash);
        if self.has_image(&hash) {
            return Ok(hash);
        }
        self.make_dir(&self.dir.join("images"))?;
        // Written beside and renamed: under its name a file is either whole or not there.
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let beside = self.dir.join("images").join(format!(".{}-{}-{count}.tmp", hash.short(), std::process::id()));
        std::fs::write(&beside, bytes).and_then(|()| std::fs::rename(&beside, &path)).map_err(|source| {
            // The rename's own error is the one to report; a file left beside does no harm.
            let _ = std::fs::remove_file(&beside);
            StoreError::Io { path, source }
        })?;
        Ok(hash)
    }

    /// Reads a picture, or a reference's mean, and checks its content against its hash.
    ///
    /// # Errors
    /// The file is missing, damaged or not a picture.
    pub fn read_picture(&self, image: &Key) -> Result<Picture, StoreError> {
        Ok(Picture::from_exr(&self.read_image(image)?, &self.image_path(image))?)
    }

    /// Reads a reference and checks its content against its hash.
    ///
    /// # Errors
    /// The file is missing, damaged or not a reference.
    pub fn read_reference(&self, image: &Key) -> Result<ReferencePicture, StoreError> {
        Ok(ReferencePicture::from_exr(&self.read_image(image)?, &self.image_path(image))?)
    }

    /// Reads the bytes of an image and checks them against their hash.
    pub(crate) fn read_image(&self, image: &Key) -> Result<Vec<u8>, PictureError> {
        let path = self.image_path(image);
        let bytes = read_bytes(&path)?;
        let actual = Key::of_bytes(&bytes);
        if actual == *image { Ok(bytes) } else { Err(PictureError::Damaged { path, actual: actual.to_string() }) }
    }

    fn make_dir(&self, dir: &Path) -> Result<(), StoreError> {
        std::fs::create_dir_all(dir).map_err(|source| StoreError::Io { path: dir.to_owned(), source })
    }

    /// Indexes the lines that follow those that were read; whether the last one is torn.
    fn take_in(&mut self, content: &[u8]) -> Result<bool, StoreError> {
        for line in lines::split(content) {
            let blank = line.bytes.iter().all(u8::is_ascii_whitespace);
            if !line.ended && !blank && serde_json::from_slice::<IgnoredAny>(line.bytes).is_err() {
                return Ok(true);
            }
            if !blank {
                let (path, number) = (self.path(), self.feeds + 1);
                let record = parse(line.bytes).map_err(|wrong| match wrong {
                    Wrong::Schema(found) => StoreError::Schema { path, line: number, found },
                    Wrong::Record(message) => StoreError::Corrupt { path, line: number, message },
                })?;
                self.index(record);
            }
            self.feeds += usize::from(line.ended);
            self.read += line.bytes.len() as u64 + u64::from(line.ended);
        }
        Ok(false)
    }

    fn io(&self, source: std::io::Error) -> StoreError {
        StoreError::Io { path: self.path(), source }
    }

    fn index(&mut self, record: Record) {
        let place = self.records.len();
        match (&record, record.cell().map(Cell::key)) {
            (_, Some(key)) => {
                if self.cells.insert(key.clone(), place).is_none() {
                    self.order.push(key);
                }
            }
            (Record::Times(times), None) => drop(self.times.insert(times.run.clone(), place)),
            (Record::Score(score), None) => self.scores.entry(score.run.clone()).or_default().push(place),
            (_, None) => {}
        }
        self.records.push(record);
    }
}

/// What is wrong with a line.
enum Wrong {
    Schema(u32),
    Record(String),
}

fn parse(line: &[u8]) -> Result<Record, Wrong> {
    #[derive(Deserialize)]
    struct Version {
        schema: u32,
    }
    let wrong = |error: serde_json::Error| Wrong::Record(error.to_string());
    let version: Version = serde_json::from_slice(line).map_err(wrong)?;
    if version.schema != SCHEMA {
        return Err(Wrong::Schema(version.schema));
    }
    let line: Line<Record> = serde_json::from_slice(line).map_err(wrong)?;
    if line.key != line.record.cell().map(Cell::key) {
        return Err(Wrong::Record("`key` is not the key of the line's fields".into()));
    }
    Ok(line.record)
}
