//! The rows, paper by paper, in each paper's order.

mod ambient;
mod cost;
mod counts;
mod cuts;
mod errors;
mod heights;
mod horizons;
mod linear;
mod proxies;
mod series;
mod speed;
mod swaths;

pub(crate) use cuts::Seams;
pub(crate) use heights::swaying;

use super::row::Row;
use crate::Error;

/// All rows.
pub const ROWS: &[Row] = &[
    counts::S1,
    cost::S2,
    speed::S3,
    speed::S4,
    linear::S5,
    proxies::S6,
    errors::S7,
    series::S8,
    cuts::S9,
    cuts::S10,
    ambient::S11,
    heights::H1,
    heights::H2,
    heights::H3,
    horizons::H4,
    horizons::H5,
    swaths::H6,
    swaths::H7,
];

/// The rows of these ids, all if there are none.
///
/// # Errors
/// There is no such row.
pub fn chosen(ids: &[String]) -> Result<Vec<&'static Row>, Error> {
    if ids.is_empty() {
        return Ok(ROWS.iter().collect());
    }
    let known = || ROWS.iter().map(|row| row.id);
    let find = |id: &String| ROWS.iter().find(|row| row.id == id).ok_or_else(|| Error::unknown("row", id, known()));
    ids.iter().map(find).collect()
}
