//! The whole product series by eigenanalysis.

use super::{ExpWorkspace, LARGEST, Work, renormalise};
use crate::eigen::SymmetricEigen;
use crate::order::{MAX_COEFFICIENTS, SQRT_4_PI, assert_vector};
use halflight_sh_kernels::Real;

/// The product matrix and its decomposition.
#[derive(Clone, Debug, Default)]
pub(super) struct EigenScratch {
    matrix: Vec<f64>,
    eigen: SymmetricEigen,
}

impl<T: Real> ExpWorkspace<T> {
    /// The sum of the whole product series, `1 + Rᵀ q(D) R f` with `q(x) = (eˣ - 1)/x` (Ren 2006, eqs. 26–29), in `f64`.
    ///
    /// Since `M_f 1 = f`, this is `Rᵀ e^D R 1`, which is what is computed: one formula for small and huge eigenvalues.
    /// No products or squares are counted; the cost is an `n²×n²` eigen-decomposition.
    ///
    /// # Panics
    /// If a slice does not hold `n²` coefficients.
    pub fn eigen(&mut self, f: &[T], out: &mut [T]) -> Work {
        assert_vector(self.order, f);
        assert_vector(self.order, out);
        let size = f.len();
        let EigenScratch { matrix, eigen } = &mut self.eigen;
        let mut buffer = [0.0; MAX_COEFFICIENTS];
        let vector = &mut buffer[..size];
        vector.iter_mut().zip(f).for_each(|(v, c)| *v = c.to_f64());
        let scale = renormalise(vector).exp2();
        matrix.resize(size * size, 0.0);
        self.gamma.product_matrix(vector, matrix);
        eigen.decompose(size, matrix);

        // Divided by the largest factor, which a result out of bounds does not get back in full.
        let largest = scale * eigen.largest();
        vector.fill(0.0);
        vector[0] = SQRT_4_PI;
        eigen.apply(vector, |value| (scale * value - largest).exp());
        let factor = largest.exp().min(LARGEST / SQRT_4_PI);
        out.iter_mut().zip(&*vector).for_each(|(o, v)| *o = T::from_f64(factor * v));
        Work::default()
    }
}
