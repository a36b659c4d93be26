//! Heights that a picture lacks.

/// Gives every height that is `nodata` (every NaN, if that is NaN) the mean of those about it that are known, ring by ring from the
/// rims of holes inwards, and returns how many there were; `None` if nothing is known.
pub(super) fn fill(columns: usize, heights: &mut [f32], nodata: f32) -> Option<usize> {
    let lacks = |height: &f32| *height == nodata || (height.is_nan() && nodata.is_nan());
    let mut known: Vec<bool> = heights.iter().map(|height| !lacks(height)).collect();
    let holes: Vec<usize> = (0..heights.len()).filter(|&index| !known[index]).collect();
    if holes.len() == heights.len() {
        return None;
    }
    let rows = heights.len() / columns;
    let mut ring: Vec<usize> =
        holes.iter().copied().filter(|&hole| around(hole, columns, rows).any(|near| known[near])).collect();
    while !ring.is_empty() {
        let mean = |&hole: &usize| {
            let near = || around(hole, columns, rows).filter(|&near| known[near]);
            let sum: f64 = near().map(|near| f64::from(heights[near])).sum();
            (sum / near().count() as f64) as f32
        };
        let found: Vec<f32> = ring.iter().map(mean).collect();
        for (&hole, height) in ring.iter().zip(found) {
            (heights[hole], known[hole]) = (height, true);
        }
        let mut inner: Vec<usize> =
            ring.iter().flat_map(|&hole| around(hole, columns, rows)).filter(|&near| !known[near]).collect();
        inner.sort_unstable();
        inner.dedup();
        ring = inner;
    }
    Some(holes.len())
}

/// The eight about a vertex, fewer at borders.
fn around(index: usize, columns: usize, rows: usize) -> impl Iterator<Item = usize> {
    let (column, row) = (index % columns, index / columns);
    let span = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
    let all = span(row, rows).flat_map(move |j| span(column, columns).map(move |i| j * columns + i));
    all.filter(move |near| *near != index)
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: usize = 9;

    fn plane(index: usize) -> f32 {
        (2 * (index % COLUMNS)) as f32 - 3.0 * (index / COLUMNS) as f32
    }

    #[test]
    fn a_hole_in_a_plane_is_that_plane() {
        for nodata in [f32::NAN, -9999.0, f32::MIN, f32::INFINITY] {
            let mut heights: Vec<f32> = (0..63).map(plane).collect();
            (heights[20], heights[42]) = (nodata, nodata);
            assert_eq!(fill(COLUMNS, &mut heights, nodata), Some(2));
            assert!(heights.iter().enumerate().all(|(index, height)| *height == plane(index)), "{nodata}");
        }
    }

    #[test]
    fn large_holes_fill_from_their_rims_and_stay_between_them() {
        let inside = |index: usize| (2..9).contains(&(index % COLUMNS)) && (1..6).contains(&(index / COLUMNS));
        let hole = |index: usize| if inside(index) { f32::NAN } else { plane(index) };
        let mut heights: Vec<f32> = (0..63).map(hole).collect();
        assert_eq!(fill(COLUMNS, &mut heights, f32::NAN), Some(35));
        for (index, height) in heights.iter().enumerate() {
            assert!((-18.0..=16.0).contains(height) && (inside(index) || *height == plane(index)), "{index}: {height}");
        }
        // The vertex (2, 1) has five known neighbours, the first ring's at that time.
        let rim = [1, 2, 3, 10, 19].map(plane).iter().sum::<f32>() / 5.0;
        assert_eq!(heights[11], rim);
    }

    #[test]
    fn what_is_no_hole_stays_and_nothing_comes_of_nothing() {
        let mut heights = [1.0, -9999.0, f32::NAN, 4.0];
        assert_eq!(fill(2, &mut heights, 7.0), Some(0));
        assert!(heights[1] == -9999.0 && heights[2].is_nan());
        assert_eq!(fill(2, &mut [f32::NAN; 4], f32::NAN), None);
    }
}
