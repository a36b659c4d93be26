//! Total visibility: the wedges of a swath looked up, turned to their azimuths and added up.

use halflight_sh::{Block, LANES, Lanes, Simd, Task, coefficients, index, run};

use crate::swath::Wedge;
use crate::table::{ELEVATIONS, PER_RADIAN, Wedges, rows};

/// Horizons of some receivers as places in the tables: an entry, and how far towards the next.
#[derive(Default)]
pub(crate) struct Places {
    entries: Vec<Block<f32>>,
    fractions: Vec<Block<f32>>,
    /// Blocks of one azimuth.
    blocks: usize,
}

impl Places {
    /// Elevations in radians, all receivers of one azimuth after those of another; those outside `[0, π/2]` are moved to its ends.
    pub(crate) fn set(&mut self, simd: Simd, receivers: usize, elevations: &[f32]) {
        self.blocks = receivers.div_ceil(LANES);
        let azimuths = elevations.len() / receivers.max(1);
        for places in [&mut self.entries, &mut self.fractions] {
            places.clear();
            places.resize(azimuths * self.blocks, Block::ZERO);
        }
        for (plane, entries) in elevations.chunks_exact(receivers).zip(self.entries.chunks_exact_mut(self.blocks)) {
            for (from, to) in plane.chunks(LANES).zip(entries) {
                to.0[..from.len()].copy_from_slice(from);
            }
        }
        run(simd, Split { places: self });
    }

    fn at(&self, azimuth: usize, receiver: usize) -> (usize, f32) {
        let (block, lane) = (azimuth * self.blocks + receiver / LANES, receiver % LANES);
        (self.entries[block].0[lane] as usize, self.fractions[block].0[lane])
    }
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
                let place = V::load(&entry.0, part).mul(scale).max(V::constant(0.0)).min(last);
                let whole = place.floor().min(V::constant((ELEVATIONS - 2) as f64));
                whole.store(&mut entry.0, part);
                place.sub(whole).store(&mut fraction.0, part);
            }
        }
    }
}

/// Adds up the wedges of receivers `0..out.len() / n²`, and writes one vector after the other.
pub(crate) fn sum(simd: Simd, tables: &Wedges, wedges: &[Wedge], places: &Places, out: &mut [f32]) {
    run(simd, Sum { look_up: LookUp { tables, rows: rows(tables.order), places }, wedges, out });
}

struct Sum<'a> {
    look_up: LookUp<'a>,
    wedges: &'a [Wedge],
    out: &'a mut [f32],
}

impl Task<f32> for Sum<'_> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        let LookUp { tables: &Wedges { order, .. }, rows, .. } = self.look_up;
        let mut sums = [[Block::ZERO; 4]; 2];
        for (receiver, out) in self.out.chunks_exact_mut(coefficients(order)).enumerate() {
            for row in 0..rows {
                for part in 0..LANES / V::WIDTH {
                    let (mut even, mut odd) = (V::constant(0.0), V::constant(0.0));
                    for wedge in self.wedges {
                        let value = self.look_up.value::<V>(wedge, receiver, row, part);
                        even = value.mul_add(V::load(&wedge.turn[0][row].0, part), even);
                        odd = value.mul_add(V::load(&wedge.turn[1][row].0, part), odd);
                    }
                    even.store(&mut sums[0][row].0, part);
                    odd.store(&mut sums[1][row].0, part);
                }
            }
            turned(order, &sums, out);
        }
    }
}

/// Tables and places in them.
#[derive(Clone, Copy)]
struct LookUp<'a> {
    tables: &'a Wedges,
    /// Blocks of an entry.
    rows: usize,
    places: &'a Places,
}

impl LookUp<'_> {
    /// Some coefficients of a receiver's wedge, interpolated.
    #[inline(always)]
    fn value<V: Lanes<Scalar = f32>>(&self, wedge: &Wedge, receiver: usize, row: usize, part: usize) -> V {
        let Wedges { interior, boundary, .. } = self.tables;
        let (start, along) = self.places.at(wedge.start, receiver);
        let along = V::splat(along);
        let Some(end) = wedge.end else {
            let low = V::load(&boundary[start * self.rows + row].0, part);
            let high = V::load(&boundary[(start + 1) * self.rows + row].0, part);
            return high.sub(low).mul_add(along, low);
        };
        let (end, across) = self.places.at(end, receiver);
        let across = V::splat(across);
        let entry = (start * ELEVATIONS + end) * self.rows + row;
        let next = entry + ELEVATIONS * self.rows;
        let low = V::load(&interior[entry].0, part);
        let low = V::load(&interior[entry + self.rows].0, part).sub(low).mul_add(across, low);
        let high = V::load(&interior[next].0, part);
        let high = V::load(&interior[next + self.rows].0, part).sub(high).mul_add(across, high);
        high.sub(low).mul_add(along, low)
    }
}

/// Turns every wedge by its azimuth at once: with `P = Σ cos mφ · w` and `Q = Σ sin mφ · w`, coefficient `m` becomes `P_m − Q_−m` and
/// `−m` becomes `P_−m + Q_m`.
#[inline(always)]
fn turned(order: usize, [even, odd]: &[[Block<f32>; 4]; 2], out: &mut [f32]) {
    let at = |sums: &[Block<f32>; 4], i: usize| sums[i / LANES].0[i % LANES];
    for l in 0..order {
        out[index(l, 0)] = at(even, index(l, 0));
        for m in 1..=l as isize {
            let (minus, plus) = (index(l, -m), index(l, m));
            out[plus] = at(even, plus) - at(odd, minus);
            out[minus] = at(even, minus) + at(odd, plus);
        }
    }
}
