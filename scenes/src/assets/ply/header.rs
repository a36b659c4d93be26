//! The header: what elements the body holds, in which encoding.

use crate::SceneError;
use crate::check::Checker;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u32,
    pub(super) properties: Vec<Property>,
}

pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
}

impl Scalar {
    fn parse(name: &str) -> Option<Scalar> {
        Some(match name {
            "char" | "int8" => Scalar::I8,
            "uchar" | "uint8" => Scalar::U8,
            "short" | "int16" => Scalar::I16,
            "ushort" | "uint16" => Scalar::U16,
            "int" | "int32" => Scalar::I32,
            "uint" | "uint32" => Scalar::U32,
            "float" | "float32" => Scalar::F32,
            "double" | "float64" => Scalar::F64,
            _ => return None,
        })
    }
}

/// The header and the bytes after it.
pub(super) fn parse<'a>(check: Checker, bytes: &'a [u8]) -> Result<(Header, &'a [u8]), SceneError> {
    let mut rest = bytes;
    let mut number = 0;
    let mut next_line = || -> Result<(String, String), SceneError> {
        number += 1;
        let end = rest.iter().position(|byte| *byte == b'\n');
        let end = end.ok_or_else(|| check.malformed("end of file", "expected end_header: the file is truncated"))?;
        let line = String::from_utf8_lossy(&rest[..end]).trim().to_owned();
        rest = &rest[end + 1..];
        Ok((format!("line {number}"), line))
    };

    let (place, magic) = next_line()?;
    check.ensure(magic == "ply", &place, "ply", magic)?;
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        let (place, line) = next_line()?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let wrong = |expected: &str| check.invalid(&place, expected, &line);
        let scalar = |name: &str| Scalar::parse(name).ok_or_else(|| wrong("a number type such as float or int"));
        match words[..] {
            ["comment" | "obj_info", ..] | [] => {}
            ["format", name, "1.0"] => encoding = Some(parse_encoding(name).ok_or_else(|| wrong(FORMATS))?),
            ["element", name, count] => {
                let count = count.parse().map_err(|_| wrong("a count below 2^32"))?;
                elements.push(Element { name: name.into(), count, properties: Vec::new() });
            }
            ["property", ref kind @ .., name] => {
                let kind = match *kind {
                    ["list", count, item] => Kind::List { count: scalar(count)?, item: scalar(item)? },
                    [kind] => Kind::Scalar(scalar(kind)?),
                    _ => return Err(wrong("property TYPE NAME or property list TYPE TYPE NAME")),
                };
                let element = elements.last_mut().ok_or_else(|| wrong("an element before its properties"))?;
                element.properties.push(Property { name: name.into(), kind });
            }
            ["end_header"] => break,
            _ => return Err(wrong("format, element, property, comment or end_header")),
        }
    }
    let encoding = encoding.ok_or_else(|| check.malformed("header", format!("expected {FORMATS}")))?;
    for (index, element) in elements.iter().enumerate() {
        let unique = elements[..index].iter().all(|other| other.name != element.name);
        check.ensure(unique, "header", "element names that differ", &element.name)?;
        let empty = element.properties.is_empty();
        check.ensure(!empty, "header", "at least one property of each element", &element.name)?;
    }
    Ok((Header { encoding, elements }, rest))
}

const FORMATS: &str = "format ascii, binary_little_endian or binary_big_endian 1.0";

fn parse_encoding(name: &str) -> Option<Encoding> {
    match name {
        "ascii" => Some(Encoding::Ascii),
        "binary_little_endian" => Some(Encoding::LittleEndian),
        "binary_big_endian" => Some(Encoding::BigEndian),
        _ => None,
    }
}
