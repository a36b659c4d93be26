//! `halflight doctor`.

use super::{CacheDir, Ending, say};
use clap::Args;
use halflight_scenes::Scene;

#[derive(Args)]
pub(super) struct Doctor {
    #[command(flatten)]
    cache: CacheDir,
}

impl Doctor {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let environment = crate::environment::environment();
        let row = |name: &str, value: &str| say(&format!("{name:12} {value}"));
        row("halflight", &environment.halflight);
        row("processor", &environment.cpu);
        row("features", &crate::environment::cpu_features().join(" "));
        row("cores", &format!("{}, {} threads in use", environment.cores, environment.threads));
        row("system", &environment.os);
        row("compiler", &environment.rustc);
        let slow = if environment.profile == "release" { "" } else { " (times say nothing: build with --release)" };
        row("profile", &format!("{}{slow}", environment.profile));
        crate::backends::adapters().iter().for_each(|adapter| row("adapter", adapter));
        let pictures = halflight_scenes::open_image_io();
        row("OpenImageIO", &pictures.unwrap_or_else(|| "not built in (feature `oiio`)".into()));
        row("cache", &self.cache.path()?.display().to_string());
        row("references", halflight_references::REVISION);
        let mut ending = Ending::Well;
        for (name, file, _) in halflight_scenes::shipped() {
            // Loading verifies every asset's hash.
            match Scene::load(&file) {
                Ok(scene) => row("scene", &format!("{name}: whole, content {}", &scene.content.to_string()[..12])),
                Err(error) => {
                    row("scene", &format!("{name}: {error}"));
                    ending = Ending::Differs;
                }
            }
        }
        Ok(ending)
    }
}
