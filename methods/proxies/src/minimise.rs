//! Minimising a function of a point without derivatives.

use glam::Vec3;

/// Evaluations of one search along a line, and of one more trial.
const LINE: usize = 4;

/// Powell's method (Press et al. 1992, §10.5; what Ren 2006, §6.2, names): searches along three lines in turn, then along the
/// way that all three went, which takes the place of the line that helped most, unless lines would become alike. Steps grow
/// where they help and shrink where they do not. Returns the best point and its value; never worse than the start, finite
/// whenever the value at the start is.
pub(crate) fn powell(start: Vec3, step: f32, evaluations: usize, f: impl Fn(Vec3) -> f32) -> (Vec3, f32) {
    let mut search = Search { best: (start, f(start)), left: evaluations.saturating_sub(1), f };
    let mut steps = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| step * axis);
    while search.left >= LINE {
        let (before, value) = search.best;
        let gains = steps.each_mut().map(|step| search.along(step));
        let way = search.best.0 - before;
        if way == Vec3::ZERO || search.left < LINE {
            continue;
        }
        let (most, gain) = if gains[0] >= gains[1].max(gains[2]) {
            (0, gains[0])
        } else if gains[1] >= gains[2] {
            (1, gains[1])
        } else {
            (2, gains[2])
        };
        let now = search.best.1;
        let beyond = search.value(search.best.0 + way);
        let (drop, bend) = (value - now - gain, value - 2.0 * now + beyond);
        if beyond < value && 2.0 * bend * drop * drop < gain * (value - beyond) * (value - beyond) {
            steps[most] = steps[2];
            steps[2] = way;
            search.along(&mut steps[2]);
        }
    }
    search.best
}

/// The best point so far, and the evaluations that are left.
struct Search<F> {
    best: (Vec3, f32),
    left: usize,
    f: F,
}

impl<F: Fn(Vec3) -> f32> Search<F> {
    /// The value at a point, which becomes the best one if it is.
    fn value(&mut self, at: Vec3) -> f32 {
        let value = (self.f)(at);
        self.left -= 1;
        if value < self.best.1 {
            self.best = (at, value);
        }
        value
    }

    /// Tries one step each way and the lowest point of the parabola through the three; returns by how much the value fell.
    fn along(&mut self, step: &mut Vec3) -> f32 {
        if self.left < LINE {
            return 0.0;
        }
        let (from, middle) = self.best;
        let (back, forth) = (self.value(from - *step), self.value(from + *step));
        let bend = back - 2.0 * middle + forth;
        let lowest = if bend > 0.0 { 0.5 * (back - forth) / bend } else { 2.0 * (back - forth).signum() };
        let lowest = lowest.clamp(-2.0, 2.0);
        if lowest.is_finite() && lowest != 0.0 {
            self.value(from + lowest * *step);
        }
        *step *= lowest.abs().clamp(0.25, 2.0);
        middle - self.best.1
    }
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
        let (found, value) = powell(Vec3::ZERO, 0.2, 200, bowl);
        assert!(found.distance(least) < 1e-3 && value == bowl(found), "{found} {value}");
    }

    #[test]
    fn the_result_is_never_worse_than_the_start() {
        let hole = |p: Vec3| if p == Vec3::ONE { 0.0 } else { f32::INFINITY };
        assert_eq!(powell(Vec3::ONE, 0.1, 60, hole), (Vec3::ONE, 0.0));
    }

    #[test]
    fn the_budget_is_kept() {
        let calls = std::cell::Cell::new(0);
        powell(Vec3::ZERO, 1.0, 60, |p| {
            calls.set(calls.get() + 1);
            p.distance(Vec3::splat(100.0))
        });
        assert!(calls.get() <= 60, "{}", calls.get());
    }
}
