//! Object File Format (Geomview): `OFF`, counts, vertices, faces; colours are ignored.

use crate::check::Checker;
use crate::{Mesh, SceneError};

use super::text::{Line, decoded, fan, lines};

pub(super) fn read(check: Checker, bytes: &[u8]) -> Result<Mesh, SceneError> {
    let text = decoded(bytes);
    let mut lines = lines(check, &text);
    let mut next = |what: String| {
        let end = || check.malformed("end of file", format!("expected {what}: the file is truncated"));
        lines.next().ok_or_else(end)
    };
    let header = next("OFF".into())?;
    if !["OFF", "COFF"].contains(&header.words[0]) {
        return Err(header.expected("OFF or COFF"));
    }
    let (counts, start) = match header.words.len() {
        1 => (next("the counts of vertices and faces".into())?, 0),
        _ => (header, 1),
    };
    let count = |index: usize| counts.number::<u32>(start + index, "counts of vertices, faces and edges");
    let (vertices, faces) = (count(0)?, count(1)?);

    let mut mesh = Mesh::default();
    for vertex in 0..vertices {
        mesh.positions.push(next(format!("vertex {vertex} of {vertices}"))?.vec3(0)?);
    }
    for face in 0..faces {
        mesh.triangles.extend(fan(&corners(&next(format!("face {face} of {faces}"))?)?));
    }
    match lines.next() {
        Some(line) => Err(line.expected("the end of the file")),
        None => Ok(mesh),
    }
}

fn corners(line: &Line) -> Result<Vec<u32>, SceneError> {
    let expected = "a count of at least 3 and as many vertex indices";
    let count: usize = line.number(0, expected)?;
    if !(3..line.words.len()).contains(&count) {
        return Err(line.expected(expected));
    }
    (1..=count).map(|index| line.number(index, expected)).collect()
}
