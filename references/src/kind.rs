//! The kinds of reference and their ids.

use std::fmt;
use std::str::FromStr;

use halflight_contract::Quantity;
use halflight_proxies::{DEFAULT_COUNT, MAX_COUNT, SelfShadow};
use halflight_scenes::Scene;

/// One thing that a reference does otherwise than the scene has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// The distant light is the sum of all distant lights in spherical harmonics, unclamped (it may be negative).
    ShLight {
        /// SH order `n` in `1..=8`.
        order: usize,
    },
    /// Each mesh that casts shadows is replaced by its set of bounding spheres. Receivers lie inside their own spheres, so the
    /// spheres are seen under the methods' self-shadow rule (Ren 2006, §6.2).
    SphereProxies {
        /// Spheres a mesh, `1..=1024`.
        count: usize,
        /// Self-shadow rule.
        rule: SelfShadow,
    },
    /// The visibility of the distance is replaced by its projection into spherical harmonics, unclamped.
    ShVisibility {
        /// SH order `n` in `1..=8`.
        order: usize,
    },
    /// Each source's unoccluded light is multiplied by the share of the source that is visible (Soler and Sillion 1998): of
    /// an emitting object by area, of a key light by solid angle.
    MeanVisibility,
    /// No light comes from below the horizontal plane, as methods for height fields have it.
    UpperSky,
    /// Light that was reflected reaches receivers through whatever is between; fronts alone reflect it towards them.
    UnoccludedIndirect,
    /// These objects emit and reflect nothing; they block as before.
    Without {
        /// Names of objects, sorted.
        objects: Vec<String>,
    },
}

/// What light is held against: the ray-traced scene itself, [`Reference::TRUTH`], or with some things changed, each of
/// which is one approximation that methods make.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reference {
    /// At most one of each kind, in the order of [`Change`].
    changes: Vec<Change>,
}

/// A kind of reference, for listings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// How its ids are written, with capitals for what varies.
    pub id: &'static str,
    /// One line: what it is.
    pub about: &'static str,
}

/// An id that names no reference.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "reference `{id}`: expected truth, or one or several, joined by `+`, of sh-light:ORDER (1 to 8), \
     sphere-proxies:COUNT[:continuous|paper|off], sh-visibility:ORDER, mean-visibility, upper-sky, unoccluded-indirect and \
     without:OBJECT[,OBJECT…]"
)]
pub struct ParseError {
    /// What was given.
    pub id: String,
}

const TRUTH: &str = "truth";

impl Reference {
    /// The scene itself: real meshes and exact spheres of the objects that cast shadows, the full lights.
    pub const TRUTH: Reference = Reference { changes: Vec::new() };

    /// The scene with these changes; of several of one kind the first.
    pub fn with(changes: impl IntoIterator<Item = Change>) -> Self {
        let mut changes: Vec<Change> = changes.into_iter().collect();
        changes.sort_by_key(Change::rank);
        changes.dedup_by_key(|change| change.rank());
        Reference { changes }
    }

    /// What is changed; nothing in the truth.
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// The reference that an id names: `truth`, `sh-light:4`, `sphere-proxies:64:paper`, `sh-light:4+sphere-proxies:64`. Left
    /// out, an order is 4, the count 32 and the rule `continuous`, as for methods.
    ///
    /// # Errors
    /// The id names no reference, the same kind twice, an order outside `1..=8` or a count outside `1..=1024`.
    pub fn parse(id: &str) -> Result<Self, ParseError> {
        Self::read(id).ok_or_else(|| ParseError { id: id.to_owned() })
    }

    fn read(id: &str) -> Option<Self> {
        if id == TRUTH {
            return Some(Reference::TRUTH);
        }
        let changes: Vec<Change> = id.split('+').map(Change::read).collect::<Option<_>>()?;
        let given = changes.len();
        let reference = Reference::with(changes);
        (reference.changes.len() == given).then_some(reference)
    }

    /// The shortest id that names this reference.
    pub fn id(&self) -> String {
        match &*self.changes {
            [] => TRUTH.to_owned(),
            changes => changes.iter().map(Change::id).collect::<Vec<_>>().join("+"),
        }
    }

    /// One line: what it is.
    pub fn about(&self) -> String {
        match &*self.changes {
            [] => KINDS[0].about.to_owned(),
            changes => changes.iter().map(|change| change.kind().about).collect::<Vec<_>>().join("; "),
        }
    }

    /// Every kind: the truth, then what can be changed.
    pub fn all() -> [Kind; 8] {
        KINDS
    }

    /// Whether there is such a reference of a quantity in a scene; the reason if there is not.
    ///
    /// # Errors
    /// A change that does not concern the quantity, or that the scene has nothing for.
    pub fn serves(&self, quantity: Quantity, scene: &Scene) -> Result<(), String> {
        self.changes.iter().try_for_each(|change| change.serves(quantity, scene))?;
        let shadows = [self.sh_visibility().is_some(), self.mean_visibility()];
        if shadows == [true, true] {
            return Err("mean-visibility and sh-visibility both replace the visibility, expected one of them".into());
        }
        Ok(())
    }

    pub(crate) fn sh_light(&self) -> Option<usize> {
        self.find(|change| if let Change::ShLight { order } = change { Some(*order) } else { None })
    }

    pub(crate) fn sphere_proxies(&self) -> Option<(usize, SelfShadow)> {
        self.find(|change| match change {
            Change::SphereProxies { count, rule } => Some((*count, *rule)),
            _ => None,
        })
    }

    pub(crate) fn sh_visibility(&self) -> Option<usize> {
        self.find(|change| if let Change::ShVisibility { order } = change { Some(*order) } else { None })
    }

    pub(crate) fn mean_visibility(&self) -> bool {
        self.changes.contains(&Change::MeanVisibility)
    }

    pub(crate) fn upper_sky(&self) -> bool {
        self.changes.contains(&Change::UpperSky)
    }

    pub(crate) fn unoccluded_indirect(&self) -> bool {
        self.changes.contains(&Change::UnoccludedIndirect)
    }

    /// Whether an object's light is left out.
    pub(crate) fn leaves_out(&self, name: &str) -> bool {
        let named = |change: &Change| match change {
            Change::Without { objects } => objects.iter().any(|object| object == name),
            _ => false,
        };
        self.changes.iter().any(named)
    }

    fn find<T>(&self, of: impl Fn(&Change) -> Option<T>) -> Option<T> {
        self.changes.iter().find_map(of)
    }
}

const KINDS: [Kind; 8] = [
    Kind { id: TRUTH, about: "the ray-traced scene itself: real meshes, the full light" },
    Kind { id: "sh-light:ORDER", about: "distant light in spherical harmonics of an order" },
    Kind {
        id: "sphere-proxies:COUNT[:RULE]",
        about: "each mesh replaced by its bounding spheres, under the self-shadow rule",
    },
    Kind { id: "sh-visibility:ORDER", about: "exact visibility, projected into spherical harmonics of an order" },
    Kind {
        id: "mean-visibility",
        about: "each source's unoccluded light times the share of the source that is visible",
    },
    Kind { id: "upper-sky", about: "no light from below the horizontal plane" },
    Kind { id: "unoccluded-indirect", about: "reflected light passes through whatever is between" },
    Kind { id: "without:OBJECT[,OBJECT…]", about: "these objects emit and reflect nothing" },
];

impl Change {
    /// Its place among the kinds.
    fn rank(&self) -> usize {
        match self {
            Change::ShLight { .. } => 1,
            Change::SphereProxies { .. } => 2,
            Change::ShVisibility { .. } => 3,
            Change::MeanVisibility => 4,
            Change::UpperSky => 5,
            Change::UnoccludedIndirect => 6,
            Change::Without { .. } => 7,
        }
    }

    /// Its kind, for listings.
    pub fn kind(&self) -> Kind {
        KINDS[self.rank()]
    }

    /// Its name without what varies: `sh-light`.
    pub fn name(&self) -> &'static str {
        let id = self.kind().id;
        id.split(':').next().unwrap_or(id)
    }

    /// Its part of an id.
    pub fn id(&self) -> String {
        let name = self.name();
        match self {
            Change::ShLight { order } | Change::ShVisibility { order } => format!("{name}:{order}"),
            Change::SphereProxies { count, rule } if *rule == SelfShadow::default() => format!("{name}:{count}"),
            Change::SphereProxies { count, rule } => format!("{name}:{count}:{}", rule.name()),
            Change::Without { objects } => format!("{name}:{}", objects.join(",")),
            Change::MeanVisibility | Change::UpperSky | Change::UnoccludedIndirect => name.to_owned(),
        }
    }

    fn read(id: &str) -> Option<Self> {
        let mut words = id.split(':');
        let change = match words.next()? {
            "sh-light" => Change::ShLight { order: number(words.next(), 4, halflight_sh::MAX_ORDER)? },
            "sphere-proxies" => Change::SphereProxies {
                count: number(words.next(), DEFAULT_COUNT, MAX_COUNT)?,
                rule: match words.next() {
                    None => SelfShadow::default(),
                    Some(word) => SelfShadow::named(word)?,
                },
            },
            "sh-visibility" => Change::ShVisibility { order: number(words.next(), 4, halflight_sh::MAX_ORDER)? },
            "mean-visibility" => Change::MeanVisibility,
            "upper-sky" => Change::UpperSky,
            "unoccluded-indirect" => Change::UnoccludedIndirect,
            "without" => Change::Without { objects: names(words.next()?)? },
            _ => return None,
        };
        words.next().is_none().then_some(change)
    }

    fn serves(&self, quantity: Quantity, scene: &Scene) -> Result<(), String> {
        let refuse = |why: String| Err(format!("{}: {why}", self.id()));
        let facts = scene.facts();
        let [direct, indirect] = match quantity {
            Quantity::Direct => [true, false],
            Quantity::Indirect { .. } => [false, true],
            Quantity::Total => [true, true],
            Quantity::Visibility { .. } => [false, false],
        };
        match self {
            Change::ShLight { .. } if !(direct || indirect) => refuse("visibility knows no light".into()),
            Change::ShLight { .. } if facts.distant_lights() == 0 => refuse("the scene has no distant light".into()),
            Change::SphereProxies { .. } if indirect => refuse("spheres reflect nothing, expected direct light".into()),
            Change::SphereProxies { .. } if facts.emitters > 0 => {
                refuse("spheres may enclose an emitting object, expected distant light alone".into())
            }
            Change::ShVisibility { .. } if quantity != Quantity::Direct || facts.emitters > 0 => {
                refuse("expected direct and distant light alone".into())
            }
            Change::MeanVisibility if quantity != Quantity::Direct || facts.environments + facts.skies > 0 => {
                refuse("expected direct light of emitting objects and key lights alone".into())
            }
            Change::UnoccludedIndirect if !indirect => refuse("expected indirect light".into()),
            Change::Without { .. } if !(direct || indirect) => refuse("visibility knows no light".into()),
            Change::Without { objects } => match objects.iter().find(|name| !has(scene, name)) {
                Some(name) => refuse(format!("the scene has no object `{name}`")),
                None => Ok(()),
            },
            _ => Ok(()),
        }
    }
}

fn has(scene: &Scene, name: &str) -> bool {
    scene.objects.iter().any(|object| object.name == name)
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

/// Names, sorted, each once.
fn names(word: &str) -> Option<Vec<String>> {
    let mut names: Vec<String> = word.split(',').map(str::to_owned).collect();
    names.sort();
    names.dedup();
    names.iter().all(|name| !name.is_empty()).then_some(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_read_back() {
        for id in [
            "truth",
            "sh-light:1",
            "sh-light:8",
            "sphere-proxies:64",
            "sphere-proxies:7:paper",
            "sphere-proxies:1:off",
            "sh-visibility:3",
            "mean-visibility",
            "upper-sky",
            "unoccluded-indirect",
            "without:ground,walls",
            "sh-light:4+sphere-proxies:9+sh-visibility:4",
            "upper-sky+without:a",
        ] {
            assert_eq!(Reference::parse(id).expect(id).id(), id);
        }
        assert_eq!(Reference::parse("sh-light").expect("default").id(), "sh-light:4");
        assert_eq!(Reference::parse("sphere-proxies:9:continuous").expect("default").id(), "sphere-proxies:9");
        assert_eq!(Reference::parse("upper-sky+sh-light:2").expect("any order").id(), "sh-light:2+upper-sky");
        assert_eq!(Reference::parse("without:b,a,b").expect("any order").id(), "without:a,b");
    }

    #[test]
    fn what_is_no_reference_is_refused() {
        for id in [
            "",
            "Truth",
            "truth:1",
            "truth+sh-light:4",
            "sh-light:",
            "sh-light:0",
            "sh-light:9",
            "sh-light:4:1",
            "sh-light:-1",
            "sh-light:+x",
            "sh-light:4+",
            "sh-light:4+sh-light:5",
            "sphere-proxies:0",
            "sphere-proxies:1025",
            "sphere-proxies:8:best",
            "sphere-proxies:8:paper:",
            "upper-sky:1",
            "without",
            "without:",
            "without:a,,b",
            "shexp/hyb",
        ] {
            let error = Reference::parse(id).expect_err(id);
            assert!(error.to_string().contains(&format!("`{id}`")), "{error}");
        }
    }

    #[test]
    fn every_kind_has_its_line() {
        let ids =
            ["sh-light", "sphere-proxies", "sh-visibility", "mean-visibility", "upper-sky", "unoccluded-indirect"];
        assert_eq!(Reference::TRUTH.about(), Reference::all()[0].about);
        for (id, kind) in ids.iter().zip(&Reference::all()[1..]) {
            assert!(kind.id.starts_with(id));
            assert_eq!(Reference::parse(id).expect(id).about(), kind.about);
        }
        let both = Reference::parse("sh-light+upper-sky").expect("two").about();
        assert!(both.contains("harmonics") && both.contains("below"), "{both}");
    }
}
