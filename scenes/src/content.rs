//! Identity by content: what has the same bytes has the same hash and the same revision.

use std::fmt;

use glam::{Quat, Vec2, Vec3};
use sha2::{Digest, Sha256};

/// SHA-256 of a piece of content, printed as 64 lower-case hex digits.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Content([u8; 32]);

impl Content {
    /// Hash of bytes.
    pub fn of(bytes: &[u8]) -> Self {
        Content(Sha256::digest(bytes).into())
    }

    /// Hash of several parts in order; parts are length-prefixed, so `["ab", "c"]` differs from `["a", "bc"]`.
    pub fn of_parts<'a>(parts: impl IntoIterator<Item = &'a [u8]>) -> Self {
        let mut hasher = Sha256::new();
        for part in parts {
            hasher.update((part.len() as u64).to_le_bytes());
            hasher.update(part);
        }
        Content(hasher.finalize().into())
    }

    /// The first eight bytes as a revision number.
    pub fn revision(&self) -> Revision {
        Revision(u64::from_le_bytes(self.0[..8].try_into().expect("eight bytes")))
    }
}

impl fmt::Display for Content {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for Content {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Changes exactly when the content it stands for changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Revision(pub u64);

/// Collects values, bit by bit, into a [`Content`]. The tag keeps kinds of content apart; lists carry their length.
pub(crate) struct Collector(Vec<u8>);

impl Collector {
    pub(crate) fn new(tag: &str) -> Self {
        Collector(Vec::new()).word(tag.len()).bytes(tag.as_bytes())
    }

    pub(crate) fn bytes(mut self, bytes: &[u8]) -> Self {
        self.0.extend_from_slice(bytes);
        self
    }

    pub(crate) fn word(self, value: usize) -> Self {
        self.bytes(&(value as u64).to_le_bytes())
    }

    pub(crate) fn float(self, value: f32) -> Self {
        self.bytes(&value.to_bits().to_le_bytes())
    }

    pub(crate) fn floats(self, values: &[f32]) -> Self {
        values.iter().fold(self, |all, value| all.float(*value))
    }

    pub(crate) fn vec2(self, value: Vec2) -> Self {
        self.floats(&value.to_array())
    }

    pub(crate) fn vec3(self, value: Vec3) -> Self {
        self.floats(&value.to_array())
    }

    pub(crate) fn quat(self, value: Quat) -> Self {
        self.floats(&value.to_array())
    }

    pub(crate) fn content(self, value: Content) -> Self {
        self.bytes(&value.0)
    }

    /// A list: its length, then each element.
    pub(crate) fn list<T>(self, values: &[T], add: impl Fn(Self, &T) -> Self) -> Self {
        values.iter().fold(self.word(values.len()), add)
    }

    pub(crate) fn finish(self) -> Content {
        Content::of(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_digest() {
        // FIPS 180-2, appendix B.1.
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(Content::of(b"abc").to_string(), expected);
        assert_eq!(Content::of(b"abc").revision(), Revision(0xeacf_018f_bf16_78ba));
    }

    #[test]
    fn parts_and_lists_keep_their_borders() {
        assert_ne!(Content::of_parts([&b"ab"[..], b"c"]), Content::of_parts([&b"a"[..], b"bc"]));
        let lists =
            |a: &[f32], b: &[f32]| Collector::new("x").list(a, |c, v| c.float(*v)).list(b, |c, v| c.float(*v)).finish();
        assert_ne!(lists(&[1.0, 2.0], &[]), lists(&[1.0], &[2.0]));
        assert_ne!(Collector::new("a").finish(), Collector::new("b").finish());
    }
}
