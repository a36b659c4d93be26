//! The triple product tensor.

use std::f64::consts::PI;

use halflight_sh::gauss_legendre;

use crate::latitude::Latitude;
use crate::level::{Level, Loop, Scalar, run};
use crate::{Form, assert_order, assert_vectors};

/// The product by the nonzero entries `Γ_ijk`, one for all its permutations (Ren 2006, eq. 3).
#[derive(Clone, Debug)]
pub struct Sparse<T> {
    order: usize,
    /// With `i ≤ j ≤ k`.
    triples: Vec<([u8; 3], T)>,
}

/// `∫ u v w dφ` of cosines (`m ≥ 0`) and sines (`m < 0`), by a rule that is exact.
fn azimuth(order: usize, m: [i32; 3]) -> f64 {
    let points = 3 * order;
    let at = |phi: f64| -> f64 {
        m.iter().map(|&m| if m < 0 { (-f64::from(m) * phi).sin() } else { (f64::from(m) * phi).cos() }).product()
    };
    (0..points).map(|k| at((k as f64 + 0.5) * 2.0 * PI / points as f64)).sum::<f64>() * 2.0 * PI / points as f64
}

impl<T: Scalar> Sparse<T> {
    /// # Panics
    /// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER).
    pub fn new(order: usize) -> Self {
        assert_order(order);
        let (nodes, weights) = gauss_legendre((3 * order - 1) / 2);
        let rings: Vec<Latitude> = nodes.iter().map(|z| Latitude::new(order, (1.0 - z * z).sqrt(), *z)).collect();
        let band = |i: usize| i.isqrt();
        let number = |i: usize| i as i32 - (band(i) * (band(i) + 1)) as i32;
        let turns = 2 * order - 1;
        let place = |m: i32| (m + order as i32 - 1) as usize;
        let mut azimuths = vec![f64::NAN; turns.pow(3)];
        let mut triples = Vec::new();
        for i in 0..order * order {
            for j in i..order * order {
                let pair: Vec<f64> = (rings.iter().zip(&weights))
                    .map(|(ring, w)| {
                        let part = |i: usize| ring.at(band(i), number(i).unsigned_abs() as usize);
                        w * part(i) * part(j)
                    })
                    .collect();
                for k in j..order * order {
                    let m = [i, j, k].map(number);
                    let turn = &mut azimuths[(place(m[0]) * turns + place(m[1])) * turns + place(m[2])];
                    if turn.is_nan() {
                        *turn = azimuth(order, m);
                    }
                    if turn.abs() < 1e-9 {
                        continue;
                    }
                    let latitude = |ring: &Latitude| ring.at(band(k), m[2].unsigned_abs() as usize);
                    let value = *turn * pair.iter().zip(&rings).map(|(p, ring)| p * latitude(ring)).sum::<f64>();
                    if value.abs() > 1e-9 {
                        triples.push(([i as u8, j as u8, k as u8], T::of(value)));
                    }
                }
            }
        }
        Self { order, triples }
    }

    /// The entries, permutations not counted.
    pub fn entries(&self) -> usize {
        self.triples.len()
    }
}

struct Triples<'a, T> {
    triples: &'a [([u8; 3], T)],
    a: &'a [T],
    b: &'a [T],
    out: &'a mut [T],
}

/// What one entry adds to one coefficient.
#[inline(always)]
fn add<L: Level, T: Scalar>(value: T, a: &[T], b: &[T], out: &mut [T], [to, x, y]: [usize; 3]) {
    let both = if x == y { a[x] * b[x] } else { L::mul_add(a[x], b[y], a[y] * b[x]) };
    out[to] = L::mul_add(value, both, out[to]);
}

impl<T: Scalar> Loop for Triples<'_, T> {
    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { triples, a, b, out } = self;
        out.fill(T::ZERO);
        for &([i, j, k], value) in triples {
            let (i, j, k) = (usize::from(i), usize::from(j), usize::from(k));
            add::<L, T>(value, a, b, out, [i, j, k]);
            if j != i {
                add::<L, T>(value, a, b, out, [j, i, k]);
            }
            if k != j {
                add::<L, T>(value, a, b, out, [k, i, j]);
            }
        }
    }
}

impl<T: Scalar> Form<T> for Sparse<T> {
    fn product(&mut self, a: &[T], b: &[T], out: &mut [T]) {
        assert_vectors(self.order, [a.len(), b.len(), out.len()]);
        run(Triples { triples: &self.triples, a, b, out });
    }
}
