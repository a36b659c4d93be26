//! Keys: sha-256 in hex, of canonical JSON or of bytes.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fmt::{self, Write};

/// The sha-256 of something, as 64 lower-case hex digits: it names a cell, a reference, or the content of an image.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Key(String);

/// A text that is not a key.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("key `{0}`: expected 64 lower-case hexadecimal digits")]
pub struct KeyError(String);

impl Key {
    /// The key of a value: the hash of its canonical JSON (object fields sorted by name at every level, no white space),
    /// so that neither the order of declaration nor that of a map's iteration matters.
    ///
    /// # Errors
    /// The value has no JSON form (for instance a map whose keys are not strings).
    pub fn of<T: Serialize + ?Sized>(value: &T) -> Result<Self, serde_json::Error> {
        let mut text = String::new();
        canonical(&serde_json::to_value(value)?, &mut text);
        Ok(Self::of_bytes(text.as_bytes()))
    }

    /// The hash of these bytes, as `sha256sum` prints it.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        let mut hex = String::with_capacity(64);
        for byte in Sha256::digest(bytes) {
            write!(hex, "{byte:02x}").expect("writing to a string cannot fail");
        }
        Self(hex)
    }

    /// All 64 digits.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The first 12 digits, enough for people.
    pub fn short(&self) -> &str {
        &self.0[..12]
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl TryFrom<String> for Key {
    type Error = KeyError;

    // Keys become file names: nothing but hex digits may pass.
    fn try_from(text: String) -> Result<Self, KeyError> {
        let hex = |b: u8| b.is_ascii_digit() || (b'a'..=b'f').contains(&b);
        if text.len() == 64 && text.bytes().all(hex) { Ok(Self(text)) } else { Err(KeyError(text)) }
    }
}

impl From<Key> for String {
    fn from(key: Key) -> String {
        key.0
    }
}

// Sorted by hand: whether `serde_json::Map` sorts depends on a feature that any crate of the build may switch on.
fn canonical(value: &Value, out: &mut String) {
    match value {
        Value::Object(map) => {
            let mut fields: Vec<_> = map.iter().collect();
            fields.sort_by_key(|(name, _)| name.as_str());
            out.push('{');
            for (i, (name, value)) in fields.into_iter().enumerate() {
                if i > 0 {
                    out.push(',');
                }
                write!(out, "{}:", Value::from(name.as_str())).expect("writing to a string cannot fail");
                canonical(value, out);
            }
            out.push('}');
        }
        Value::Array(values) => {
            out.push('[');
            for (i, value) in values.iter().enumerate() {
                if i > 0 {
                    out.push(',');
                }
                canonical(value, out);
            }
            out.push(']');
        }
        scalar => write!(out, "{scalar}").expect("writing to a string cannot fail"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::collections::HashMap;

    #[test]
    fn of_bytes_is_sha256() {
        // FIPS 180-2, appendix B.1.
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(Key::of_bytes(b"abc").as_str(), expected);
        assert_eq!(Key::of_bytes(b"abc").short(), "ba7816bf8f01");
    }

    #[test]
    fn of_hashes_canonical_json() {
        let map: HashMap<&str, Value> =
            [("b", json!(2)), ("a", json!({"z": [1, null], "y": "\""})), ("c", json!(0.5))].into();
        assert_eq!(Key::of(&map).unwrap(), Key::of_bytes(br#"{"a":{"y":"\"","z":[1,null]},"b":2,"c":0.5}"#));
    }

    #[test]
    fn only_hex_is_a_key() {
        let good = Key::of_bytes(b"").to_string();
        assert!(Key::try_from(good.clone()).is_ok());
        for bad in ["", "../../etc/passwd", &good.to_uppercase(), &good[1..], &format!("{}/", &good[1..])] {
            assert!(Key::try_from(bad.to_owned()).is_err(), "{bad}");
        }
    }
}
