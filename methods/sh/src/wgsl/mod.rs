//! The algebra as WGSL, of the same generator and the same tables as the CPU's, so that the two cannot drift apart.
//!
//! A shader is text: [`algebra`] of its order, then its own. Vectors are values of type `Vector` (`array<f32, order²>`), zonal ones
//! `Zonal`; what [`tables`] gives is expected at `tables`, a storage buffer that the shader declares.
//!
//! | function | CPU |
//! |---|---|
//! | `product(a, b)`, `square(a)` | [`Batch::product`](crate::Batch::product), [`Batch::square`](crate::Batch::square) |
//! | `rotate_zonal(zonal, direction)` | [`Batch::rotate_zonal`](crate::Batch::rotate_zonal) |
//! | `scaled_bands(zonal, factors)` | [`Batch::scale`](crate::Batch::scale) |
//! | `circle_visibility(sine)` | [`Batch::circle_visibilities`](crate::Batch::circle_visibilities) |
//! | `circle_light(sine)` | [`Batch::circle_lights`](crate::Batch::circle_lights) |
//! | `circle_log(sine)` | [`Batch::circle_logs`](crate::Batch::circle_logs) |
//! | `optimal_linear(norm)` | the factors of [`BatchExp::optimal_linear`](crate::BatchExp::optimal_linear) |
//! | `guarded(g)` | [`project_binary_bound`](crate::project_binary_bound) |

mod bands;
mod operations;

use std::fmt::Write;

use crate::exp::{linear_pieces, unclipped_norm};
use crate::order::assert_order;
use crate::pieces::{DEGREE, PIECES};
use crate::small::TERMS;

pub use operations::{Operations, operations};

/// What is generated for each order.
const GENERATED: [&str; crate::MAX_ORDER] = [
    include_str!("generated/order_1.wgsl"),
    include_str!("generated/order_2.wgsl"),
    include_str!("generated/order_3.wgsl"),
    include_str!("generated/order_4.wgsl"),
    include_str!("generated/order_5.wgsl"),
    include_str!("generated/order_6.wgsl"),
    include_str!("generated/order_7.wgsl"),
    include_str!("generated/order_8.wgsl"),
];

/// What is the same for all orders.
const COMMON: &str = include_str!("common.wgsl");

/// What is generated for an order, for shaders that need no tables: `ORDER`, `SIZE`, `Zonal`, `Vector`, `CLAMPED_COSINE`, `product`,
/// `square` and `rotate_zonal`.
///
/// # Panics
/// As [`algebra`].
pub fn generated(order: usize) -> &'static str {
    assert_order(order);
    GENERATED[order - 1]
}

/// The functions of an order, to be put before a shader that declares `tables`.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER).
pub fn algebra(order: usize) -> String {
    let mut text = generated(order).to_owned();
    let (small_end, _) = crate::batch::circle_log_fits(order);
    let linear_end = if order > 1 { linear_pieces::<f32>(order).1 } else { 1.0 };
    let constants =
        [("SMALL_END", f64::from(small_end)), ("LINEAR_END", linear_end), ("UNCLIPPED_NORM", unclipped_norm(order))];
    for (name, value) in constants {
        writeln!(text, "const {name}: f32 = {:?}f;", value as f32).expect("a string");
    }
    for (name, value) in [("TERMS", TERMS), ("PIECES", PIECES), ("DEGREE", DEGREE)] {
        writeln!(text, "const {name}: u32 = {value}u;").expect("a string");
    }
    text + COMMON + &bands::functions(order)
}

/// The content of `tables` for an order: the polynomials of small circles' logs, the pieces of large ones', the pieces of the optimal
/// linear factors.
///
/// # Panics
/// As [`algebra`].
pub fn tables(order: usize) -> Vec<f32> {
    assert_order(order);
    let (_, mut values) = crate::batch::circle_log_fits(order);
    if order > 1 {
        linear_pieces::<f32>(order).0.print(&mut values);
    }
    values
}
