//! Text formats: lines of words, with errors that name the line.

use std::str::FromStr;

use glam::Vec3;

use crate::SceneError;
use crate::check::Checker;

/// The text of a file: UTF-16 where it begins with that encoding's mark, else UTF-8 with or without its own.
pub(super) fn decoded(bytes: &[u8]) -> String {
    let wide = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
        String::from_utf16_lossy(&units)
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => wide(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => wide(rest, u16::from_be_bytes),
        [0xef, 0xbb, 0xbf, rest @ ..] | rest => String::from_utf8_lossy(rest).into_owned(),
    }
}

/// The words of a line, comment left out.
pub(super) struct Line<'a> {
    check: Checker<'a>,
    number: usize,
    pub(super) words: Vec<&'a str>,
}

/// The lines of a text that hold anything but a comment.
pub(super) fn lines<'a>(check: Checker<'a>, text: &'a str) -> impl Iterator<Item = Line<'a>> {
    let words = |line: &'a str| line.split('#').next().unwrap_or("").split_whitespace().collect::<Vec<_>>();
    let lines = text.lines().zip(1..).map(move |(line, number)| Line { check, number, words: words(line) });
    lines.filter(|line| !line.words.is_empty())
}

impl Line<'_> {
    /// The error that says what this line should have held.
    pub(super) fn expected(&self, expected: impl Into<String>) -> SceneError {
        self.check.invalid(&format!("line {}", self.number), expected, self.words.join(" "))
    }

    /// The word at `index` as a number.
    pub(super) fn number<T: FromStr>(&self, index: usize, expected: &str) -> Result<T, SceneError> {
        let word = self.words.get(index).ok_or_else(|| self.expected(expected))?;
        word.parse().map_err(|_| self.expected(expected))
    }

    /// Three numbers from `start` on.
    pub(super) fn vec3(&self, start: usize) -> Result<Vec3, SceneError> {
        let number = |offset| self.number(start + offset, "three numbers");
        Ok(Vec3::new(number(0)?, number(1)?, number(2)?))
    }
}

/// A convex polygon as a fan of triangles.
pub(super) fn fan<T: Copy>(polygon: &[T]) -> impl Iterator<Item = [T; 3]> + '_ {
    polygon.windows(2).skip(1).map(|pair| [polygon[0], pair[0], pair[1]])
}
