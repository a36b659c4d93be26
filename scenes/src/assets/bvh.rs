//! Biovision hierarchies: a skeleton and captured motion.
//!
//! A joint stands at its offset, plus its position channels, in its parent's space; its rotation is the product of its rotation
//! channels in the order in which they are listed, in degrees.

use glam::{DQuat, DVec3};

use crate::SceneError;
use crate::animation::{Clip, Interpolation, Joint, Keys, Track, Transform};
use crate::check::{Checker, FAR};

const MOST_JOINTS: usize = 1 << 12;
const MOST_FRAMES: usize = 1 << 20;
const MOST_VALUES: usize = 1 << 26;

/// A skeleton, where its limbs end, and its motion.
#[derive(Debug)]
pub(crate) struct Capture {
    /// In the file's order: parents before children.
    pub(crate) joints: Vec<Joint>,
    pub(crate) names: Vec<String>,
    /// Joints that end a limb, and the offset of its tip.
    pub(crate) tips: Vec<(usize, DVec3)>,
    pub(crate) clip: Clip,
}

#[derive(Clone, Copy)]
enum Channel {
    Position(DVec3),
    Rotation(DVec3),
}

#[derive(Default)]
struct Hierarchy {
    joints: Vec<Joint>,
    names: Vec<String>,
    tips: Vec<(usize, DVec3)>,
    channels: Vec<Vec<Channel>>,
}

/// What an open brace belongs to.
#[derive(Clone, Copy)]
enum Open {
    Joint(usize),
    Tip,
}

pub(super) fn read(check: Checker, bytes: &[u8]) -> Result<Capture, SceneError> {
    let text = String::from_utf8_lossy(bytes);
    let mut words = Words::new(check, &text);
    words.keyword("HIERARCHY")?;
    let hierarchy = hierarchy(&mut words)?;
    let clip = motion(&mut words, &hierarchy)?;
    words.end()?;
    let Hierarchy { joints, names, tips, .. } = hierarchy;
    Ok(Capture { joints, names, tips, clip })
}

/// Joints until `MOTION`. A stack, not recursion: files nest as deep as they like.
fn hierarchy(words: &mut Words) -> Result<Hierarchy, SceneError> {
    let mut all = Hierarchy::default();
    let mut open: Vec<Open> = Vec::new();
    loop {
        let word = words.next("a joint, or MOTION")?;
        match (word, open.last().copied()) {
            ("MOTION", None) if !all.joints.is_empty() => return Ok(all),
            ("ROOT", None) if all.joints.is_empty() => open.push(all.begin(words, None)?),
            ("JOINT", Some(Open::Joint(parent))) => open.push(all.begin(words, Some(parent))?),
            ("End", Some(Open::Joint(joint))) => {
                words.keyword("Site")?;
                words.keyword("{")?;
                all.tips.push((joint, DVec3::ZERO));
                open.push(Open::Tip);
            }
            ("OFFSET", Some(Open::Joint(joint))) => all.joints[joint].rest.translation = words.vector()?,
            ("OFFSET", Some(Open::Tip)) => all.tips.last_mut().expect("a tip is open").1 = words.vector()?,
            ("CHANNELS", Some(Open::Joint(joint))) => all.channels[joint] = channels(words)?,
            ("}", Some(_)) => {
                open.pop();
            }
            _ => return Err(words.expected("ROOT, JOINT, End Site, OFFSET, CHANNELS or } where each may stand")),
        }
    }
}

impl Hierarchy {
    fn begin(&mut self, words: &mut Words, parent: Option<usize>) -> Result<Open, SceneError> {
        let name = words.next("the name of a joint")?.to_owned();
        if name == "{" {
            return Err(words.expected("the name of a joint"));
        }
        // Names may hold blanks.
        while words.next("{")? != "{" {}
        if self.joints.len() == MOST_JOINTS {
            return Err(words.expected(&format!("at most {MOST_JOINTS} joints")));
        }
        self.joints.push(Joint { parent, rest: Transform::IDENTITY });
        self.names.push(name);
        self.channels.push(Vec::new());
        Ok(Open::Joint(self.joints.len() - 1))
    }
}

fn channels(words: &mut Words) -> Result<Vec<Channel>, SceneError> {
    let count: usize = words.parsed("the number of channels")?;
    if count > 6 {
        return Err(words.expected("at most 6 channels"));
    }
    (0..count).map(|_| channel(words)).collect()
}

fn channel(words: &mut Words) -> Result<Channel, SceneError> {
    Ok(match words.next("the name of a channel")?.to_lowercase().as_str() {
        "xposition" => Channel::Position(DVec3::X),
        "yposition" => Channel::Position(DVec3::Y),
        "zposition" => Channel::Position(DVec3::Z),
        "xrotation" => Channel::Rotation(DVec3::X),
        "yrotation" => Channel::Rotation(DVec3::Y),
        "zrotation" => Channel::Rotation(DVec3::Z),
        _ => return Err(words.expected("Xposition … Zposition or Xrotation … Zrotation")),
    })
}

fn motion(words: &mut Words, hierarchy: &Hierarchy) -> Result<Clip, SceneError> {
    words.keyword("Frames:")?;
    let frames: usize = words.parsed("the number of frames")?;
    words.keyword("Frame")?;
    words.keyword("Time:")?;
    let step = words.number()?;
    let values: usize = hierarchy.channels.iter().map(Vec::len).sum();
    let fits = (1..=MOST_FRAMES).contains(&frames) && frames.saturating_mul(values) <= MOST_VALUES && step > 0.0;
    if !fits {
        let most = format!("1 to {MOST_FRAMES} frames of {MOST_VALUES} values in all, a positive time apart");
        return Err(words.expected(&most));
    }
    let mut poses: Vec<Vec<Transform>> = hierarchy.joints.iter().map(|_| Vec::new()).collect();
    for _ in 0..frames {
        for (joint, channels) in hierarchy.channels.iter().enumerate().filter(|(_, channels)| !channels.is_empty()) {
            poses[joint].push(pose(words, &hierarchy.joints[joint].rest, channels)?);
        }
    }
    let times: Vec<f64> = (0..frames).map(|frame| frame as f64 * step).collect();
    let track = |joint, keys| Track { joint, times: times.clone(), keys, interpolation: Interpolation::Linear };
    let mut tracks = Vec::new();
    for (joint, channels) in hierarchy.channels.iter().enumerate() {
        let moves = channels.iter().any(|channel| matches!(channel, Channel::Position(_)));
        let turns = channels.iter().any(|channel| matches!(channel, Channel::Rotation(_)));
        if moves {
            tracks.push(track(joint, Keys::Translations(poses[joint].iter().map(|pose| pose.translation).collect())));
        }
        if turns {
            tracks.push(track(joint, Keys::Rotations(poses[joint].iter().map(|pose| pose.rotation).collect())));
        }
    }
    Ok(Clip::new(tracks))
}

fn pose(words: &mut Words, rest: &Transform, channels: &[Channel]) -> Result<Transform, SceneError> {
    let mut pose = *rest;
    for channel in channels {
        let value = words.number()?;
        match channel {
            Channel::Position(axis) => pose.translation += *axis * value,
            Channel::Rotation(axis) => pose.rotation *= DQuat::from_axis_angle(*axis, value.to_radians()),
        }
    }
    pose.rotation = pose.rotation.normalize();
    Ok(pose)
}

/// The words of a text one after another, with errors that name the line.
struct Words<'a> {
    check: Checker<'a>,
    rest: Box<dyn Iterator<Item = (usize, &'a str)> + 'a>,
    line: usize,
    word: &'a str,
}

impl<'a> Words<'a> {
    fn new(check: Checker<'a>, text: &'a str) -> Self {
        let words = |(line, text): (&'a str, usize)| line.split_whitespace().map(move |word| (text, word));
        Words { check, rest: Box::new(text.lines().zip(1..).flat_map(words)), line: 1, word: "" }
    }

    fn expected(&self, expected: &str) -> SceneError {
        self.check.invalid(&format!("line {}", self.line), expected, self.word)
    }

    fn next(&mut self, expected: &str) -> Result<&'a str, SceneError> {
        let end = || self.check.malformed("end of file", format!("expected {expected}"));
        (self.line, self.word) = self.rest.next().ok_or_else(end)?;
        Ok(self.word)
    }

    fn keyword(&mut self, keyword: &str) -> Result<(), SceneError> {
        if self.next(keyword)? == keyword { Ok(()) } else { Err(self.expected(keyword)) }
    }

    fn parsed<T: std::str::FromStr>(&mut self, expected: &str) -> Result<T, SceneError> {
        self.next(expected)?.parse().map_err(|_| self.expected(expected))
    }

    fn number(&mut self) -> Result<f64, SceneError> {
        let value: f64 = self.parsed("a number")?;
        if value.abs() <= f64::from(FAR) { Ok(value) } else { Err(self.expected("a finite number of at most 1e9")) }
    }

    fn vector(&mut self) -> Result<DVec3, SceneError> {
        Ok(DVec3::new(self.number()?, self.number()?, self.number()?))
    }

    fn end(&mut self) -> Result<(), SceneError> {
        match self.rest.next() {
            None => Ok(()),
            Some((line, word)) => {
                (self.line, self.word) = (line, word);
                Err(self.expected("nothing after the last frame"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::process::Command;

    use super::*;
    use crate::animation::{Playback, Skeleton};

    const ARM: &str = "HIERARCHY\nROOT Upper arm\n{\nOFFSET 0 0 1\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation \
                       Yrotation\nJOINT Lower\n{\nOFFSET 1 0 0\nCHANNELS 1 Zrotation\nEnd Site\n{\nOFFSET 2 0 0\n}\n}\n}\nMOTION\n\
                       Frames: 2\nFrame Time: 0.5\n0 0 0 0 0 0 0\n1 2 3 90 90 0 90\n";

    fn parse(text: &str) -> Result<Capture, SceneError> {
        read(Checker { file: Path::new("arm.bvh") }, text.as_bytes())
    }

    #[test]
    fn rotations_apply_in_the_order_of_their_channels() {
        let arm = parse(ARM).unwrap();
        assert_eq!((arm.names, arm.tips), (vec!["Upper".to_owned(), "Lower".to_owned()], vec![(1, DVec3::X * 2.0)]));
        assert_eq!(arm.clip.duration, 0.5);
        let mut local: Vec<Transform> = arm.joints.iter().map(|joint| joint.rest).collect();
        arm.clip.apply(0.5, &mut local);
        assert_eq!(local[0].translation, DVec3::new(1.0, 2.0, 4.0));
        // About z after about x: the child's y axis goes to z, its x axis to y.
        assert!((local[0].rotation * DVec3::Y).distance(DVec3::Z) < 1e-12);
        assert!((local[0].rotation * DVec3::X).distance(DVec3::Y) < 1e-12);
        assert!((local[1].rotation * DVec3::X).distance(DVec3::Y) < 1e-12);
    }

    /// The Python that `HALFLIGHT_PYTHON` names, or `python3` if that has numpy.
    fn python() -> Option<String> {
        if let Ok(named) = std::env::var("HALFLIGHT_PYTHON") {
            return Some(named);
        }
        let imports = Command::new("python3").args(["-c", "import numpy"]).output();
        imports.is_ok_and(|said| said.status.success()).then(|| "python3".to_owned())
    }

    #[test]
    fn joints_are_where_a_strangers_evaluation_has_them() {
        let Some(python) = python() else { return eprintln!("skipped: no Python with numpy") };
        let folder = env!("CARGO_MANIFEST_DIR");
        for (name, frames) in [("walk.bvh", ["0", "7", "150", "299"]), ("boxing.bvh", ["0", "9", "120", "249"])] {
            let path = format!("{folder}/data/{name}");
            let script = format!("{folder}/tests/poses/bvh.py");
            let said = Command::new(&python).args([&script, &path]).args(frames).output().expect("Python runs");
            assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
            let expected: Vec<Vec<[f64; 3]>> = serde_json::from_slice(&said.stdout).expect("JSON");
            let capture = read(Checker { file: Path::new(name) }, &std::fs::read(&path).expect(name)).expect(name);
            let times = capture.clip.tracks[0].times.clone();
            let skeleton = Skeleton { joints: capture.joints, clip: capture.clip, playback: Playback::default() };
            for (frame, expected) in frames.iter().zip(expected) {
                let pose = skeleton.pose_at(times[frame.parse::<usize>().expect("a number")]);
                assert_eq!(pose.len(), expected.len());
                for (ours, theirs) in pose.iter().zip(expected) {
                    let distance = ours.translation.distance(DVec3::from_array(theirs));
                    assert!(distance < 1e-9 * (1.0 + ours.translation.length()), "{name} {frame}: {distance}");
                }
            }
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (from, to, message) in [
            ("HIERARCHY", "HIERARCHIE", "arm.bvh: line 1: expected HIERARCHY"),
            ("Frames: 2", "Frames: 3", "arm.bvh: end of file: expected a number"),
            ("Frames: 2", "Frames: 99999999999", "expected 1 to 1048576 frames"),
            ("Frame Time: 0.5", "Frame Time: 0", "a positive time apart"),
            ("OFFSET 1 0 0", "OFFSET 1 0", "line 9: expected a number, found \"CHANNELS\""),
            ("OFFSET 1 0 0", "OFFSET 1 0 inf", "expected a finite number"),
            ("1 Zrotation", "1 Wrotation", "expected Xposition"),
            ("CHANNELS 1", "CHANNELS 7", "at most 6 channels"),
            ("90 90 0 90", "90 90 0 90 1", "expected nothing after the last frame"),
            ("ROOT Upper arm\n{", "JOINT Upper\n{", "line 2: expected ROOT"),
        ] {
            let error = parse(&ARM.replace(from, to)).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
        for end in 0..ARM.len() - 2 {
            assert!(parse(&ARM[..end]).is_err(), "{end}");
        }
    }
}
