//! `halflight probe`.

use super::{CacheDir, Ending, say};
use crate::plan::quantity;
use crate::probe::{Answers, Question, Source, probe};
use crate::settings::Setting;
use clap::Args;
use glam::Vec3;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Args)]
#[command(group = clap::ArgGroup::new("source").required(true))]
pub(super) struct Probe {
    /// A shipped scene's name, or the path of a scene file
    #[arg(long)]
    scene: String,
    /// The method to ask
    #[arg(long, group = "source")]
    method: Option<String>,
    /// The reference to ask: truth, sh-light:4, sphere-proxies:64
    #[arg(long, group = "source")]
    reference: Option<String>,
    /// Points as lines of x,y,z,nx,ny,nz; their albedo is 1
    #[arg(long, value_name = "CSV")]
    at: PathBuf,
    /// Value of a parameter, repeatable: order=4
    #[arg(long, value_name = "NAME=VALUE", conflicts_with = "reference")]
    set: Vec<Setting>,
    /// Samples of the reference at every point
    #[arg(long, value_name = "N", default_value_t = 4096)]
    samples: u32,
    /// Which light: direct, indirect-N by up to N bounces, total
    #[arg(long, default_value = "direct")]
    quantity: String,
    /// SH order in which to project the reference's visibility too
    #[arg(long, value_name = "ORDER", conflicts_with = "method", value_parser = clap::value_parser!(u8).range(1..=8))]
    visibility: Option<u8>,
    /// The frame
    #[arg(long, default_value_t = 0)]
    frame: usize,
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print a JSON array of {position, normal, radiance, standard_error?, visibility?, visibility_error?} rather than CSV
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    cache: CacheDir,
}

/// One point and its answer.
#[derive(Serialize)]
struct Row<'a> {
    position: [f32; 3],
    normal: [f32; 3],
    radiance: [f32; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    standard_error: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    visibility: Option<&'a [f32]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    visibility_error: Option<&'a [f32]>,
}

impl Probe {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let source = match (&self.method, &self.reference) {
            (Some(method), _) => Source::method(method, &self.set)?,
            (None, Some(reference)) => Source::reference(reference, self.samples, self.visibility)?,
            (None, None) => anyhow::bail!("expected --method or --reference"),
        };
        let points = halflight_scenes::read_points_csv(&self.at)?;
        let scene = halflight_scenes::find(&self.scene)?.with_receivers(&points);
        let quantity = quantity(&self.quantity)?;
        let question = Question { scene: &scene, frame: self.frame, quantity, seed: self.seed };
        let answers = probe(&question, &source, &self.cache.path()?)?;
        let rows = rows(&points, &answers);
        if self.json {
            say(&serde_json::to_string_pretty(&rows)?)
        } else {
            csv(&rows).iter().for_each(|line| say(line))
        }
        Ok(Ending::Well)
    }
}

fn rows<'a>(points: &[(Vec3, Vec3)], answers: &'a Answers) -> Vec<Row<'a>> {
    let row = |(i, (position, normal)): (usize, &(Vec3, Vec3))| Row {
        position: position.to_array(),
        normal: normal.to_array(),
        radiance: answers.radiance[i].to_array(),
        standard_error: answers.standard_error.as_ref().map(|all| all[i].to_array()),
        visibility: answers.visibility.as_ref().map(|all| all[i].as_slice()),
        visibility_error: answers.visibility_error.as_ref().map(|all| all[i].as_slice()),
    };
    points.iter().enumerate().map(row).collect()
}

/// A header and a line a point; the shortest digits that read back as the same number.
fn csv(rows: &[Row<'_>]) -> Vec<String> {
    let mut names: Vec<String> = ["x", "y", "z", "nx", "ny", "nz", "r", "g", "b"].map(str::to_owned).into();
    if rows.iter().any(|row| row.standard_error.is_some()) {
        names.extend(["se_r", "se_g", "se_b"].map(str::to_owned));
    }
    let coefficients = rows.first().and_then(|row| row.visibility).map_or(0, <[f32]>::len);
    names.extend((0..coefficients).map(|i| format!("v{i}")));
    let errors = rows.first().and_then(|row| row.visibility_error).map_or(0, <[f32]>::len);
    names.extend((0..errors).map(|i| format!("se_v{i}")));
    let line = |row: &Row<'_>| {
        let numbers = row.position.iter().chain(&row.normal).chain(&row.radiance);
        let numbers = numbers.chain(row.standard_error.iter().flatten()).chain(row.visibility.into_iter().flatten());
        let numbers = numbers.chain(row.visibility_error.into_iter().flatten());
        numbers.map(f32::to_string).collect::<Vec<_>>().join(",")
    };
    std::iter::once(names.join(",")).chain(rows.iter().map(line)).collect()
}
