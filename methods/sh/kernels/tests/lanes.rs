//! Every operation of lanes on every instruction set against arithmetic in `f64`.

use halflight_sh_kernels::{Block, LANES, Lanes, Real, Simd, Task, run};

/// Results by the names of their operations.
type Results<T> = Vec<(&'static str, Block<T>)>;

struct Operations<'a, T: Real> {
    a: Block<T>,
    b: Block<T>,
    c: Block<T>,
    table: [T; 16],
    results: &'a mut Results<T>,
}

impl<T: Real> Task<T> for Operations<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        assert_eq!(LANES % V::WIDTH, 0);
        for part in 0..LANES / V::WIDTH {
            let [a, b, c] = [self.a, self.b, self.c].map(|block| V::load(&block.0, part));
            let number = a.abs().min(V::constant(15.0)).floor();
            let values = [
                ("splat", V::splat(self.table[3])),
                ("constant", V::constant(0.3)),
                ("add", a.add(b)),
                ("sub", a.sub(b)),
                ("mul", a.mul(b)),
                ("div", a.div(b)),
                ("mul_add", a.mul_add(b, c)),
                ("neg_mul_add", a.neg_mul_add(b, c)),
                ("sqrt", a.abs().sqrt()),
                ("rsqrt", a.abs().rsqrt()),
                ("min", a.min(b)),
                ("max", a.max(b)),
                ("floor", a.floor()),
                ("pow2", a.floor().pow2()),
                ("exponent", a.abs().exponent()),
                ("where_less", a.where_less(b, c, a)),
                ("select_from", number.select_from(&self.table)),
                ("first", V::splat(a.first())),
                ("any_less", if a.any_less(b) { V::constant(1.0) } else { V::constant(0.0) }),
            ];
            if part == 0 {
                self.results.extend(values.iter().map(|(name, _)| (*name, Block::ZERO)));
            }
            for ((_, block), (_, value)) in self.results.iter_mut().zip(values) {
                value.store(&mut block.0, part);
            }
        }
    }
}

/// What an operation is to give in a lane, and whether it may be off by a rounding.
fn expected<T: Real>(name: &str, width: usize, lane: usize, [a, b, c]: [&Block<T>; 3], table: &[T; 16]) -> (f64, f64) {
    let [x, y, z] = [a, b, c].map(|block| block.0[lane].to_f64());
    let rounding = T::EPSILON.to_f64() * ((x * y).abs() + z.abs());
    let part = lane / width * width..(lane / width + 1) * width;
    let less = |lane: usize| a.0[lane] < b.0[lane];
    match name {
        "splat" => (table[3].to_f64(), 0.0),
        "constant" => (T::from_f64(0.3).to_f64(), 0.0),
        "add" => (x + y, 0.0),
        "sub" => (x - y, 0.0),
        "mul" => (x * y, 0.0),
        "div" => (x / y, 0.0),
        "mul_add" => (x * y + z, rounding),
        "neg_mul_add" => (z - x * y, rounding),
        "sqrt" => (x.abs().sqrt(), 0.0),
        "rsqrt" => (1.0 / x.abs().sqrt(), 4.0 * T::EPSILON.to_f64() / x.abs().sqrt()),
        "min" => (if less(lane) { x } else { y }, 0.0),
        "max" => (if x > y { x } else { y }, 0.0),
        "floor" => (x.floor(), 0.0),
        "pow2" => (x.floor().exp2(), 0.0),
        "exponent" => (x.abs().log2().floor(), 0.0),
        "where_less" => (if less(lane) { z } else { x }, 0.0),
        "select_from" => (table[x.abs().min(15.0).floor() as usize].to_f64(), 0.0),
        "first" => (a.0[part.start].to_f64(), 0.0),
        "any_less" => (f64::from(u8::from(part.clone().any(less))), 0.0),
        other => panic!("{other}"),
    }
}

fn check_operations<T: Real>(simd: Simd, width: usize) {
    for round in 0..40 {
        let wave = |phase: f64, size: f64| {
            Block(std::array::from_fn(|lane| T::from_f64(size * (7.3 * (lane * 40 + round) as f64 + phase).sin())))
        };
        let (mut a, b, c) = (wave(0.1, 17.0), wave(1.3, 11.0), wave(2.9, 3.0));
        if round % 4 == 0 {
            a = Block(b.0.map(|value| value + T::ONE)); // none is less
        }
        [2, 9].into_iter().for_each(|lane| a.0[lane] = b.0[lane]);
        let table = wave(4.0, 5.0).0;
        let mut results = Results::new();
        run(simd, Operations { a, b, c, table, results: &mut results });
        assert_eq!(results.len(), 19);
        for (name, got) in results {
            for lane in 0..LANES {
                let (want, slack) = expected(name, width, lane, [&a, &b, &c], &table);
                let (want, got) = (T::from_f64(want).to_f64(), got.0[lane].to_f64());
                assert!((got - want).abs() <= slack, "{name}, {simd:?}, lane {lane}: {got} instead of {want}");
            }
        }
    }
}

#[test]
fn operations_are_those_of_arithmetic() {
    for (simd, single, double) in [(Simd::Portable, 1, 1), (Simd::Avx2, 8, 4), (Simd::Avx512, 16, 8)] {
        if simd.is_available() {
            check_operations::<f32>(simd, single);
            check_operations::<f64>(simd, double);
        }
    }
}

/// Transposes there and back, and sums of rows.
struct Moves<'a, T> {
    vectors: &'a [T],
    blocks: &'a mut [Block<T>],
    back: &'a mut [T],
    sums: &'a mut [T],
    width: &'a mut usize,
}

const SIZE: usize = 16;

impl<T: Real> Task<T> for Moves<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        *self.width = V::WIDTH;
        for part in 0..LANES / V::WIDTH {
            let from = part * V::WIDTH * SIZE;
            for first in (0..SIZE).step_by(V::TILE) {
                V::transpose_in(&self.vectors[from + first..], SIZE, &mut self.blocks[first..], part);
                V::transpose_out(&self.blocks[first..], part, &mut self.back[from + first..], SIZE);
            }
        }
        V::sum_rows(self.blocks, self.sums);
    }
}

fn check_moves<T: Real>(simd: Simd) {
    let vectors: Vec<T> = (0..LANES * SIZE).map(|i| T::from_f64(i as f64)).collect();
    let mut blocks = vec![Block::<T>::ZERO; SIZE];
    let (mut back, mut sums, mut width) = (vec![T::ZERO; vectors.len()], vec![T::ZERO; SIZE - 3], 0);
    let task = Moves { vectors: &vectors, blocks: &mut blocks, back: &mut back, sums: &mut sums, width: &mut width };
    run(simd, task);
    for (i, block) in blocks.iter().enumerate() {
        for (lane, value) in block.0.iter().enumerate() {
            assert_eq!(*value, vectors[lane * SIZE + i], "{simd:?}, coefficient {i}, lane {lane}");
        }
    }
    assert_eq!(back, vectors, "{simd:?}");
    for (block, sum) in blocks.iter().zip(sums) {
        let want: f64 = block.0[..width].iter().map(|value| value.to_f64()).sum();
        assert_eq!(sum.to_f64(), want, "{simd:?}: small integers sum exactly");
    }
}

#[test]
fn coefficients_move_between_vectors_and_blocks() {
    for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
        check_moves::<f32>(simd);
        check_moves::<f64>(simd);
    }
}
