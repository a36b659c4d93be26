//! `halflight measured`.

use super::run::Run;
use super::{Ending, say};
use crate::measured::{Conditions, FOLDER, Measured, PeakOf, collect, conditions, page, read_all};
use anyhow::Context;
use clap::{Args, Subcommand};
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};

/// What is measured when nothing is said.
const SUITE: &str = "paper/rates";

#[derive(Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(super) struct Page {
    #[command(subcommand)]
    what: Option<What>,
    /// Where the page is written: beside the folder of files, as FOLDER.md, if not given
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write nothing; exit with 1 if the page is not what the files say
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    files: Files,
}

#[derive(Subcommand)]
enum What {
    /// Run what is asked for (the default: the `paper/rates` suite), keep it as the file of this device, and write the page
    Take(Box<Take>),
}

/// Where files of devices are kept.
#[derive(Args)]
struct Files {
    /// Folder of the files, one a device
    #[arg(long, value_name = "DIR", default_value = FOLDER)]
    files: PathBuf,
}

#[derive(Args)]
struct Take {
    #[command(flatten)]
    run: Run,
    #[command(flatten)]
    files: Files,
    /// What the results are about, and what the file is called by; the adapter's name, or the processor's, if not given
    #[arg(long, value_name = "NAME")]
    device: Option<String>,
    /// What else is to be known: clocks that were set, limits of power, others at work
    #[arg(long, value_name = "TEXT", default_value = "")]
    note: String,
    /// The most that the device can do, operations of f32 and bytes a second, repeatable: gpu=67e12,3.35e12; of an older file of the device
    /// if not given
    #[arg(long, value_name = "SIDE=FLOPS,BYTES")]
    peak: Vec<PeakOf>,
}

impl Page {
    pub(super) fn act(&self, threads: &[usize]) -> anyhow::Result<Ending> {
        if let Some(What::Take(take)) = &self.what {
            return take.act(threads);
        }
        let path = self.out.clone().unwrap_or_else(|| beside(&self.files.files));
        let text = page(&read_all(&self.files.files)?);
        if !self.check {
            return write(&path, &text);
        }
        let stored = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        if stored == text {
            return Ok(Ending::Well);
        }
        say(&format!(
            "{} is not what {} says; `halflight measured` writes it",
            path.display(),
            self.files.files.display()
        ));
        Ok(Ending::Differs)
    }
}

impl Take {
    fn act(&self, threads: &[usize]) -> anyhow::Result<Ending> {
        // Before the run, which is work itself.
        let began = self.conditions()?;
        let file = self.files.files.join(began.file_name()?);
        let older = if file.exists() { Some(Measured::read(&file)?) } else { None };
        let keys: HashSet<_> = self.run.plan(SUITE, threads)?.cells().map(|(_, cell)| cell.key()).collect();
        let (ending, store) = self.run.carry_out(SUITE, threads)?;
        let Some(store) = store else { return Ok(ending) };
        let mut peaks = older.map_or_else(BTreeMap::new, |older| older.conditions.peaks);
        peaks.extend(self.peak.iter().map(|of| (of.side.clone(), of.peak)));
        let conditions = Conditions { peaks, taken: Conditions::now(), ..began };
        collect(&store, &keys, conditions)?.write(&file)?;
        say(&file.display().to_string());
        write(&beside(&self.files.files), &page(&read_all(&self.files.files)?))?;
        Ok(ending)
    }

    fn conditions(&self) -> anyhow::Result<Conditions> {
        let found = conditions(self.run.adapter()?);
        let device = self.device.clone().unwrap_or(found.device);
        let command = format!("halflight measured take{}", self.run.words(SUITE));
        Ok(Conditions { device, note: self.note.clone(), command, ..found })
    }
}

fn beside(folder: &Path) -> PathBuf {
    folder.with_extension("md")
}

fn write(path: &Path, text: &str) -> anyhow::Result<Ending> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    std::fs::write(path, text).with_context(|| path.display().to_string())?;
    say(&path.display().to_string());
    Ok(Ending::Well)
}
