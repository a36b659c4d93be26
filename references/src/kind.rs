//! The kinds of reference and their ids.

use std::fmt;
use std::str::FromStr;

use halflight_proxies::{DEFAULT_COUNT, MAX_COUNT, SelfShadow};

/// What light is held against, for direct light at receivers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// The scene itself: real meshes and exact spheres of the objects that cast shadows, the full lights.
    Truth,
    /// The same geometry; the light is the sum of all lights in spherical harmonics, unclamped (it may be negative).
    ShLight {
        /// SH order `n` in `1..=8`.
        order: usize,
    },
    /// The same light; each mesh that casts shadows is replaced by its set of bounding spheres. Receivers lie inside their
    /// own spheres, so the spheres are seen under the methods' self-shadow rule (Ren 2006, §6.2).
    SphereProxies {
        /// Spheres a mesh, at least 1.
        count: usize,
        /// Self-shadow rule.
        rule: SelfShadow,
    },
}

/// A kind of reference, for listings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// How its ids are written, with capitals for numbers.
    pub id: &'static str,
    /// One line: what it is.
    pub about: &'static str,
}

/// An id that names no reference.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[error("reference `{id}`: expected truth, sh-light:ORDER (1 to 8) or sphere-proxies:COUNT[:continuous|paper|off]")]
pub struct ParseError {
    /// What was given.
    pub id: String,
}

const TRUTH: &str = "truth";
const SH_LIGHT: &str = "sh-light";
const SPHERE_PROXIES: &str = "sphere-proxies";

impl Reference {
    /// The reference that an id names: `truth`, `sh-light:4`, `sphere-proxies:64`, `sphere-proxies:64:paper`. Left out, the
    /// order is 4, the count 32 and the rule `continuous`, as for methods.
    ///
    /// # Errors
    /// The id names no reference, an order outside `1..=8` or a count outside `1..=1024`.
    pub fn parse(id: &str) -> Result<Self, ParseError> {
        Self::read(id).ok_or_else(|| ParseError { id: id.to_owned() })
    }

    fn read(id: &str) -> Option<Self> {
        let mut words = id.split(':');
        let reference = match words.next()? {
            TRUTH => Reference::Truth,
            SH_LIGHT => Reference::ShLight { order: number(words.next(), 4, halflight_sh::MAX_ORDER)? },
            SPHERE_PROXIES => Reference::SphereProxies {
                count: number(words.next(), DEFAULT_COUNT, MAX_COUNT)?,
                rule: match words.next() {
                    None => SelfShadow::default(),
                    Some(word) => SelfShadow::named(word)?,
                },
            },
            _ => return None,
        };
        words.next().is_none().then_some(reference)
    }

    /// The shortest id that names this reference.
    pub fn id(&self) -> String {
        match self {
            Reference::Truth => TRUTH.to_owned(),
            Reference::ShLight { order } => format!("{SH_LIGHT}:{order}"),
            Reference::SphereProxies { count, rule } if *rule == SelfShadow::default() => {
                format!("{SPHERE_PROXIES}:{count}")
            }
            Reference::SphereProxies { count, rule } => format!("{SPHERE_PROXIES}:{count}:{}", rule.name()),
        }
    }

    /// One line: what it is.
    pub fn about(&self) -> &'static str {
        let [truth, sh_light, sphere_proxies] = Self::all();
        match self {
            Reference::Truth => truth.about,
            Reference::ShLight { .. } => sh_light.about,
            Reference::SphereProxies { .. } => sphere_proxies.about,
        }
    }

    /// Every kind.
    pub fn all() -> [Kind; 3] {
        [
            Kind { id: TRUTH, about: "the ray-traced scene itself: real meshes, the full light" },
            Kind { id: "sh-light:ORDER", about: "truth's geometry under the light in spherical harmonics of an order" },
            Kind {
                id: "sphere-proxies:COUNT[:RULE]",
                about: "truth's light; each mesh replaced by its bounding spheres, under the self-shadow rule",
            },
        ]
    }
}

impl fmt::Display for Reference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.id())
    }
}

impl FromStr for Reference {
    type Err = ParseError;

    fn from_str(id: &str) -> Result<Self, ParseError> {
        Self::parse(id)
    }
}

/// A number in `1..=max`, or the default if it is left out.
fn number(word: Option<&str>, default: usize, max: usize) -> Option<usize> {
    match word {
        None => Some(default),
        Some(word) => word.parse().ok().filter(|value| (1..=max).contains(value)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_read_back() {
        for id in
            ["truth", "sh-light:1", "sh-light:8", "sphere-proxies:64", "sphere-proxies:7:paper", "sphere-proxies:1:off"]
        {
            assert_eq!(Reference::parse(id).expect(id).id(), id);
        }
        assert_eq!(Reference::parse("sh-light").expect("default").id(), "sh-light:4");
        assert_eq!(Reference::parse("sphere-proxies:9:continuous").expect("default").id(), "sphere-proxies:9");
    }

    #[test]
    fn what_is_no_reference_is_refused() {
        for id in [
            "",
            "Truth",
            "truth:1",
            "sh-light:",
            "sh-light:0",
            "sh-light:9",
            "sh-light:4:1",
            "sh-light:-1",
            "sh-light:+x",
            "sphere-proxies:0",
            "sphere-proxies:1025",
            "sphere-proxies:8:best",
            "sphere-proxies:8:paper:",
            "shexp/hyb",
        ] {
            let error = Reference::parse(id).expect_err(id);
            assert!(error.to_string().contains(&format!("`{id}`")), "{error}");
        }
    }

    #[test]
    fn every_kind_has_its_line() {
        for (id, kind) in ["truth", "sh-light", "sphere-proxies"].iter().zip(Reference::all()) {
            assert!(kind.id.starts_with(id));
            assert_eq!(Reference::parse(id).expect(id).about(), kind.about);
        }
    }
}
