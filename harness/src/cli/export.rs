//! `halflight export`.

use super::{CacheDir, Ending, say};
use crate::export::{Check, export_to_mitsuba};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct Export {
    /// A shipped scene's name, or the path of a scene file
    #[arg(long)]
    scene: String,
    /// The other renderer
    #[arg(long, value_enum)]
    to: Renderer,
    /// Folder to write into
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Which light: direct, indirect-N by up to N bounces, total
    #[arg(long, default_value = "direct")]
    quantity: String,
    /// At most so many receivers are written with their truth, spread evenly over the scene's: of a picture every so many pixels
    #[arg(long, value_name = "N", default_value_t = 2000)]
    receivers: usize,
    /// Samples of the truth at every receiver
    #[arg(long, value_name = "N", default_value_t = 16384)]
    samples: u32,
    /// The frame
    #[arg(long, default_value_t = 0)]
    frame: usize,
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    cache: CacheDir,
}

#[derive(Clone, Copy, ValueEnum)]
enum Renderer {
    /// Mitsuba 3: a scene a light, the blockers, and the receivers
    Mitsuba,
}

impl Export {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let check = Check {
            scene: self.scene.clone(),
            frame: self.frame,
            quantity: self.quantity.clone(),
            receivers: self.receivers,
            samples: self.samples,
            seed: self.seed,
        };
        match self.to {
            Renderer::Mitsuba => export_to_mitsuba(&check, &self.cache.path()?, &self.out)?,
        }
        say(&format!("exported {} of {} to {}", check.quantity, check.scene, self.out.display()));
        Ok(Ending::Well)
    }
}
