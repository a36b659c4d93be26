//! Gathering the circles of all blockers that matter at 16 receivers.

use halflight_proxies::SelfShadow;
use halflight_scenes::{Receivers, Sphere};
use halflight_sh::{LANES, Simd, run};

use crate::seen::{Circles, Found, Group, SPHERES, Seen};

/// Which blockers count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gather {
    /// Self-shadow rule.
    pub self_shadow: SelfShadow,
    /// Circles with a smaller sine of the angular radius are skipped; 0 skips none.
    pub min_sin_angle: f32,
}

/// Spheres that block, and how their logs are to be scaled.
#[derive(Clone, Copy, Debug, Default)]
pub struct Blockers<'a> {
    /// The spheres.
    pub spheres: &'a [Sphere],
    /// Factors for the bands of each sphere's log visibility, as many a sphere as there are bands; none if nothing is scaled.
    pub ratios: &'a [f32],
}

/// Blockers looked at while gathering.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Circles accumulated.
    pub accumulated: u64,
    /// Spheres that the self-shadow rules removed.
    pub removed: u64,
    /// Circles below the smallest angle.
    pub too_small: u64,
}

impl std::ops::Add for Tally {
    type Output = Tally;

    fn add(self, other: Tally) -> Tally {
        Tally {
            accumulated: self.accumulated + other.accumulated,
            removed: self.removed + other.removed,
            too_small: self.too_small + other.too_small,
        }
    }
}

impl Gather {
    /// Calls `accumulate` with the circles of the blockers that count at receivers `numbers`, at most 16, some spheres at a time
    /// and in the order given; spheres that no receiver sees are left out. A lane beyond the receivers repeats the last one.
    ///
    /// Returns how many circles each receiver has.
    ///
    /// # Panics
    /// If there are no numbers or more than 16.
    pub fn circles(
        &self,
        receivers: &Receivers,
        numbers: &[usize],
        blockers: Blockers<'_>,
        tally: &mut Tally,
        accumulate: impl FnMut(&Circles<'_>),
    ) -> [u32; LANES] {
        self.circles_by(Simd::best(), receivers, numbers, blockers, tally, accumulate)
    }

    fn circles_by(
        &self,
        simd: Simd,
        receivers: &Receivers,
        numbers: &[usize],
        Blockers { spheres, ratios }: Blockers<'_>,
        tally: &mut Tally,
        mut accumulate: impl FnMut(&Circles<'_>),
    ) -> [u32; LANES] {
        assert!((1..=LANES).contains(&numbers.len()), "{} receivers, expected 1 to {LANES}", numbers.len());
        let (group, mut found) = (Group::new(receivers, numbers), Found::new());
        let bands = ratios.len() / spheres.len().max(1);
        for (number, spheres) in spheres.chunks(SPHERES).enumerate() {
            let first = (number * SPHERES) as u32;
            run(simd, Seen { gather: *self, group: &group, spheres, first, found: &mut found });
            let circles = found.circles(ratios, bands);
            if !circles.sines.is_empty() {
                accumulate(&circles);
            }
        }
        for lane in 0..numbers.len() {
            let (accumulated, too_small) = (found.accumulated.0[lane] as u64, found.too_small.0[lane] as u64);
            tally.accumulated += accumulated;
            tally.too_small += too_small;
            tally.removed += spheres.len() as u64 - accumulated - too_small;
        }
        found.accumulated.0.map(|count| count as u32)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use halflight_proxies::{Circle, seen};
    use halflight_scenes::{Layout, Revision};

    use super::*;

    /// Receivers about the origin, before spheres that hold them, poke through their planes, lie before and behind them.
    fn scene() -> (Receivers, Vec<Sphere>) {
        let wave = |i: usize, phase: f32| (i as f32 * 2.399 + phase).sin();
        let receivers = Receivers {
            layout: Layout::List,
            position: (0..37).map(|i| 0.5 * Vec3::new(wave(i, 0.0), wave(i, 1.0), wave(i, 2.0))).collect(),
            geometric_normal: (0..37)
                .map(|i| Vec3::new(wave(i, 4.0), wave(3 * i, 5.0), wave(i, 0.5)).normalize())
                .collect(),
            normal: Vec::new(),
            albedo: Vec::new(),
            valid: Vec::new(),
            place: Vec::new(),
            revision: Revision(0),
        };
        let sphere = |i: usize| Sphere {
            center: Vec3::new(wave(i, 1.5), wave(5 * i, 2.5), wave(7 * i, 0.1)),
            radius: 0.7 * wave(i, 3.0).abs(),
        };
        let mut spheres: Vec<Sphere> = (0..50).map(sphere).collect();
        spheres.push(Sphere { center: receivers.position[3], radius: 0.2 });
        spheres.push(Sphere { center: Vec3::ONE, radius: 0.0 });
        (receivers, spheres)
    }

    fn expected(gather: &Gather, position: Vec3, normal: Vec3, spheres: &[Sphere]) -> (Vec<Circle>, Tally) {
        let mut tally = Tally::default();
        let mut circles = Vec::new();
        for sphere in spheres {
            match seen(gather.self_shadow, position, normal, sphere) {
                None => tally.removed += 1,
                Some(circle) if circle.sin_angle < gather.min_sin_angle => tally.too_small += 1,
                Some(circle) => {
                    tally.accumulated += 1;
                    circles.push(circle);
                }
            }
        }
        (circles, tally)
    }

    /// Equal but for the roundings of a reciprocal root; tiny where a straddling sphere has just faded in.
    fn near(a: f32, b: f32) -> bool {
        (a == 0.0) == (b == 0.0) && (a - b).abs() <= 1e-6 * a.max(0.3)
    }

    #[test]
    fn each_receiver_sees_the_circles_that_it_sees_alone() {
        let (receivers, spheres) = scene();
        for (self_shadow, min_sin_angle, simd) in [SelfShadow::Paper, SelfShadow::Continuous, SelfShadow::Off]
            .into_iter()
            .flat_map(|rule| [(rule, 0.0), (rule, 0.3)])
            .flat_map(|(rule, least)| Simd::ALL.map(|simd| (rule, least, simd)))
            .filter(|(_, _, simd)| simd.is_available())
        {
            let gather = Gather { self_shadow, min_sin_angle };
            let numbers: Vec<usize> = (0..receivers.position.len()).collect();
            for group in numbers.chunks(LANES) {
                let (mut tally, mut circles) = (Tally::default(), vec![Vec::new(); LANES]);
                // Factors that tell whose they are.
                let ratios: Vec<f32> = (0..spheres.len()).flat_map(|number| [number as f32, 0.5]).collect();
                let blockers = Blockers { spheres: &spheres, ratios: &ratios };
                let counts = gather.circles_by(simd, &receivers, group, blockers, &mut tally, |seen| {
                    assert_eq!(seen.axes.len(), seen.sines.len());
                    assert_eq!(2 * seen.axes.len(), seen.ratios.len());
                    for (sines, ratios) in seen.sines.iter().zip(seen.ratios.chunks_exact(2)) {
                        let sphere = &spheres[ratios[0] as usize];
                        let expected = group.iter().map(|&receiver| {
                            let (position, normal) =
                                (receivers.position[receiver], receivers.geometric_normal[receiver]);
                            expected(&gather, position, normal, std::slice::from_ref(sphere)).0
                        });
                        for (circle, sine) in expected.zip(sines.0) {
                            assert!(near(circle.first().map_or(0.0, |circle| circle.sin_angle), sine));
                        }
                        assert_eq!(ratios[1], 0.5);
                    }
                    for (axes, sines) in seen.axes.iter().zip(seen.sines) {
                        assert!(sines.0.iter().any(|sine| *sine > 0.0), "a sphere that nobody sees");
                        for (lane, list) in circles.iter_mut().enumerate() {
                            let axis = Vec3::from_array(std::array::from_fn(|i| axes[i].0[lane]));
                            match sines.0[lane] {
                                0.0 => assert!(axis.is_finite()),
                                sin_angle => list.push(Circle { axis, sin_angle }),
                            }
                        }
                    }
                });
                let mut sum = Tally::default();
                for (lane, &number) in group.iter().enumerate() {
                    let (position, normal) = (receivers.position[number], receivers.geometric_normal[number]);
                    let (want, alone) = expected(&gather, position, normal, &spheres);
                    sum = sum + alone;
                    assert_eq!(counts[lane] as usize, want.len());
                    assert_eq!(circles[lane].len(), want.len(), "{self_shadow:?}, {simd:?}, receiver {number}");
                    for (got, want) in circles[lane].iter().zip(&want) {
                        assert!(near(got.sin_angle, want.sin_angle), "{got:?} instead of {want:?}");
                        assert!(got.axis.abs_diff_eq(want.axis, 5e-7), "{got:?} instead of {want:?}");
                    }
                }
                assert_eq!(tally, sum, "{self_shadow:?}, {simd:?}");
            }
        }
    }
}
