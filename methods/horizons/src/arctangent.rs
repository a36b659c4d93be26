//! A fast arctangent.

use halflight_sh_kernels::Lanes;

/// Minimax odd polynomial of the arctangent on `[0, 1]`, off by 2.5e-7.
pub(crate) const ODD: [f64; 7] = [
    0.9999961115523283,
    -0.333173680578157,
    0.19807815570647824,
    -0.1323334207348316,
    0.07962367149851794,
    -0.033604219563467166,
    0.00681179290670858,
];

/// The angle in radians of a tangent, within 5e-7 for every `f32`, infinities included; one division (the paper takes Hastings'
/// polynomials). NaN gives a finite angle.
#[inline(always)]
pub(crate) fn arctangent<V: Lanes<Scalar = f32>>(tangent: V) -> V {
    let one = V::constant(1.0);
    let zero = V::constant(0.0);
    let size = tangent.abs();
    // `min` first, so that NaN becomes 1.
    let below = size.min(one);
    // Seldom is anything as steep as that, and a quotient takes as long as all else.
    let steep = below.any_less(size);
    let ratio = if steep { below.div(size.max(one)) } else { below };
    let square = ratio.mul(ratio);
    let mut sum = V::constant(ODD[6]);
    for coefficient in ODD[..6].iter().rev() {
        sum = sum.mul_add(square, V::constant(*coefficient));
    }
    let angle = sum.mul(ratio);
    let angle = match steep {
        true => one.where_less(size, V::constant(std::f64::consts::FRAC_PI_2).sub(angle), angle),
        false => angle,
    };
    tangent.where_less(zero, zero.sub(angle), angle)
}

#[cfg(test)]
mod tests {
    use halflight_sh_kernels::{Lanes, Simd, Task, run};

    use super::arctangent;

    struct All<'a>(&'a [f32; 16], &'a mut [f32; 16]);

    impl Task<f32> for All<'_> {
        #[inline(always)]
        fn run<V: Lanes<Scalar = f32>>(self) {
            for lane in (0..16).step_by(V::WIDTH) {
                arctangent(V::load(self.0, lane / V::WIDTH)).store(self.1, lane / V::WIDTH);
            }
        }
    }

    #[test]
    fn it_is_within_its_error_over_all_of_its_range() {
        for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
            let mut worst = 0.0_f64;
            let mut check = |first: u32, stride: u32| {
                let tangents: [f32; 16] = std::array::from_fn(|lane| f32::from_bits(first + lane as u32 * stride));
                let mut angles = [f32::NAN; 16];
                run(simd, All(&tangents, &mut angles));
                for (tangent, angle) in tangents.into_iter().zip(angles) {
                    worst = worst.max((f64::from(angle) - f64::from(tangent).atan()).abs());
                    assert!(angle.abs() <= std::f32::consts::FRAC_PI_2, "{tangent}: {angle}");
                }
            };
            // Every size of number: 0 to infinity, and the same below 0.
            for sign in [0, 1 << 31] {
                (0..0x7f80_0000 / (16 * 997)).for_each(|step| check(sign + step * 16 * 997, 997));
                check(sign + 0x7f80_0000 - 15, 1);
            }
            assert!(worst < 5e-7, "{simd:?}: {worst}");
        }
    }
}
