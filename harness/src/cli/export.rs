//! `halflight export`.

use super::{CacheDir, Ending, say, table::Table};
use crate::export::{Check, export_to_mitsuba};
use crate::probe::check_frame;
use clap::{ArgGroup, Args, ValueEnum};
use std::path::{Path, PathBuf};

#[derive(Args)]
#[command(group(ArgGroup::new("what").required(true).multiple(true).args(["csv", "parquet", "scene"])))]
pub(super) struct Export {
    #[command(flatten)]
    table: Table,
    /// A scene for another renderer: a shipped one's name, or the path of a scene file
    #[arg(long, requires = "to", requires = "out", conflicts_with_all = ["csv", "parquet"])]
    scene: Option<String>,
    /// Another renderer, or a format that programs for modelling read
    #[arg(long, value_enum, requires = "scene")]
    to: Option<Target>,
    /// Results directory that a table is made of, halflight-out if not given; or the folder that a scene is written into
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
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
enum Target {
    /// Mitsuba 3: a scene a light, the blockers, and the receivers
    Mitsuba,
    /// One GLB with objects, lights and camera, as `halflight import` reads it again; what changes its shape stands still
    Gltf,
}

impl Export {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let (Some(scene), Some(to), Some(out)) = (&self.scene, self.to, &self.out) else {
            return self.table.write(self.out.as_deref());
        };
        match to {
            Target::Mitsuba => self.mitsuba(scene, out)?,
            Target::Gltf => self.gltf(scene, out)?,
        }
        Ok(Ending::Well)
    }

    fn mitsuba(&self, scene: &str, out: &Path) -> anyhow::Result<()> {
        let check = Check {
            scene: scene.to_owned(),
            frame: self.frame,
            quantity: self.quantity.clone(),
            receivers: self.receivers,
            samples: self.samples,
            seed: self.seed,
        };
        export_to_mitsuba(&check, &self.cache.path()?, out)?;
        say(&format!("exported {} of {} to {}", check.quantity, check.scene, out.display()));
        Ok(())
    }

    fn gltf(&self, scene: &str, out: &Path) -> anyhow::Result<()> {
        let scene = halflight_scenes::find(scene)?;
        check_frame(&scene, self.frame)?;
        let exported = halflight_scenes::export_gltf(&scene, self.frame, out)?;
        exported.notices.iter().for_each(|notice| say(notice));
        say(&format!("exported {} to {}", scene.name, exported.file.display()));
        Ok(())
    }
}
