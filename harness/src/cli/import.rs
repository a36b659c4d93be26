//! `halflight import`.

use super::{Ending, say};
use clap::{Args, ValueEnum};
use halflight_scenes::{Import as Request, Up, Wanted, import};
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct Import {
    /// Models (.glb, .gltf, .obj, .off, .ply), and a picture of the surroundings (.exr, .hdr) that lights them
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Folder of the scene, which must not be there yet; the scene's name if not given
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Write into the folder even if it is there
    #[arg(long)]
    force: bool,
    /// Name of the scene; that of the first model if not given
    #[arg(long)]
    name: Option<String>,
    /// The axis of OBJ, OFF and PLY files that points up; y if not given
    #[arg(long, value_enum)]
    up: Option<Axis>,
    /// The models' unit of length, m if not given: m, cm, mm, km, in, ft, or how many metres it is
    #[arg(long, value_parser = unit)]
    unit: Option<f32>,
    /// Pixels of the camera, such as 160x120; those of the model's camera if not given
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
    size: Option<[usize; 2]>,
    /// Where light is asked
    #[arg(long, value_enum, default_value = "camera")]
    receivers: Receivers,
    /// No ground below the models
    #[arg(long)]
    no_ground: bool,
    /// Name or number of the animation that is played, none for none; the first if not given
    #[arg(long)]
    clip: Option<String>,
    /// Most frames; else as many as the clip is long
    #[arg(long, value_name = "N", default_value_t = 240)]
    frames: usize,
    /// Frames a second
    #[arg(long, default_value_t = 24.0)]
    fps: f32,
    /// By which the models' own lights are multiplied: a lux counts as a unit of irradiance, a candela as one of intensity
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    light_scale: f32,
}

#[derive(Clone, Copy, ValueEnum)]
enum Axis {
    Y,
    Z,
}

#[derive(Clone, Copy, ValueEnum)]
enum Receivers {
    /// What the camera's pixels see
    Camera,
    /// The vertices of the first mesh
    Vertices,
    /// A grid on the ground
    Ground,
}

/// Metres.
fn unit(text: &str) -> Result<f32, String> {
    let known = [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("km", 1000.0), ("in", 0.0254), ("ft", 0.3048)];
    let named = known.iter().find(|(name, _)| *name == text).map(|(_, metres)| *metres);
    let metres = named.or_else(|| text.parse().ok()).filter(|metres: &f32| metres.is_finite() && *metres > 0.0);
    metres.ok_or_else(|| "expected m, cm, mm, km, in, ft, or a positive number of metres".into())
}

fn size(text: &str) -> Result<[usize; 2], String> {
    let sides = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides
        .filter(|sides| sides.iter().all(|side| *side > 0))
        .ok_or_else(|| "expected WIDTHxHEIGHT, such as 160x120".into())
}

impl Import {
    pub(super) fn act(self) -> anyhow::Result<Ending> {
        let request = Request {
            files: self.files,
            name: self.name,
            up: self.up.map(|up| match up {
                Axis::Y => Up::Y,
                Axis::Z => Up::Z,
            }),
            unit: self.unit,
            size: self.size,
            receivers: match self.receivers {
                Receivers::Camera => Wanted::Camera,
                Receivers::Vertices => Wanted::Vertices,
                Receivers::Ground => Wanted::Ground,
            },
            ground: !self.no_ground,
            clip: self.clip,
            frames: self.frames,
            fps: self.fps,
            light_scale: self.light_scale,
        };
        let made = import(&request, self.out.as_deref(), self.force)?;
        made.told.iter().for_each(|line| say(line));
        say(&format!("wrote {}; halflight run --scene {0} runs it", made.file.display()));
        Ok(Ending::Well)
    }
}
