//! Soft shadows on height fields by horizons and visibility wedges (Snyder and Nowrouzezahrai 2008).
//!
//! At every receiver the horizon is found at some azimuths of a swath. Between neighbouring azimuths its elevation is taken as linear; such
//! a wedge of visible directions is looked up in a table by its two elevations, turned to its azimuth and added to the total visibility `V`.
//! Radiance is `albedo · L · (H(N) * V)`, an SH product and a dot product; `H` has the `1/π` of this house.
//!
//! Environments and skies are seen through the complete swath. A key light is seen through a partial swath about its azimuth, the smallest
//! that covers it, as though it were restricted to it; its level is then that of unshadowed shading on what faces it, as the caption of
//! Fig. 6 has it, or on level ground (`key-level`). One scale does not do for both: with the sun at 10° level ground gets 1.8 times
//! its due by the former, a slope of 30° that faces it 0.6 of its by the latter. RMSE by the sweep, order 4, facing : ground:
//! `jacksboro-sunrise` (sun at 8°) 0.101 : 0.069, `cone` 0.031 : 0.030, `fractal-256-key` 0.027 : 0.033, `waves` 0.020 : 0.026, grown
//! hills 0.037 : 0.041; a least-squares fit to slopes lies between.
//!
//! # Variants
//!
//! They differ in what finds the horizon, the paper's pyramid, its march of 145 samples or an exact sweep, and in what is made of it.
//! `hard` asks for a key light whether its centre is above the horizon; `ambient` lights everything alike by the open share of the cosine;
//! `blockers` multiplies the visibility among spheres above the field into `V`, the paper's closing suggestion.
//!
//! # Limits
//!
//! Light from below elevation 0 arrives as truncation leaves it: hardly through partial swaths, a little through the complete one. Beyond
//! its border nothing hides light, or the field goes on as at the border (`border`; the sweep has the former alone). A light of order n
//! is never wholly within a swath: through one of 22.5° an order-4 lobe still fades over elevation as a lobe
//! does. Receivers that do not lie on the field are taken to stand on it below where they are.

mod casters;
#[cfg(feature = "gpu")]
mod gpu;
mod key;
mod params;
mod plan;
mod prepared;
mod shading;
mod sum;
mod support;
mod swath;
mod table;
mod wedge;

use halflight_blockers::params::{MIN_ANGLE, SELF_SHADOW, SPHERES, WINDOW_LIGHT};
use halflight_contract::{
    Backend, Coupling, Info, Job, Meter, Method, ParamSpec, Params, Prepared, Request, Result, Support,
};
use halflight_horizons::{Horizons, Sweep};
use halflight_scenes::SceneFacts;

use params::{
    AZIMUTHS, BORDER, KEY_AZIMUTHS, KEY_LEVEL, LEVELS, OFFSET, ORDER, PLANE, SCALE, STORAGE, SWATH, WINDOW_VISIBILITY,
};
use prepared::Terrain;

/// A member of the family.
#[derive(Clone, Copy)]
pub struct Variant {
    info: &'static Info,
    /// What finds horizons.
    horizons: fn(&Params) -> Box<dyn Horizons>,
    /// What becomes of key lights.
    keys: Keys,
    /// Whether light is dimmed by the open share of the cosine alone.
    ambient: bool,
    /// Whether spheres stand for what casts shadows beside the field.
    casters: bool,
}

/// The backends of variants that have shaders.
const BOTH: &[Backend] = if cfg!(feature = "gpu") { &[Backend::Cpu, Backend::GPU] } else { CPU };
const CPU: &[Backend] = &[Backend::Cpu];

/// How key lights are seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Keys {
    /// As all other light, through the complete swath.
    Complete,
    /// Each through its swath.
    Partial,
    /// By their centres.
    Hard,
}

/// Parameters that every variant has, then some of its own.
macro_rules! with {
    ($($own:expr),*) => {
        &[ORDER, AZIMUTHS, $($own,)* WINDOW_LIGHT, WINDOW_VISIBILITY]
    };
}

/// Along a row of vertices pyramid and march step from one to the next, elsewhere they start anew at each: on 1024 vertices a side that differs by
/// rounding of coordinates up to 1e-4 of a cell.
const STREAMED: Coupling = Coupling::Clustered(1e-3);

/// All light through the complete swath.
pub const COMPLETE: Variant = Variant {
    info: &Info {
        id: "horizon-wedges/complete",
        about: "horizons from a pyramid, wedges over the complete swath for all light",
        paper: "Snyder and Nowrouzezahrai 2008, §§4–6",
        backends: BOTH,
        params: with!(LEVELS, OFFSET, SCALE, PLANE, STORAGE, BORDER),
        coupling: STREAMED,
    },
    horizons: pyramid,
    keys: Keys::Complete,
    ambient: false,
    casters: false,
};

/// Key lights through partial swaths.
pub const PARTIAL: Variant = Variant {
    info: &Info {
        id: "horizon-wedges/partial",
        about: "horizons from a pyramid, wedges over a partial swath for each key light, the complete one for the rest",
        params: with!(KEY_AZIMUTHS, SWATH, KEY_LEVEL, LEVELS, OFFSET, SCALE, PLANE, STORAGE, BORDER),
        ..*COMPLETE.info
    },
    keys: Keys::Partial,
    ..COMPLETE
};

/// Horizons by marching.
pub const MARCH: Variant = Variant {
    info: &Info {
        id: "horizon-wedges/march",
        about: "as partial, with horizons by 145 samples along each azimuth",
        paper: "Snyder and Nowrouzezahrai 2008, §7, Fig. 10a",
        params: with!(KEY_AZIMUTHS, SWATH, KEY_LEVEL, BORDER),
        backends: CPU,
        ..*COMPLETE.info
    },
    horizons: |params| Box::new(params::march(params)),
    keys: Keys::Partial,
    ..COMPLETE
};

/// Exact horizons.
pub const SWEEP: Variant = Variant {
    info: &Info {
        id: "horizon-wedges/sweep",
        about: "as partial, with horizons by convex hulls swept along lines",
        paper: "Timonen and Westerholm 2010; Snyder and Nowrouzezahrai 2008, §5",
        params: with!(KEY_AZIMUTHS, SWATH, KEY_LEVEL),
        coupling: Coupling::Independent,
        ..*MARCH.info
    },
    horizons: |_| Box::new(Sweep::new()),
    ..MARCH
};

/// Hard shadows.
pub const HARD: Variant = Variant {
    info: &Info {
        id: "horizon-wedges/hard",
        about: "hard shadows of key lights' centres by marching, wedges over the complete swath for the rest",
        paper: "Max 1988; Snyder and Nowrouzezahrai 2008, eq. 1",
        params: with!(BORDER),
        ..*MARCH.info
    },
    keys: Keys::Hard,
    ..MARCH
};

/// Ambient occlusion.
pub const AMBIENT: Variant = Variant {
    info: &Info {
        id: "horizon-wedges/ambient",
        about: "unshadowed irradiance times the open share of the cosine above the horizon",
        paper: "Dimitrov et al. 2008, as told by Snyder and Nowrouzezahrai 2008, §2",
        backends: CPU,
        ..*COMPLETE.info
    },
    ambient: true,
    ..COMPLETE
};

/// Spheres above the field.
pub const BLOCKERS: Variant = Variant {
    info: &Info {
        id: "horizon-wedges/blockers",
        about: "as partial, times the visibility among sphere blockers above the field",
        paper: "Snyder and Nowrouzezahrai 2008, §8; Ren et al. 2006",
        params: with!(
            KEY_AZIMUTHS,
            SWATH,
            KEY_LEVEL,
            LEVELS,
            OFFSET,
            SCALE,
            PLANE,
            STORAGE,
            BORDER,
            SPHERES,
            SELF_SHADOW,
            MIN_ANGLE
        ),
        backends: CPU,
        ..*COMPLETE.info
    },
    casters: true,
    ..PARTIAL
};

fn pyramid(params: &Params) -> Box<dyn Horizons> {
    Box::new(params::pyramid(params))
}

impl Variant {
    fn declares(&self, spec: &ParamSpec) -> bool {
        self.info.params.iter().any(|declared| declared.name == spec.name)
    }
}

impl Method for Variant {
    fn info(&self) -> &'static Info {
        self.info
    }

    fn supports(&self, facts: &SceneFacts, request: &Request<'_>) -> Support {
        support::supports(self, facts, request)
    }

    fn prepare<'s>(&self, job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
        match job.backend {
            Backend::Cpu => Ok(Box::new(Terrain::prepare(self, job, meter)?)),
            #[cfg(feature = "gpu")]
            Backend::Gpu(_) => Ok(Box::new(gpu::GpuTerrain::prepare(self, job, meter, Box::new(|text| text))?)),
            #[cfg(not(feature = "gpu"))]
            Backend::Gpu(_) => Err(halflight_contract::Error::Device("built without the feature gpu".into())),
        }
    }
}
