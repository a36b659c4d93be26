//! Statistics of estimates: z-tests against known values, and the distributions that they need.

mod beta_gamma;
mod normal;
mod z_test;

pub use beta_gamma::{chi_squared_survival, student_survival};
pub use normal::{normal_quantile_above, normal_survival};
pub use z_test::{ZSummary, equivalent_z, z_test};
