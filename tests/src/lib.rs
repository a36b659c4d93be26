//! Contract checks for any method, and mock methods that prove the checks.
//!
//! [`checks`] takes a method as the rest of the house does, through the trait alone, and finds where it breaks the
//! contract; [`fixtures`] are small scenes to run it on; [`mocks`] are five small methods that keep the contract, each
//! with a twin that breaks it. [`stress`] finds what sphere blockers do at the limits of numbers. [`identities`] holds any spherical harmonics code against what it must obey.
//!
//! ```
//! use halflight_tests::{checks, fixtures, mocks};
//!
//! let scenes = fixtures::all();
//! for pair in &mocks::PAIRS {
//!     assert_eq!(checks::check_all(pair.honest, &scenes), []);
//!     let violations = checks::check_all(pair.twin, &scenes);
//!     assert!(violations.iter().any(|violation| violation.check == pair.caught_by));
//! }
//! ```

pub mod checks;
pub mod fixtures;
pub mod identities;
pub mod mocks;
pub mod stress;
