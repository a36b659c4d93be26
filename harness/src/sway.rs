//! Another frame than the one at hand: what lay before it, so that updating to it does all that motion forces.

use halflight_scenes::{Frame, HeightField, Revision, Shape};
use std::sync::Arc;

/// A frame that a method is updated to, and the one that it stood at before.
#[derive(Clone, Copy)]
pub(crate) struct Motion<'f> {
    pub(crate) from: Option<&'f Frame>,
    pub(crate) to: &'f Frame,
}

/// A frame in which all is otherwise that may be: the one before, or the one after the first; of a scene with one frame alone, the
/// same with other heights. None where nothing ever moves.
pub(crate) fn other(frames: &[Frame], index: usize) -> Option<Frame> {
    let neighbour = if index > 0 { frames.get(index - 1) } else { frames.get(1) };
    neighbour.cloned().or_else(|| frames.get(index).and_then(swayed))
}

/// The frame with all heights larger by a hundredth; none where it has no height field.
pub(crate) fn swayed(frame: &Frame) -> Option<Frame> {
    let mut swayed = frame.clone();
    let mut any = false;
    for posed in &mut swayed.objects {
        if let Shape::Heights(field) = &*posed.shape {
            let heights = field.heights().iter().map(|height| 1.01 * height).collect();
            let size = [field.columns(), field.rows()];
            posed.shape = Arc::new(Shape::Heights(HeightField::new(size, field.origin(), field.cell(), heights)));
            posed.revision = Revision(posed.revision.0 ^ 1);
            any = true;
        }
    }
    any.then_some(swayed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_other_frame_is_a_neighbour_or_has_other_heights() {
        let scene = halflight_scenes::find("walker").unwrap();
        let frames: Vec<Frame> = (0..2).map(|index| scene.frame(index)).collect();
        assert_eq!(other(&frames, 0).unwrap().index, 1);
        assert_eq!(other(&frames, 1).unwrap().index, 0);

        let field = halflight_scenes::find("trench").unwrap().frame(0);
        let swayed = other(std::slice::from_ref(&field), 0).unwrap();
        let moved = swayed.objects.iter().zip(&field.objects).filter(|(a, b)| a.revision != b.revision).count();
        assert_eq!(moved, 1);

        let still = halflight_scenes::find("sphere-plane").unwrap().frame(0);
        assert!(other(std::slice::from_ref(&still), 0).is_none());
    }
}
