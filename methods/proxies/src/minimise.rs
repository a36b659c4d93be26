//! Minimising a function of a point without derivatives.

use glam::Vec3;

/// Pattern search (Hooke and Jeeves): tries a step along each axis, and once more along the way that helped; the step
/// shrinks when nothing helps. Returns the best point and its value; never worse than the start, finite whenever the
/// value at the start is.
pub(crate) fn pattern_search(start: Vec3, step: f32, evaluations: usize, f: impl Fn(Vec3) -> f32) -> (Vec3, f32) {
    let mut best = (start, f(start));
    let mut step = step;
    let mut used = 1;
    while used + 7 <= evaluations {
        let before = best.0;
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for direction in [step, -step] {
                let at = best.0 + direction * axis;
                let value = f(at);
                used += 1;
                if value < best.1 {
                    best = (at, value);
                    break;
                }
            }
        }
        if best.0 == before {
            step *= 0.5;
            continue;
        }
        let at = best.0 + (best.0 - before);
        let value = f(at);
        used += 1;
        if value < best.1 {
            best = (at, value);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_value_of_a_skew_bowl_is_found() {
        let least = Vec3::new(0.3, -0.2, 0.7);
        let bowl = |p: Vec3| {
            let d = p - least;
            d.length_squared() + 0.5 * (d.x + d.y) * (d.x + d.y) + 2.0 * d.z.abs()
        };
        let (found, value) = pattern_search(Vec3::ZERO, 0.2, 200, bowl);
        assert!(found.distance(least) < 1e-3 && value == bowl(found), "{found} {value}");
    }

    #[test]
    fn the_result_is_never_worse_than_the_start() {
        let hole = |p: Vec3| if p == Vec3::ONE { 0.0 } else { f32::INFINITY };
        assert_eq!(pattern_search(Vec3::ONE, 0.1, 60, hole), (Vec3::ONE, 0.0));
    }

    #[test]
    fn the_budget_is_kept() {
        let calls = std::cell::Cell::new(0);
        pattern_search(Vec3::ZERO, 1.0, 60, |p| {
            calls.set(calls.get() + 1);
            p.distance(Vec3::splat(100.0))
        });
        assert!(calls.get() <= 60, "{}", calls.get());
    }
}
