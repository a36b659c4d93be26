//! A [`Pyramid`](crate::Pyramid) on a graphics processor: the field is uploaded when it changed, levels and horizons are made and stay there.

mod words;
mod work;

use std::fmt::Write;
use std::ops::Range;
use std::sync::Arc;

use halflight_contract::Meter;
use halflight_gpu::{Access, Gpu, GpuError, Part, Pass, Pipeline, Resident, Result, Revision};
use halflight_scenes::HeightField;

use crate::arctangent::ODD;
use crate::shape::Shape;
use crate::{Azimuth, Border, Made, Plane, Settings, Storage};

pub use words::place;

/// Vertices of a side at most: twice its square is still a number of the shaders.
const LONGEST: usize = 32767;

/// Bytes from one small binding to the next.
const APART: u64 = 256;

/// What is done to a shader's text before it is compiled.
pub type Edit<'e> = &'e dyn Fn(String) -> String;

/// A pyramid on a device.
pub struct GpuPyramid {
    gpu: Arc<Gpu>,
    settings: Settings,
    border: Border,
    shape: Option<Shape>,
    azimuths: Vec<Azimuth>,
    decimate: Arc<Pipeline>,
    bring_back: Arc<Pipeline>,
    look: Arc<Pipeline>,
    heights: Resident,
    grids: Resident,
    /// Numbers of levels, [`APART`] bytes from one to the next.
    numbers: Resident,
    levels: Resident,
    back: Resident,
    looks: Resident,
    steps: Resident,
}

impl GpuPyramid {
    /// Compiles what makes a pyramid and looks at it. Levels that stay decimated ([`Storage::Decimated`]) are brought back as
    /// [`Storage::Octaves`] are.
    ///
    /// # Errors
    /// The device is lost, or an edited text does not compile.
    pub fn new(gpu: &Arc<Gpu>, settings: Settings, border: Border, edit: Edit<'_>) -> Result<Self> {
        use Access::{Read, Write};
        let grids = include_str!("../wgsl/grids.wgsl");
        let compile = |label, parts: &[&str], buffers: &[Access]| gpu.pipeline(label, &edit(parts.join("\n")), buffers);
        let plane = match settings.reconstruction.plane {
            Plane::Bilinear => BILINEAR,
            Plane::BSpline => include_str!("../wgsl/b_spline.wgsl"),
        };
        let storage = if settings.storage == Storage::Decimated { Storage::Octaves } else { settings.storage };
        Ok(GpuPyramid {
            gpu: Arc::clone(gpu),
            settings: Settings { storage, ..settings },
            border,
            shape: None,
            azimuths: Vec::new(),
            decimate: compile(
                "decimate",
                &[BILINEAR, grids, include_str!("../wgsl/decimate.wgsl")],
                &[Read, Read, Read, Write],
            )?,
            bring_back: compile(
                "bring back",
                &[plane, grids, include_str!("../wgsl/bring_back.wgsl")],
                &[Read, Read, Read, Write],
            )?,
            look: compile(
                "horizons",
                &[&constants(), BILINEAR, grids, include_str!("../wgsl/look.wgsl")],
                &[Read, Read, Read, Read, Read, Write],
            )?,
            heights: Resident::new("heights"),
            grids: Resident::new("grids"),
            numbers: Resident::new("numbers of levels"),
            levels: Resident::new("levels"),
            back: Resident::new("levels brought back"),
            looks: Resident::new("how to look"),
            steps: Resident::new("steps"),
        })
    }

    /// Takes a field and the azimuths that will be asked, as [`Horizons::update`](crate::Horizons::update). A field of the last revision is
    /// not uploaded again.
    ///
    /// # Errors
    /// A side has more than 32767 vertices, a buffer does not fit, or the device is lost.
    pub fn update(
        &mut self,
        field: &HeightField,
        revision: Revision,
        azimuths: &[Azimuth],
        meter: &mut dyn Meter,
    ) -> Result<Made> {
        let (size, cell) = ([field.columns(), field.rows()], field.cell().to_array());
        let shape = match self.shape.take().filter(|shape| shape.fits(size, cell)) {
            Some(shape) => shape,
            None => self.lay_out(size, cell, meter)?,
        };
        let (gpu, mut made) = (&self.gpu, Made::default());
        if self.azimuths != azimuths {
            let steps = words::steps(&shape, azimuths, self.settings.reconstruction.scale);
            self.steps.upload(gpu, meter, &steps)?;
            self.azimuths = azimuths.to_vec();
            made.azimuths = azimuths.len();
        }
        let mut changed = false;
        self.heights.sync(gpu, revision, meter, || {
            changed = true;
            field.heights().to_vec()
        })?;
        if changed {
            self.make(&shape, meter)?;
            made.levels = looked_at(&shape).len();
        }
        self.shape = Some(shape);
        Ok(made)
    }

    /// Room for the levels of a grid.
    fn lay_out(&mut self, size: [usize; 2], cell: [f32; 2], meter: &mut dyn Meter) -> Result<Shape> {
        if size.iter().any(|side| *side > LONGEST) {
            let message = format!("a field of {} x {} vertices, expected at most {LONGEST} a side", size[0], size[1]);
            let adapter = self.gpu.adapter().name.clone();
            return Err(GpuError::Invalid { adapter, what: "pyramid".into(), message });
        }
        let (gpu, shape) = (&self.gpu, Shape::new(&self.settings, size, cell));
        let [levels, back] = [&shape.levels, &shape.back].map(|grids| &grids[looked_at(&shape)]);
        let (finest, coarser) = levels.split_last().expect("at least one level");
        let words: Vec<u32> = words::grids(coarser).chain(words::grids(&[*finest])).chain(words::grids(back)).collect();
        self.grids.upload(gpu, meter, &words)?;
        let number = |level: usize| [&[level as u32][..], &[0; APART as usize / 4 - 1]].concat();
        self.numbers.upload(gpu, meter, &(0..coarser.len()).flat_map(number).collect::<Vec<_>>())?;
        let open = u32::from(self.border == Border::Open);
        self.looks.upload(gpu, meter, &[shape.levels.len() as u32, open])?;
        self.levels.reserve(gpu, words::bytes(coarser))?;
        self.back.reserve(gpu, words::bytes(back))?;
        self.heights = Resident::new("heights");
        self.azimuths.clear();
        Ok(shape)
    }

    /// Makes all levels out of the heights.
    fn make(&self, shape: &Shape, meter: &mut dyn Meter) -> Result<()> {
        let (grids, levels) = (&shape.levels[looked_at(shape)], self.levels.whole());
        let part = |level: usize| self.numbers.part(level as u64 * APART, 4);
        let buffers: Vec<[Part<'_>; 4]> =
            (0..grids.len() - 1).map(|level| [self.grids.whole(), part(level), self.heights.whole(), levels]).collect();
        let decimate = |(level, buffers)| {
            let threads = words::samples(&grids[level..=level]);
            Pass { name: "decimate", pipeline: &self.decimate, buffers, threads }
        };
        let mut passes: Vec<Pass<'_>> =
            buffers.iter().map(|buffers| &buffers[..]).enumerate().rev().map(decimate).collect();
        let buffers = [self.grids.whole(), self.heights.whole(), levels, self.back.whole()];
        let threads = words::samples(&shape.back[looked_at(shape)]);
        passes.push(Pass { name: "bring back", pipeline: &self.bring_back, buffers: &buffers, threads });
        self.gpu.run(&passes, meter)?;
        self.tell_levels(shape, meter);
        Ok(())
    }

    /// The buffers of [`GpuPyramid::pass`] for receivers at [`place`]s, four words each, and their elevations in radians: of all receivers
    /// under the first azimuth of the last [`GpuPyramid::update`], then under the next.
    pub fn buffers<'a>(&'a self, places: Part<'a>, elevations: Part<'a>) -> [Part<'a>; 6] {
        let [looks, grids, back, steps] = [&self.looks, &self.grids, &self.back, &self.steps].map(Resident::whole);
        [looks, grids, back, steps, places, elevations]
    }

    /// Finds the horizons of so many receivers.
    pub fn pass<'a>(&'a self, buffers: &'a [Part<'a>; 6], receivers: u64) -> Pass<'a> {
        let threads = receivers * self.azimuths.len() as u64;
        Pass { name: "horizons", pipeline: &self.look, buffers, threads }
    }

    /// Samples of heights that a receiver takes under an azimuth.
    pub fn samples(&self) -> usize {
        self.shape.as_ref().map_or(0, |shape| shape.levels.len())
    }

    /// Bytes held on the device.
    pub fn bytes(&self) -> u64 {
        let buffers = [&self.heights, &self.grids, &self.numbers, &self.levels, &self.back, &self.looks, &self.steps];
        buffers.map(Resident::bytes).iter().sum()
    }
}

/// The levels that are looked at: no others are made.
fn looked_at(shape: &Shape) -> Range<usize> {
    shape.coarsest()..shape.levels.len()
}

const BILINEAR: &str = include_str!("../wgsl/bilinear.wgsl");

/// The numbers that the CPU has too.
fn constants() -> String {
    let odd: Vec<String> = ODD.iter().map(|coefficient| format!("{:?}f", *coefficient as f32)).collect();
    let mut text = format!("const ODD = array<f32, {}>({});\n", ODD.len(), odd.join(", "));
    writeln!(text, "const RIGHT_ANGLE: f32 = {:?}f;", std::f32::consts::FRAC_PI_2).expect("a string");
    text
}
