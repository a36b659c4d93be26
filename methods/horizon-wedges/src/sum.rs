//! Total visibility: the wedges of a swath looked up, turned to their azimuths and added up.

use halflight_sh::{Block, LANES, Lanes, Simd, Task, coefficients, index, run};

use crate::swath::Wedge;
use crate::table::{ELEVATIONS, PER_RADIAN, Wedges, rows};

/// To which a whole number below 2^23 is added, so that its digits are the last bits of the sum: quicker than a conversion.
const TO_BITS: f32 = (1 << 23) as f32;

/// Horizons of some receivers as places in the tables of some wedges.
#[derive(Default)]
pub(crate) struct Places {
    /// Elevations in radians, then entries, of each azimuth's receivers.
    entries: Vec<[f32; LANES]>,
    /// How far from an entry towards the next.
    fractions: Vec<[f32; LANES]>,
    /// Numbers of each wedge's entries, [`TO_BITS`] added.
    numbers: Vec<[f32; LANES]>,
    /// Arrays of one azimuth or wedge.
    blocks: usize,
}

impl Places {
    /// Elevations in radians, all receivers of one azimuth after those of another; those outside `[0, π/2]` are moved to its ends.
    pub(crate) fn set(&mut self, simd: Simd, receivers: usize, elevations: &[f32], wedges: &[Wedge]) {
        self.blocks = receivers.div_ceil(LANES);
        let count = elevations.len() / receivers.max(1) * self.blocks;
        self.entries.resize(count, [0.0; LANES]);
        self.fractions.resize(count, [0.0; LANES]);
        self.numbers.resize(wedges.len() * self.blocks, [0.0; LANES]);
        for (plane, entries) in elevations.chunks_exact(receivers).zip(self.entries.chunks_exact_mut(self.blocks)) {
            entries.as_flattened_mut()[..receivers].copy_from_slice(plane);
        }
        run(simd, Split { places: self });
        run(simd, Number { places: self, wedges });
    }

    /// Of a block of receivers how far their horizons along an azimuth are from their entries towards the next.
    #[inline(always)]
    fn fractions(&self, azimuth: usize, block: usize) -> &[f32; LANES] {
        &self.fractions[azimuth * self.blocks + block]
    }

    /// Of a block of receivers the numbers of a wedge's entries.
    #[inline(always)]
    fn numbers(&self, wedge: usize, block: usize) -> &[f32; LANES] {
        &self.numbers[wedge * self.blocks + block]
    }
}

/// A number that [`TO_BITS`] was added to.
#[inline(always)]
fn whole(number: f32) -> usize {
    (number.to_bits() & 0xffff) as usize
}

/// Turns elevations, held in `entries`, into entries and fractions.
struct Split<'a> {
    places: &'a mut Places,
}

impl Task<f32> for Split<'_> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        let Places { entries, fractions, .. } = self.places;
        let (scale, last) = (V::constant(PER_RADIAN), V::constant((ELEVATIONS - 1) as f64));
        for (entry, fraction) in entries.iter_mut().zip(fractions) {
            for part in 0..LANES / V::WIDTH {
                let place = V::load(entry, part).mul(scale).max(V::constant(0.0)).min(last);
                let whole = place.floor().min(V::constant((ELEVATIONS - 2) as f64));
                whole.store(entry, part);
                place.sub(whole).store(fraction, part);
            }
        }
    }
}

/// Numbers the wedges' entries.
struct Number<'a> {
    places: &'a mut Places,
    wedges: &'a [Wedge],
}

impl Task<f32> for Number<'_> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        let Places { entries, numbers, blocks, .. } = self.places;
        for (wedge, numbers) in self.wedges.iter().zip(numbers.chunks_exact_mut(*blocks)) {
            for (block, number) in numbers.iter_mut().enumerate() {
                for part in 0..LANES / V::WIDTH {
                    let start = V::load(&entries[wedge.start * *blocks + block], part);
                    let found = match wedge.end {
                        None => start,
                        Some(end) => {
                            let end = V::load(&entries[end * *blocks + block], part);
                            start.mul_add(V::constant(ELEVATIONS as f64), end)
                        }
                    };
                    found.add(V::splat(TO_BITS)).store(number, part);
                }
            }
        }
    }
}

/// Adds up the wedges that the places were set for of receivers `0..out.len() / n²`, and writes one vector after the other.
pub(crate) fn sum(simd: Simd, tables: &Wedges, wedges: &[Wedge], places: &Places, out: &mut [f32]) {
    run(simd, Sum { tables, rows: rows(tables.order), places, wedges, out });
}

struct Sum<'a> {
    tables: &'a Wedges,
    /// Blocks of a table's entry.
    rows: usize,
    places: &'a Places,
    wedges: &'a [Wedge],
    out: &'a mut [f32],
}

/// Some coefficients of a block of receivers' wedges, each times `cos mφ` and times `sin mφ`.
type Sums = [[Block<f32>; 2]; LANES];

impl Task<f32> for Sum<'_> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(mut self) {
        let order = self.tables.order;
        let size = coefficients(order);
        let mut sums = [[[Block::ZERO; 2]; LANES]; 4];
        for (block, out) in std::mem::take(&mut self.out).chunks_mut(LANES * size).enumerate() {
            for (row, sums) in sums.iter_mut().enumerate().take(self.rows) {
                *sums = [[Block::ZERO; 2]; LANES];
                for number in 0..self.wedges.len() {
                    self.add::<V>(number, block, row, &mut sums[..out.len() / size]);
                }
            }
            for (receiver, out) in out.chunks_exact_mut(size).enumerate() {
                match self.rows {
                    1 => turned_lanes::<V>(order, &sums[0][receiver], out),
                    _ => turned(order, &sums, receiver, out),
                }
            }
        }
    }
}

impl Sum<'_> {
    /// Adds a wedge of a block of receivers to their sums.
    #[inline(always)]
    fn add<V: Lanes<Scalar = f32>>(&self, number: usize, block: usize, row: usize, sums: &mut [[Block<f32>; 2]]) {
        let Wedges { interior, boundary, .. } = self.tables;
        let wedge = &self.wedges[number];
        let (numbers, along) = (self.places.numbers(number, block), self.places.fractions(wedge.start, block));
        let across = wedge.end.map(|end| self.places.fractions(end, block));
        let [cosines, sines] = [&wedge.turn[row].0, &wedge.turn[self.rows + row].0];
        let next = ELEVATIONS * self.rows;
        for part in 0..LANES / V::WIDTH {
            let (cos, sin) = (V::load(cosines, part), V::load(sines, part));
            for (receiver, [even, odd]) in sums.iter_mut().enumerate() {
                let first = whole(numbers[receiver]) * self.rows + row;
                let along = V::splat(along[receiver]);
                let value = match across {
                    None => {
                        let pair = &boundary[first..first + self.rows + 1];
                        between(part, &pair[0], &pair[self.rows], along)
                    }
                    Some(across) => {
                        let across = V::splat(across[receiver]);
                        let square = &interior[first..first + next + self.rows + 1];
                        let low = between(part, &square[0], &square[self.rows], across);
                        let high = between(part, &square[next], &square[next + self.rows], across);
                        high.sub(low).mul_add(along, low)
                    }
                };
                value.mul_add(cos, V::load(&even.0, part)).store(&mut even.0, part);
                value.mul_add(sin, V::load(&odd.0, part)).store(&mut odd.0, part);
            }
        }
    }
}

/// Linear from one entry to another.
#[inline(always)]
fn between<V: Lanes<Scalar = f32>>(part: usize, from: &Block<f32>, to: &Block<f32>, share: V) -> V {
    let from = V::load(&from.0, part);
    V::load(&to.0, part).sub(from).mul_add(share, from)
}

/// Turns every wedge by its azimuth at once: with `P = Σ cos mφ · w` and `Q = Σ sin mφ · w`, coefficient `m` becomes `P_m − Q_−m` and
/// `−m` becomes `P_−m + Q_m`.
#[inline(always)]
fn turned(order: usize, sums: &[Sums; 4], receiver: usize, out: &mut [f32]) {
    let at = |i: usize, part: usize| sums[i / LANES][receiver][part].0[i % LANES];
    for l in 0..order {
        out[index(l, 0)] = at(index(l, 0), 0);
        for m in 1..=l as isize {
            let (minus, plus) = (index(l, -m), index(l, m));
            out[plus] = at(plus, 0) - at(minus, 1);
            out[minus] = at(minus, 0) + at(plus, 1);
        }
    }
}

/// For each of 16 coefficients the number of that with `−m`, and the sign with which its sine counts.
const MIRRORED: [[f32; LANES]; 2] = {
    let mut mirrored = [[0.0; LANES]; 2];
    let mut l = 0;
    while l * l < LANES {
        let mut m = 0;
        while m <= 2 * l {
            // The coefficients of a band run from −l to l.
            mirrored[0][l * l + m] = (l * l + 2 * l - m) as f32;
            mirrored[1][l * l + m] = if m < l { 1.0 } else { 0.0 } - if m > l { 1.0 } else { 0.0 };
            m += 1;
        }
        l += 1;
    }
    mirrored
};

/// As [`turned`] up to order 4, whose coefficients fill a block.
#[inline(always)]
fn turned_lanes<V: Lanes<Scalar = f32>>(order: usize, [even, odd]: &[Block<f32>; 2], out: &mut [f32]) {
    let mut block = Block::ZERO;
    for part in 0..LANES / V::WIDTH {
        let opposite = V::load(&MIRRORED[0], part).select_from(&odd.0);
        opposite.mul_add(V::load(&MIRRORED[1], part), V::load(&even.0, part)).store(&mut block.0, part);
    }
    out.copy_from_slice(&block.0[..coefficients(order)]);
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, TAU};

    use halflight_sh::{MAX_ORDER, rotate_z};

    use super::*;
    use crate::swath::Swath;
    use crate::wedge::Projector;

    const RECEIVERS: usize = 37;

    /// Horizons between 0 and the zenith, smooth and jagged ones, flat ones, walls.
    fn horizons(azimuths: usize) -> Vec<f32> {
        let at = |azimuth: usize, receiver: usize| match receiver {
            0 => 0.0,
            1 => FRAC_PI_2,
            2 => FRAC_PI_2 * (azimuth % 2) as f64,
            _ => {
                let wave = |phase: f64| (0.61 * (receiver * (azimuth + 3)) as f64 + phase).sin();
                (0.6 + 0.5 * wave(1.0) + 0.4 * wave(2.0) * wave(3.0)).clamp(0.0, FRAC_PI_2)
            }
        };
        (0..azimuths).flat_map(|azimuth| (0..RECEIVERS).map(move |receiver| at(azimuth, receiver) as f32)).collect()
    }

    /// The sum of exact wedges, each turned by itself.
    fn exact(order: usize, swath: &Swath, horizons: &[f32], receiver: usize) -> Vec<f64> {
        let size = coefficients(order);
        let (mut sum, mut wedge, mut turned) = (vec![0.0; size], vec![0.0; size], vec![0.0; size]);
        let angle = |azimuth: usize| f64::from(horizons[azimuth * RECEIVERS + receiver]).min(FRAC_PI_2);
        let mut add = |origin: f64, extent: f64, from: f64, to: f64| {
            let projector = Projector::new(order, extent);
            projector.project(from, &projector.ramp(to - from), &mut wedge);
            rotate_z(order, origin, &wedge, &mut turned);
            sum.iter_mut().zip(&turned).for_each(|(sum, value)| *sum += value);
        };
        let at = |azimuth: usize| swath.first + azimuth as f64 * swath.step;
        for start in 0..swath.count - usize::from(!swath.complete) {
            add(at(start), swath.step, angle(start), angle((start + 1) % swath.count));
        }
        if !swath.complete {
            let last = swath.count - 1;
            add(at(0) - 0.5 * swath.step, 0.5 * swath.step, FRAC_PI_2, angle(0));
            add(at(last), 0.5 * swath.step, angle(last), FRAC_PI_2);
        }
        sum
    }

    fn summed(simd: Simd, tables: &Wedges, wedges: &[Wedge], horizons: &[f32]) -> Vec<f32> {
        let mut places = Places::default();
        places.set(simd, RECEIVERS, horizons, wedges);
        let mut out = vec![f32::NAN; RECEIVERS * coefficients(tables.order)];
        sum(simd, tables, wedges, &places, &mut out);
        out
    }

    /// The sums of the paper's tables, and their instructions' twins.
    #[test]
    fn sums_by_table_are_those_of_exact_wedges() {
        for order in 2..=MAX_ORDER {
            // Sums of smaller swaths, of at most a right angle, have smaller errors.
            for (swath, bound) in [
                (Swath::complete(16), if order <= 4 { 2e-5 } else { 5e-5 }),
                (Swath::complete(5), if order <= 4 { 4e-5 } else { 1.5e-4 }),
                (Swath::partial(0.7, TAU / 4.0, 3), if order <= 4 { 2e-5 } else { 5e-5 }),
                (Swath::partial(-2.0, TAU / 32.0, 1), 2e-5),
            ] {
                let tables = Wedges::new(order, swath.step);
                let (wedges, horizons) = (swath.wedges(order), horizons(swath.count));
                let best = summed(Simd::best(), &tables, &wedges, &horizons);
                let mut worst = 0.0f64;
                for (receiver, found) in best.chunks_exact(coefficients(order)).enumerate() {
                    let expected = exact(order, &swath, &horizons, receiver);
                    let apart = found.iter().zip(&expected).map(|(found, want)| (f64::from(*found) - want).abs());
                    worst = apart.fold(worst, f64::max);
                }
                assert!(worst < bound, "order {order}, {swath:?}: {worst}");
                for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
                    let twin = summed(simd, &tables, &wedges, &horizons);
                    let apart = best.iter().zip(&twin).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                    assert!(apart < 2e-6, "order {order}, {simd:?}: {apart}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_elevation_is_moved_to_the_ends() {
        let mut places = Places::default();
        let odd = [f32::NAN, -1.0, 7.0, f32::INFINITY];
        let wedges = Swath::partial(0.0, 1.0, 1).wedges(2);
        for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
            places.set(simd, odd.len(), &odd, &wedges);
            let at = |receiver: usize| (whole(places.numbers(0, 0)[receiver]), places.fractions(0, 0)[receiver]);
            let last = (ELEVATIONS - 2, 1.0);
            assert_eq!([0, 1, 2, 3].map(at), [(0, 0.0), (0, 0.0), last, last]);
        }
    }
}
