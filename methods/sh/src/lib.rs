//! The algebra of low-order spherical harmonics (SH) that soft-shadow methods share: evaluation, projection, products,
//! rotations, and the logarithm and exponential that turn products of visibility into sums (Ren et al. 2006).
//!
//! # Conventions
//!
//! - Real basis, orthonormal over the sphere, no Condon–Shortley phase, z up: `y_1 = 0.488603·(y, z, x)`.
//! - Order `n` means bands `0..n`, that is `n²` coefficients with index `i = l(l+1) + m`; orders 1 to [`MAX_ORDER`].
//! - A zonal vector holds one value a band, the plain coefficient of `y_l0`.
//! - Directions are unit vectors; visibility is 1 where open, 0 where blocked.
//! - Tables and eigen-decompositions are in `f64`; what runs per receiver is generic over [`Real`] (`f32`, `f64`).
//!
//! The order is an argument and vectors are slices. A wrong order or slice length is a programming error and panics:
//! check an order that a user gave with [`check_order`] first.
//!
//! # One vector or sixteen
//!
//! Functions on slices take one vector. [`Batch`] and [`BatchExp`] take [`Block`]s, 16 vectors side by side, by the widest
//! instructions that the machine has; forms, counts, times and errors are in the crate's `README.md`.
//!
//! ```
//! use halflight_sh::{Batch, Block, blocks_for, pack, unpack};
//!
//! let (order, vectors) = (4, vec![0.1f32; 100 * 16]);
//! let mut a = vec![Block::ZERO; blocks_for(order, 100)];
//! pack(order, &vectors, &mut a);
//! let mut square = a.clone();
//! Batch::new(order).square(&a, &mut square);
//! let mut squares = vectors.clone();
//! unpack(order, &square, &mut squares);
//! ```
//!
//! # From blockers to a shadow
//!
//! ```
//! use halflight_sh::{CircleTable, ExpWorkspace, SquaringRule, irradiance_weights, rotate_zonal};
//!
//! let order = 4;
//! let (mut zonal, mut lobe, mut log) = ([0.0f32; 4], [0.0f32; 16], [0.0f32; 16]);
//! for axis in [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8]] {
//!     CircleTable::log(order).lookup(0.3, &mut zonal); // a sphere of angular radius asin 0.3
//!     rotate_zonal(order, &zonal, axis, &mut lobe);
//!     log.iter_mut().zip(&lobe).for_each(|(sum, l)| *sum += l);
//! }
//! let mut visibility = [0.0f32; 16];
//! ExpWorkspace::new(order).hybrid(SquaringRule::default(), &log, &mut visibility);
//!
//! let mut weights = [0.0f32; 16];
//! irradiance_weights(order, [0.0, 0.0, 1.0], &mut weights);
//! let shade: f32 = weights.iter().zip(&visibility).map(|(w, v)| w * v).sum();
//! assert!(0.6 < shade && shade < 0.9);
//! ```

mod basis;
mod batch;
mod block;
mod circle;
mod eigen;
mod exp;
mod gamma;
mod guard;
mod log;
mod order;
mod pieces;
mod quadrature;
mod rotation;
mod small;
mod table;
pub mod wgsl;
mod zonal;

pub use basis::evaluate;
pub use batch::{Batch, BatchExp, BatchLog, product, square};
pub use block::{blocks_for, pack, unpack};
pub use circle::{CircleTable, circle_log, circle_visibility};
pub use eigen::SymmetricEigen;
pub use exp::{ExpWorkspace, SquaringRule, Work, exact as exp_exact};
pub use gamma::{Gamma, Triple, gamma};
pub use guard::project_binary_bound;
pub use halflight_sh_kernels::{Block, LANES, Lanes, Real, Simd, Task, run};
pub use log::{EIGENVALUE_CLIP, log_eigen, log_naive};
pub use order::{MAX_ORDER, OrderError, check_order, coefficients, index};
pub use quadrature::{Quadrature, gauss_legendre, project};
pub use rotation::{Rotation, rotate_z};
pub use zonal::{apply_bands, clamped_cosine, irradiance_weights, rotate_zonal, window};
