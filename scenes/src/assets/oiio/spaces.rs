//! Colour spaces by the names that OpenImageIO has for them.

use halflight_oiio::Numbers;

use crate::assets::color::{Chromaticities, REC_709, linear};

pub(super) const KNOWN: &str = "a colour space such as linear, sRGB, Rec709, Gamma2.2, ACEScg or AdobeRGB";

const AP0: Chromaticities = [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077], [0.32168, 0.33767]];
const AP1: Chromaticities = [[0.713, 0.293], [0.165, 0.83], [0.128, 0.044], [0.32168, 0.33767]];
const ADOBE: Chromaticities = [[0.64, 0.33], [0.21, 0.71], [0.15, 0.06], [0.3127, 0.3290]];
const P3: Chromaticities = [[0.68, 0.32], [0.265, 0.69], [0.15, 0.06], [0.3127, 0.3290]];
const REC_2020: Chromaticities = [[0.708, 0.292], [0.17, 0.797], [0.131, 0.046], [0.3127, 0.3290]];

/// How a space maps light to numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Transfer {
    Linear,
    Srgb,
    Rec709,
    Gamma(f32),
}

impl Transfer {
    /// The light that a number stands for.
    pub(super) fn linear(self, value: f32) -> f32 {
        match self {
            Transfer::Linear => value,
            Transfer::Srgb => linear(value),
            Transfer::Rec709 => rec709(value),
            // The sign stays: negative numbers are told of later.
            Transfer::Gamma(gamma) => value.signum() * value.abs().powf(gamma),
        }
    }
}

/// ITU-R BT.709-6, 1.2.
fn rec709(value: f32) -> f32 {
    if value < 0.081 { value / 4.5 } else { ((value + 0.099) / 1.099).powf(1.0 / 0.45) }
}

/// A space by what OpenImageIO calls it, from 2.4's names to the `transfer_primaries_scene` of 3.x.
pub(super) fn space(name: &str, numbers: Numbers) -> Option<(Transfer, Chromaticities)> {
    let name = name.to_ascii_lowercase();
    let gamma = |text: &str| text.parse().ok().filter(|gamma| (1.0..=4.0).contains(gamma)).map(Transfer::Gamma);
    let whole = match name.as_str() {
        "" if numbers == Numbers::Floating => Some((Transfer::Linear, REC_709)),
        "" => Some((Transfer::Srgb, REC_709)),
        // What 2.4 says of every netpbm picture; portable float maps are linear.
        "rec709" if numbers == Numbers::Floating => Some((Transfer::Linear, REC_709)),
        "linear" | "scene_linear" | "lin_srgb" => Some((Transfer::Linear, REC_709)),
        "srgb" | "srgb_tx" | "srgb_texture" => Some((Transfer::Srgb, REC_709)),
        "rec709" => Some((Transfer::Rec709, REC_709)),
        "acescg" => Some((Transfer::Linear, AP1)),
        "aces" | "aces2065-1" => Some((Transfer::Linear, AP0)),
        "adobergb" => Some((Transfer::Gamma(563.0 / 256.0), ADOBE)),
        _ => name.strip_prefix("gamma").and_then(gamma).map(|transfer| (transfer, REC_709)),
    };
    let parts = || {
        let mut parts = name.split('_');
        let transfer = match parts.next()? {
            "lin" => Transfer::Linear,
            "srgb" => Transfer::Srgb,
            "g18" => Transfer::Gamma(1.8),
            "g22" => Transfer::Gamma(2.2),
            "g24" => Transfer::Gamma(2.4),
            _ => return None,
        };
        let primaries = match parts.next()? {
            "rec709" => REC_709,
            "ap0" => AP0,
            "ap1" => AP1,
            "adobergb" => ADOBE,
            "p3d65" => P3,
            "rec2020" => REC_2020,
            _ => return None,
        };
        let ends = matches!(parts.next(), None | Some("scene" | "display")) && parts.next().is_none();
        ends.then_some((transfer, primaries))
    };
    whole.or_else(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transfer_functions_by_closed_forms() {
        // 18% grey is 117.65 of 255 in sRGB, 0.40901 in Rec. 709.
        assert!((Transfer::Srgb.linear(117.65 / 255.0) - 0.18).abs() < 2e-4);
        assert!((Transfer::Rec709.linear(0.40901) - 0.18).abs() < 2e-5);
        assert_eq!(Transfer::Gamma(2.0).linear(-0.5), -0.25);
        for transfer in [Transfer::Linear, Transfer::Srgb, Transfer::Rec709, Transfer::Gamma(2.2)] {
            assert_eq!((transfer.linear(0.0), transfer.linear(1.0)), (0.0, 1.0));
            assert!(transfer.linear(f32::NAN).is_nan());
        }
    }

    #[test]
    fn names_of_2_4_and_3() {
        for (names, space_of) in [
            (&["Linear", "lin_rec709", "lin_rec709_scene"][..], (Transfer::Linear, REC_709)),
            (&["sRGB", "srgb_rec709_scene", "srgb_rec709_display"], (Transfer::Srgb, REC_709)),
            (&["Gamma2.2", "g22_rec709_scene"], (Transfer::Gamma(2.2), REC_709)),
            (&["ACEScg", "lin_ap1_scene", "lin_ap1"], (Transfer::Linear, AP1)),
            (&["srgb_p3d65_display"], (Transfer::Srgb, P3)),
        ] {
            for name in names {
                assert_eq!(space(name, Numbers::Floating), Some(space_of), "{name}");
            }
        }
        assert_eq!(space("", Numbers::Floating), Some((Transfer::Linear, REC_709)));
        assert_eq!(space("", Numbers::Unsigned(8)), Some((Transfer::Srgb, REC_709)));
        assert_eq!(space("Rec709", Numbers::Unsigned(8)), Some((Transfer::Rec709, REC_709)));
        assert_eq!(space("Rec709", Numbers::Floating), Some((Transfer::Linear, REC_709)));
        for unknown in ["KodakLog", "GammaNaN", "Gamma-1", "lin_xyz", "lin_rec709_scene_more", "gamma"] {
            assert_eq!(space(unknown, Numbers::Floating), None, "{unknown}");
        }
    }
}
