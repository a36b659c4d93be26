//! The denominator of speed-ups: one product at a time in well-compiled scalar code with as many instructions as the public
//! generated code has (DirectXMath's, which no registry carries: 120, 399, 1135 and 2527 at orders 3 to 6).

#[rustfmt::skip] // as the generator prints it
mod plain;

/// One lane.
trait Scalar {
    fn constant(value: f64) -> Self;
    fn mul(self, other: Self) -> Self;
}

impl Scalar for f32 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value as f32
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self * other
    }
}

trait Vector {
    fn get(&self, i: usize) -> f32;
}

trait VectorMut {
    fn set(&mut self, i: usize, value: f32);
}

impl<const N: usize> Vector for [f32; N] {
    #[inline(always)]
    fn get(&self, i: usize) -> f32 {
        self[i]
    }
}

impl<const N: usize> VectorMut for [f32; N] {
    #[inline(always)]
    fn set(&mut self, i: usize, value: f32) {
        self[i] = value;
    }
}

/// The scalar product of an order from 2 to 6.
///
/// # Panics
/// At other orders, for slices of the wrong length, and on machines without AVX2 and FMA.
pub(crate) fn plain_product(order: usize, a: &[f32], b: &[f32], out: &mut [f32]) {
    assert!(is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"));
    macro_rules! call {
        ($f:ident) => {{
            let [a, b] = [a, b].map(|v| v.try_into().expect("n² coefficients"));
            // SAFETY: the features were just found.
            unsafe { plain::$f(a, b, out.try_into().expect("n² coefficients")) }
        }};
    }
    match order {
        2 => call!(order_2),
        3 => call!(order_3),
        4 => call!(order_4),
        5 => call!(order_5),
        6 => call!(order_6),
        _ => panic!("order {order}: expected 2 to 6"),
    }
}
