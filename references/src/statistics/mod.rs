//! Statistics of estimates: tests against each other and known values, of normality, and the distributions that they need.

mod anderson_darling;
mod beta_gamma;
mod comparison;
mod normal;
#[cfg(test)]
mod random;
mod z_test;

pub use anderson_darling::normality_p;
pub use beta_gamma::{chi_squared_survival, student_survival};
pub use comparison::{Comparison, compare, compare_exact};
pub use normal::{normal_quantile_above, normal_survival};
pub use z_test::{ZSummary, equivalent_z, z_test};
