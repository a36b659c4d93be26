//! Parameters of the family.

use halflight_contract::{Kind, ParamSpec, Params, Phase};
use halflight_horizons::{Border, March, Plane, Pyramid, Reconstruction, Scale, Settings, Storage};

/// SH order; a hemisphere lights a level receiver exactly from order 2 on.
pub(crate) const ORDER: ParamSpec = ParamSpec {
    name: "order",
    kind: Kind::Int { min: 2, max: halflight_sh::MAX_ORDER as i64, default: 4 },
    phase: Phase::Prepare,
    help: "SH order n of light and visibility: bands 0..n−1, n² coefficients",
};

pub(crate) const AZIMUTHS: ParamSpec = ParamSpec {
    name: "azimuths",
    kind: Kind::Int { min: 4, max: 64, default: 16 },
    phase: Phase::Prepare,
    help: "azimuths nφ of the complete swath",
};

pub(crate) const KEY_AZIMUTHS: ParamSpec = ParamSpec {
    name: "key-azimuths",
    kind: Kind::Int { min: 1, max: 64, default: 3 },
    phase: Phase::Prepare,
    help: "azimuths nφ of a key light's swath",
};

pub(crate) const SWATH: ParamSpec = ParamSpec {
    name: "swath",
    kind: Kind::Float { min: 0.0, max: 360.0, default: 0.0 },
    phase: Phase::Prepare,
    help: "degrees ΔΦ of a key light's swath; 0: the smallest of 180, 90, 45, … that covers the light; 360: complete",
};

pub(crate) const KEY_LEVEL: ParamSpec = ParamSpec {
    name: "key-level",
    kind: Kind::Choice(crate::key::Level::NAMES),
    phase: Phase::Update,
    help: "unshadowed key light within a swath is scaled right for receivers that face it, or for level ones, or not",
};

/// That of all families, but a key light's level depends on it.
pub(crate) const WINDOW_VISIBILITY: ParamSpec =
    ParamSpec { phase: Phase::Update, ..halflight_blockers::params::WINDOW_VISIBILITY };

pub(crate) const LEVELS: ParamSpec = ParamSpec {
    name: "levels",
    kind: Kind::Int { min: 1, max: 16, default: 4 },
    phase: Phase::Update,
    help: "pyramid levels an octave k",
};

pub(crate) const OFFSET: ParamSpec = ParamSpec {
    name: "offset",
    kind: Kind::Float { min: 0.0, max: 16.0, default: 2.0 },
    phase: Phase::Update,
    help: "level offset o in octaves: how much finer levels are than their distances",
};

pub(crate) const SCALE: ParamSpec = ParamSpec {
    name: "scale",
    kind: Kind::Choice(&["b-spline", "linear"]),
    phase: Phase::Update,
    help: "reconstruction of a key light's horizon between scales; other lights take the greatest of the levels",
};
const SCALES: [Scale; 2] = [Scale::BSpline, Scale::Linear];

pub(crate) const PLANE: ParamSpec = ParamSpec {
    name: "plane",
    kind: Kind::Choice(&["b-spline", "bilinear"]),
    phase: Phase::Update,
    help: "reconstruction of pyramid levels in the plane",
};
const PLANES: [Plane; 2] = [Plane::BSpline, Plane::Bilinear];

pub(crate) const STORAGE: ParamSpec = ParamSpec {
    name: "storage",
    kind: Kind::Choice(&["octaves", "decimated", "full"]),
    phase: Phase::Update,
    help: "once a frame pyramid levels are brought back to at least twice their resolution, or stay decimated, or are brought back to \
           the field's",
};
const STORAGES: [Storage; 3] = [Storage::Octaves, Storage::Decimated, Storage::Full];

pub(crate) const BORDER: ParamSpec = ParamSpec {
    name: "border",
    kind: Kind::Choice(&["open", "extend"]),
    phase: Phase::Update,
    help: "beyond its border the field ends, or goes on as it is there",
};
const BORDERS: [Border; 2] = [Border::Open, Border::Extend];

/// The value that a choice's name stands for.
fn chosen<T: Copy, const N: usize>(params: &Params, spec: &ParamSpec, values: [T; N]) -> T {
    let Kind::Choice(names) = spec.kind else { return values[0] };
    let name = params.choice(spec.name);
    names.iter().zip(values).find_map(|(known, value)| (*known == name).then_some(value)).unwrap_or(values[0])
}

/// The pyramid that parameters ask for.
pub(crate) fn pyramid(params: &Params) -> Pyramid {
    Pyramid::new(settings(params)).with_border(border(params))
}

/// What it is made with.
pub(crate) fn settings(params: &Params) -> Settings {
    let reconstruction =
        Reconstruction { scale: chosen(params, &SCALE, SCALES), plane: chosen(params, &PLANE, PLANES) };
    Settings {
        levels_per_octave: params.int(LEVELS.name),
        offset: params.float(OFFSET.name) as f32,
        reconstruction,
        storage: chosen(params, &STORAGE, STORAGES),
    }
}

/// Whether its levels stay decimated.
pub(crate) fn decimated(params: &Params) -> bool {
    chosen(params, &STORAGE, STORAGES) == Storage::Decimated
}

/// What lies beyond its border.
pub(crate) fn border(params: &Params) -> Border {
    chosen(params, &BORDER, BORDERS)
}

/// The march that they ask for.
pub(crate) fn march(params: &Params) -> March {
    March::default().with_border(border(params))
}
