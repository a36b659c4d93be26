//! The body: one number after the other.

use crate::SceneError;
use crate::check::Checker;

use super::header::{Encoding, Kind, Scalar};

/// Reads numbers off the body and complains where it ends too early.
pub(super) struct Values<'a> {
    check: Checker<'a>,
    encoding: Encoding,
    rest: &'a [u8],
}

impl<'a> Values<'a> {
    pub(super) fn new(check: Checker<'a>, encoding: Encoding, body: &'a [u8]) -> Self {
        Values { check, encoding, rest: body }
    }

    /// The next number; `place` says where it stands.
    pub(super) fn next(&mut self, scalar: Scalar, place: impl Fn() -> String) -> Result<f64, SceneError> {
        match self.encoding {
            Encoding::Ascii => {
                let word = self.word().ok_or_else(|| self.truncated(&place))?;
                let text = String::from_utf8_lossy(word);
                text.parse().map_err(|_| self.check.invalid(&place(), "a number", text))
            }
            _ => self.binary(scalar).ok_or_else(|| self.truncated(&place)),
        }
    }

    /// The next number as the length of a list.
    pub(super) fn length(&mut self, scalar: Scalar, place: impl Fn() -> String) -> Result<u32, SceneError> {
        let length = self.next(scalar, &place)?;
        let whole = length.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&length);
        if whole { Ok(length as u32) } else { Err(self.check.invalid(&place(), "a list length", length)) }
    }

    pub(super) fn skip(&mut self, kind: Kind, place: impl Fn() -> String) -> Result<(), SceneError> {
        match kind {
            Kind::Scalar(scalar) => self.next(scalar, place).map(drop),
            Kind::List { count, item } => {
                (0..self.length(count, &place)?).try_for_each(|_| self.next(item, &place).map(drop))
            }
        }
    }

    /// Complains about what is left: the header's counts are wrong then.
    pub(super) fn finish(mut self) -> Result<(), SceneError> {
        let left = match self.encoding {
            Encoding::Ascii => self.word().is_some(),
            _ => !self.rest.trim_ascii().is_empty(),
        };
        match left {
            true => Err(self.check.malformed("end of file", "expected no data beyond the elements of the header")),
            false => Ok(()),
        }
    }

    fn truncated(&self, place: impl Fn() -> String) -> SceneError {
        self.check.malformed("end of file", format!("expected {}: the file is truncated", place()))
    }

    fn word(&mut self) -> Option<&'a [u8]> {
        let text = self.rest.trim_ascii_start();
        let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
        let (word, rest) = text.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    fn binary(&mut self, scalar: Scalar) -> Option<f64> {
        Some(match scalar {
            Scalar::I8 => i8::from_le_bytes(self.bytes()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.bytes()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.bytes()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.bytes()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.bytes()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.bytes()?).into(),
            Scalar::F32 => f32::from_le_bytes(self.bytes()?).into(),
            Scalar::F64 => f64::from_le_bytes(self.bytes()?),
        })
    }

    /// The next `N` bytes, least significant first.
    fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (bytes, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        let mut bytes = *bytes;
        if self.encoding == Encoding::BigEndian {
            bytes.reverse();
        }
        Some(bytes)
    }
}
