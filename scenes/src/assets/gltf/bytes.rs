//! The bytes of a document: in the file, beside it, or written into it as text.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf::Document;
use gltf::buffer::{Source, View};

use crate::SceneError;
use crate::assets::{Asset, Assets};
use crate::check::Checker;

/// All buffers of a document.
pub(super) struct Buffers(Vec<Vec<u8>>);

impl Buffers {
    pub(super) fn load(asset: &Asset, document: &Document, mut blob: Option<Vec<u8>>) -> Result<Self, SceneError> {
        let check = asset.check();
        let mut all = Vec::new();
        for buffer in document.buffers() {
            let field = format!("buffers[{}]", buffer.index());
            let bytes = match buffer.source() {
                Source::Bin => {
                    blob.take().ok_or_else(|| check.invalid(&field, "a binary chunk in the file", "none"))?
                }
                Source::Uri(uri) => fetch(asset, &field, uri)?,
            };
            if bytes.len() < buffer.length() {
                return Err(check.invalid(&field, format!("{} bytes", buffer.length()), bytes.len()));
            }
            all.push(bytes);
        }
        Ok(Buffers(all))
    }

    /// The bytes of a view.
    pub(super) fn view(&self, check: Checker, view: &View) -> Result<&[u8], SceneError> {
        let buffer = &self.0[view.buffer().index()];
        let end = view.offset().checked_add(view.length());
        end.and_then(|end| buffer.get(view.offset()..end)).ok_or_else(|| {
            let field = format!("bufferViews[{}]", view.index());
            check.invalid(
                &field,
                format!("a range of its buffer's {} bytes", buffer.len()),
                (view.offset(), view.length()),
            )
        })
    }
}

/// What a document points at: a `data:` address or a file in its folder or below.
pub(super) fn fetch(asset: &Asset, field: &str, uri: &str) -> Result<Vec<u8>, SceneError> {
    let check = asset.check();
    if let Some(data) = uri.strip_prefix("data:") {
        let text = data.split_once(";base64,").map(|(_, text)| text);
        let decoded = text.and_then(|text| STANDARD.decode(text).ok());
        return decoded.ok_or_else(|| check.invalid(field, "data in base 64", shortened(uri)));
    }
    Ok(beside(asset, field, uri)?.bytes)
}

/// A file in the document's folder or below.
pub(super) fn beside(asset: &Asset, field: &str, uri: &str) -> Result<Asset, SceneError> {
    Assets::beside(&asset.path).read(field, &unescaped(uri), None)
}

fn shortened(uri: &str) -> String {
    uri.chars().take(40).collect()
}

/// `%20` and its like become the bytes that they stand for.
pub(super) fn unescaped(uri: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = uri.as_bytes();
    while let Some((first, tail)) = rest.split_first() {
        let coded =
            tail.get(..2).and_then(|two| str::from_utf8(two).ok()).and_then(|two| u8::from_str_radix(two, 16).ok());
        match (first, coded) {
            (b'%', Some(byte)) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            _ => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unescaped() {
        assert_eq!(unescaped("a%20b%2Fc%zz%4"), "a b/c%zz%4");
    }
}
