//! How far a picture is from a reference: error measures, the comparator of the gates, and statistics of repeats.
//!
//! [`compare`] measures over the receivers that are valid in both pictures. A difference is one channel of one receiver,
//! `d = x − r`, in linear radiance:
//!
//! | measure | definition |
//! |---|---|
//! | RMSE | `√mean(d²)`; with its standard error by the reference's noise |
//! | relative MSE | `mean(d² / (r² + 0.01))` |
//! | mean absolute error | `mean(abs(d))` |
//! | bias | `mean(d)`, signed: negative is too dark |
//! | max | `max(abs(d))` |
//! | 99th percentile | of `abs(d)`, linearly interpolated |
//! | SSIM | Wang et al. 2004, on display luminance (see [`Exposure`]); images only |
//! | FLIP | Andersson et al. 2020, on display colours (see [`Exposure`]); images only |
//!
//! [`difference()`] takes two pictures that may both be noisy, and tells how far apart they are without the noise. [`apart()`] takes two
//! that ought to be equal, as of one method on two processors. [`fingerprint()`] is what a picture is known by: means of blocks, small
//! enough for a text file.
//!
//! SSIM and FLIP judge displayed pictures: both pictures are exposed alike, by the *reference's* exposure.

mod agree;
mod apart;
mod difference;
mod display;
mod fingerprint;
mod pareto;
mod perceptual;
mod picture;
mod scores;
mod statistics;

pub use agree::{Disagreement, Tolerance, agrees};
pub use apart::{Apart, apart};
pub use difference::{Difference, difference};
pub use display::Exposure;
pub use fingerprint::{Block, COLUMNS, Fingerprint, ROWS, fingerprint};
pub use pareto::{Measured, Standing, geometric_mean, standings};
pub use picture::{CompareError, Layout, Picture};
pub use scores::{Scores, VERSION, compare};
pub use statistics::{Interval, confidence, median, median_interval, outliers, percentile};
