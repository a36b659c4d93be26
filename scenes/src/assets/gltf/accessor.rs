//! Numbers in buffers. Whatever an accessor claims, nothing beyond its view is read.

use gltf::Accessor;
use gltf::accessor::{DataType, Dimensions, sparse};
use gltf::buffer::View;

use super::File;
use crate::SceneError;

/// Most numbers of an accessor that no bytes back.
const MOST_ZEROS: usize = 1 << 26;

impl File<'_> {
    /// The elements of an accessor, `N` numbers each; integers that stand for fractions become these.
    pub(super) fn numbers<const N: usize>(&self, accessor: &Accessor) -> Result<Vec<[f64; N]>, SceneError> {
        let name = format!("accessors[{}]", accessor.index());
        let (components, kind) = (accessor.dimensions().multiplicity(), accessor.data_type());
        let padded = matches!(accessor.dimensions(), Dimensions::Mat2 | Dimensions::Mat3) && kind.size() < 4;
        if components != N || padded {
            return Err(self.check.invalid(&name, format!("elements of {N} numbers"), accessor.dimensions()));
        }
        let scale = if accessor.normalized() { fraction(kind) } else { 1.0 };
        let element = |bytes: &[u8]| -> [f64; N] {
            std::array::from_fn(|i| (number(&bytes[i * kind.size()..], kind) * scale).max(floor(accessor, kind)))
        };
        let mut values: Vec<[f64; N]> = match accessor.view() {
            Some(view) => {
                let stride = view.stride().unwrap_or(N * kind.size());
                let range = Range { offset: accessor.offset(), count: accessor.count(), stride, size: N * kind.size() };
                self.elements(&name, &view, range)?.map(element).collect()
            }
            None if accessor.count() <= MOST_ZEROS => vec![[0.0; N]; accessor.count()],
            None => return Err(self.check.invalid(&name, format!("at most {MOST_ZEROS} zeros"), accessor.count())),
        };
        if let Some(sparse) = accessor.sparse() {
            self.replace(&name, &sparse, N * kind.size(), element, &mut values)?;
        }
        match values.iter().position(|value| value.iter().any(|v| !v.is_finite())) {
            None => Ok(values),
            Some(index) => {
                Err(self.check.invalid(&format!("{name}, element {index}"), "finite numbers", values[index]))
            }
        }
    }

    fn replace<const N: usize>(
        &self,
        name: &str,
        sparse: &sparse::Sparse,
        size: usize,
        element: impl Fn(&[u8]) -> [f64; N],
        values: &mut [[f64; N]],
    ) -> Result<(), SceneError> {
        let (indices, replaced) = (sparse.indices(), sparse.values());
        let (index_size, kind) = match indices.index_type() {
            sparse::IndexType::U8 => (1, DataType::U8),
            sparse::IndexType::U16 => (2, DataType::U16),
            sparse::IndexType::U32 => (4, DataType::U32),
        };
        let range = |offset, size| Range { offset, count: sparse.count(), stride: size, size };
        let at = self.elements(name, &indices.view(), range(indices.offset(), index_size))?;
        let with = self.elements(name, &replaced.view(), range(replaced.offset(), size))?;
        for (at, with) in at.zip(with) {
            let index = number(at, kind) as usize;
            let most = values.len();
            let value = values.get_mut(index);
            *value.ok_or_else(|| self.check.invalid(name, format!("sparse indices below {most}"), index))? =
                element(with);
        }
        Ok(())
    }

    fn elements<'b>(
        &'b self,
        name: &str,
        view: &View,
        range: Range,
    ) -> Result<impl Iterator<Item = &'b [u8]> + use<'b>, SceneError> {
        let bytes = self.buffers.view(self.check, view)?;
        let Range { offset, count, stride, size } = range;
        let end =
            count.checked_sub(1).and_then(|last| last.checked_mul(stride)?.checked_add(size)?.checked_add(offset));
        let fits = end.is_some_and(|end| end <= bytes.len()) && stride >= size;
        if !fits {
            let expected = format!("1 or more elements of {size} bytes within its view's {}", bytes.len());
            return Err(self.check.invalid(name, expected, format!("{count} from byte {offset}, {stride} apart")));
        }
        Ok((0..count).map(move |i| &bytes[offset + i * stride..][..size]))
    }
}

struct Range {
    offset: usize,
    count: usize,
    stride: usize,
    size: usize,
}

/// The first number of some bytes, which hold at least one.
fn number(bytes: &[u8], kind: DataType) -> f64 {
    match kind {
        DataType::I8 => f64::from(bytes[0] as i8),
        DataType::U8 => f64::from(bytes[0]),
        DataType::I16 => f64::from(i16::from_le_bytes([bytes[0], bytes[1]])),
        DataType::U16 => f64::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        DataType::U32 => f64::from(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
        DataType::F32 => f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
    }
}

/// What one is worth of integers that stand for fractions (glTF 2.0, 3.6.2.2).
fn fraction(kind: DataType) -> f64 {
    match kind {
        DataType::I8 => 1.0 / 127.0,
        DataType::U8 => 1.0 / 255.0,
        DataType::I16 => 1.0 / 32767.0,
        DataType::U16 => 1.0 / 65535.0,
        DataType::U32 | DataType::F32 => 1.0,
    }
}

/// Signed fractions go down to −1, though there is one integer below.
fn floor(accessor: &Accessor, kind: DataType) -> f64 {
    let signed = accessor.normalized() && matches!(kind, DataType::I8 | DataType::I16);
    if signed { -1.0 } else { f64::NEG_INFINITY }
}
