//! The Fourier series on the torus.

use std::f64::consts::PI;
use std::sync::Arc;

use halflight_sh::{gauss_legendre, index};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use crate::latitude::Latitude;
use crate::level::{Level, Loop, Scalar, run};
use crate::{Form, assert_order, assert_vectors};

/// The product by two-dimensional fast Fourier transforms (Xin et al. 2021; the same as Gaunt tensor products, Luo et al.
/// 2024).
///
/// With θ continued to the whole circle, a function of order n is a trigonometric polynomial of degree n - 1 in θ and in φ. Both
/// factors are brought to a grid at once, as real and imaginary part; their product there is exact, and what of it reaches
/// the coefficients are integrals of sines and cosines against the basis. At -θ the function is that at θ and half a turn,
/// so that half the rows are enough.
#[derive(Clone)]
pub struct Fourier<T: Scalar> {
    order: usize,
    /// Points in θ, twice the rows in use and one beyond, and in φ.
    grid: [usize; 2],
    /// By m, l and k, which has l's parity: the coefficients of `cos kθ` (m even) or `sin kθ` (m odd) in `y_lm`.
    forward: Vec<T>,
    /// The same of integrals against `y_lm`.
    backward: Vec<T>,
    transforms: Transforms<T>,
    columns: Vec<Complex<T>>,
    rows: Vec<Complex<T>>,
    scratch: Vec<Complex<T>>,
}

#[derive(Clone)]
struct Transforms<T> {
    theta_inverse: Arc<dyn Fft<T>>,
    theta: Arc<dyn Fft<T>>,
    phi_inverse: Arc<dyn Fft<T>>,
    phi: Arc<dyn Fft<T>>,
}

/// The next even number from `least` on that has no prime factors above 5: those that transforms are fast for.
fn smooth(least: usize) -> usize {
    let is_smooth = |mut n: usize| {
        for p in [2, 3, 5] {
            while n.is_multiple_of(p) {
                n /= p;
            }
        }
        n == 1
    };
    (least..).find(|&n| n.is_multiple_of(2) && is_smooth(n)).expect("powers of two have no end")
}

/// `cos kθ` or, for odd m, `sin kθ`.
fn wave(m: usize, k: usize, theta: f64) -> f64 {
    if m.is_multiple_of(2) { (k as f64 * theta).cos() } else { (k as f64 * theta).sin() }
}

/// For all m, l and k ≤ `last(l)` of l's parity.
fn table<T: Scalar>(order: usize, last: impl Fn(usize) -> usize, entry: impl Fn(usize, usize, usize) -> f64) -> Vec<T> {
    let mut out = Vec::new();
    for m in 0..order {
        for l in m..order {
            out.extend((l % 2..=last(l)).step_by(2).map(|k| T::of(entry(m, l, k))));
        }
    }
    out
}

impl<T: Scalar> Fourier<T> {
    /// # Panics
    /// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER).
    pub fn new(order: usize) -> Self {
        assert_order(order);
        let grid = [smooth(4 * order - 3), smooth(3 * order - 2)];
        // Around the circle of θ, where y_lm is a trigonometric polynomial of degree l.
        let points = 2 * order;
        let angle = |j: usize| 2.0 * PI * (j as f64 + 0.5) / points as f64;
        let circle: Vec<Latitude> = (0..points).map(|j| Latitude::new(order, angle(j).sin(), angle(j).cos())).collect();
        let forward = table(
            order,
            |l| l,
            |m, l, k| {
                let sum: f64 = (0..points).map(|j| circle[j].at(l, m) * wave(m, k, angle(j))).sum();
                sum * if k == 0 { 1.0 } else { 2.0 } / points as f64
            },
        );
        let (nodes, weights) = gauss_legendre((3 * order - 1) / 2);
        let rings: Vec<Latitude> = nodes.iter().map(|z| Latitude::new(order, (1.0 - z * z).sqrt(), *z)).collect();
        let backward = table(
            order,
            |_| 2 * (order - 1),
            |m, l, k| {
                let terms = rings.iter().zip(&nodes).zip(&weights);
                2.0 * PI * terms.map(|((ring, z), w)| w * ring.at(l, m) * wave(m, k, z.acos())).sum::<f64>()
            },
        );
        let mut planner = FftPlanner::new();
        let transforms = Transforms {
            theta_inverse: planner.plan_fft_inverse(grid[0]),
            theta: planner.plan_fft_forward(grid[0]),
            phi_inverse: planner.plan_fft_inverse(grid[1]),
            phi: planner.plan_fft_forward(grid[1]),
        };
        let zero = Complex::new(T::ZERO, T::ZERO);
        let all = [&transforms.theta_inverse, &transforms.theta, &transforms.phi_inverse, &transforms.phi];
        let scratch = all.map(|fft| fft.get_inplace_scratch_len()).into_iter().max().unwrap_or(0);
        Self {
            order,
            grid,
            forward,
            backward,
            transforms,
            columns: vec![zero; (2 * order - 1) * grid[0]],
            rows: vec![zero; (grid[0] / 2 + 1) * grid[1]],
            scratch: vec![zero; scratch],
        }
    }

    /// Where the column of frequency `m` (negative ones are counted from the end) begins.
    fn column(&self, m: isize) -> usize {
        m.rem_euclid(2 * self.order as isize - 1) as usize * self.grid[0]
    }
}

/// Writes the columns of `a + ib`: by m, the Fourier coefficients in θ.
struct Spread<'a, T: Scalar> {
    order: usize,
    height: usize,
    table: &'a [T],
    a: &'a [T],
    b: &'a [T],
    columns: &'a mut [Complex<T>],
}

impl<T: Scalar> Loop for Spread<'_, T> {
    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { order, height, table, a, b, columns } = self;
        let half = T::of(0.5);
        columns.fill(Complex::new(T::ZERO, T::ZERO));
        let mut entries = table.iter();
        for m in 0..order {
            // cosine and sine parts of a, of b
            let mut series = [[T::ZERO; 4]; crate::MAX_ORDER];
            for l in m..order {
                let (plus, minus) = (index(l, m as isize), index(l, -(m as isize)));
                let sines = if m == 0 { [T::ZERO; 2] } else { [a[minus], b[minus]] };
                let values = [a[plus], sines[0], b[plus], sines[1]];
                for (series, entry) in series[l % 2..=l].iter_mut().step_by(2).zip(&mut entries) {
                    for (sum, value) in series.iter_mut().zip(values) {
                        *sum = L::mul_add(*entry, value, *sum);
                    }
                }
            }
            for (k, &[ac, a_s, bc, bs]) in series[..order].iter().enumerate() {
                // e^imφ has half of (cosine - i sine), e^-imφ half of (cosine + i sine); times i for b.
                let (plus, minus) = if m == 0 {
                    (Complex::new(ac, bc), Complex::new(ac, bc))
                } else {
                    (
                        Complex::new(half * (ac + bs), half * (bc - a_s)),
                        Complex::new(half * (ac - bs), half * (bc + a_s)),
                    )
                };
                for (column, value) in [(m, plus), ((2 * order - 1 - m) % (2 * order - 1), minus)] {
                    let column = &mut columns[column * height..][..height];
                    if k == 0 {
                        column[0] = value;
                    } else if m.is_multiple_of(2) {
                        column[k] = Complex::new(half * value.re, half * value.im);
                        column[height - k] = column[k];
                    } else {
                        // sin kθ = (e^ikθ - e^-ikθ)/2i
                        column[k] = Complex::new(half * value.im, T::ZERO - half * value.re);
                        column[height - k] = Complex::new(T::ZERO - column[k].re, T::ZERO - column[k].im);
                    }
                }
            }
        }
    }
}

/// Reads the coefficients from the columns of the product.
struct Gather<'a, T: Scalar> {
    order: usize,
    height: usize,
    /// What transforms there and back multiply by.
    size: f64,
    table: &'a [T],
    columns: &'a [Complex<T>],
    out: &'a mut [T],
}

impl<T: Scalar> Loop for Gather<'_, T> {
    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { order, height, size, table, columns, out } = self;
        let scale = T::of(1.0 / size);
        let last = 2 * (order - 1);
        let mut at = 0;
        for m in 0..order {
            let column = &columns[m * height..][..height];
            // The series in cos kθ or sin kθ; by parity of k, so that loops run over neighbours.
            let mut series = [[[T::ZERO; 2]; crate::MAX_ORDER]; 2];
            for k in 0..=last {
                let (plus, minus) = (column[k], column[(height - k) % height]);
                let value = match (k, m % 2) {
                    (0, 0) => plus,
                    (_, 0) => Complex::new(plus.re + minus.re, plus.im + minus.im),
                    _ => Complex::new(minus.im - plus.im, plus.re - minus.re),
                };
                series[k % 2][k / 2] = [scale * value.re, T::ZERO - scale * value.im];
            }
            for l in m..order {
                let count = (last - l % 2) / 2 + 1;
                let row = &table[at..at + count];
                at += count;
                let [mut cosine, mut sine] = [T::ZERO; 2];
                for (entry, value) in row.iter().zip(&series[l % 2]) {
                    cosine = L::mul_add(*entry, value[0], cosine);
                    sine = L::mul_add(*entry, value[1], sine);
                }
                out[index(l, -(m as isize))] = sine;
                out[index(l, m as isize)] = cosine; // last: for m = 0 both are the same coefficient
            }
        }
    }
}

impl<T: Scalar> Form<T> for Fourier<T> {
    fn product(&mut self, a: &[T], b: &[T], out: &mut [T]) {
        let (order, [height, width]) = (self.order, self.grid);
        assert_vectors(order, [a.len(), b.len(), out.len()]);
        run(Spread { order, height, table: &self.forward, a, b, columns: &mut self.columns });
        self.transforms.theta_inverse.process_with_scratch(&mut self.columns, &mut self.scratch);

        let frequencies = || (1 - order as isize)..order as isize;
        self.rows.fill(Complex::new(T::ZERO, T::ZERO));
        for m in frequencies() {
            let (from, to) = (self.column(m), m.rem_euclid(width as isize) as usize);
            for j in 0..=height / 2 {
                self.rows[j * width + to] = self.columns[from + j];
            }
        }
        self.transforms.phi_inverse.process_with_scratch(&mut self.rows, &mut self.scratch);
        // Products are real: two rows go back as one.
        let pairs = (height / 2 + 1).div_ceil(2);
        for pair in 0..pairs {
            for i in 0..width {
                let product = |row: usize| self.rows.get(row * width + i).map_or(T::ZERO, |value| value.re * value.im);
                let both = Complex::new(product(2 * pair), product(2 * pair + 1));
                self.rows[pair * width + i] = both;
            }
        }
        self.transforms.phi.process_with_scratch(&mut self.rows[..pairs * width], &mut self.scratch);

        let half = T::of(0.5);
        for m in 0..order {
            let from = self.column(m as isize);
            for j in 0..=height / 2 {
                let row = &self.rows[j / 2 * width..][..width];
                let (plus, minus) = (row[m], row[(width - m) % width]);
                let value = if j.is_multiple_of(2) {
                    Complex::new(half * (plus.re + minus.re), half * (plus.im - minus.im))
                } else {
                    Complex::new(half * (plus.im + minus.im), half * (minus.re - plus.re))
                };
                self.columns[from + j] = value;
                // At -θ: half a turn further.
                let turned =
                    if m.is_multiple_of(2) { value } else { Complex::new(T::ZERO - value.re, T::ZERO - value.im) };
                self.columns[from + (height - j) % height] = turned;
            }
        }
        self.transforms.theta.process_with_scratch(&mut self.columns[..order * height], &mut self.scratch);
        let size = (height * width) as f64;
        run(Gather { order, height, size, table: &self.backward, columns: &self.columns, out });
    }
}
