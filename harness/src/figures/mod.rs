//! A paper's figures and tables, each reproduced by its name.
//!
//! A [`Figure`] is one of them: where the paper has it, what it shows (data), and how its page is made (`Figure::make`). A paper
//! has a folder, a figure a file, and a line in the folder's `FIGURES`. What a figure claims in numbers is a row of the ledger:
//! its page measures that row (`claims.rs`) rather than measure the same another way.

mod claims;
mod hw;
mod seeing;
mod sequence;
mod shexp;

use crate::Error;
use crate::ledger::{Bench, Terms};
use halflight_reports::{ReportError, Sheet};
use std::path::{Path, PathBuf};

/// All figures, a list a paper.
const PAPERS: &[&[Figure]] = &[shexp::FIGURES, hw::FIGURES];

/// A figure or table of a paper, or one that a claim of it asks for.
pub struct Figure {
    /// The paper's key and the figure's name, such as `shexp/fig7`.
    pub id: &'static str,
    /// Where the paper has it.
    pub place: &'static str,
    /// What it shows, in a line.
    pub shows: &'static str,
    /// A sentence of what to look at.
    pub look: &'static str,
    /// Puts pictures, plots and numbers on its page.
    pub(crate) make: fn(&Bench, &mut Sheet) -> Result<(), Error>,
}

impl Figure {
    /// Makes the page `index.html` in the folder `<id>` of a folder, and tells where it is.
    ///
    /// # Errors
    /// A reference or method fails, or the page cannot be written.
    pub fn make(&self, terms: &Terms, out: &Path) -> Result<PathBuf, Error> {
        let mut sheet = Sheet::new(&format!("{}: {}", self.place, self.shows), self.look);
        (self.make)(&Bench::new(terms), &mut sheet)?;
        sheet.note(&format!("Made by `halflight figure {}`.", self.id));
        let folder = out.join(self.id);
        std::fs::create_dir_all(&folder).map_err(|source| Error::Io { path: folder.clone(), source })?;
        let page = folder.join("index.html");
        sheet.write(&page)?;
        Ok(page)
    }
}

/// All figures, paper by paper.
pub fn figures() -> impl Iterator<Item = &'static Figure> {
    PAPERS.iter().flat_map(|paper| paper.iter())
}

/// The figures of an id, of `paper/*`, or of several of these, in the order of the list.
///
/// # Errors
/// One of them is of none.
pub fn chosen(ids: &[String]) -> Result<Vec<&'static Figure>, Error> {
    let serves = |id: &str, figure: &Figure| match id.strip_suffix('*') {
        Some(paper) => figure.id.starts_with(paper),
        None => figure.id == id,
    };
    if let Some(id) = ids.iter().find(|id| !figures().any(|figure| serves(id, figure))) {
        return Err(Error::unknown("figure", id, figures().map(|figure| figure.id)));
    }
    Ok(figures().filter(|figure| ids.iter().any(|id| serves(id, figure))).collect())
}

impl From<ReportError> for Error {
    fn from(error: ReportError) -> Self {
        Error::Other(error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn ids_are_unique_and_can_be_paths() {
        let ids: HashSet<&str> = figures().map(|figure| figure.id).collect();
        assert_eq!(ids.len(), figures().count());
        let plain = |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '-');
        assert!(ids.iter().all(|id| id.split('/').count() == 2 && id.split('/').all(plain)), "{ids:?}");
    }

    #[test]
    fn figures_are_chosen_by_name_and_by_paper() {
        let ids = |names: &[&str]| -> Result<Vec<&str>, Error> {
            let names: Vec<String> = names.iter().map(ToString::to_string).collect();
            Ok(chosen(&names)?.iter().map(|figure| figure.id).collect())
        };
        assert_eq!(ids(&["shexp/gamma"]).unwrap(), ["shexp/gamma"]);
        assert_eq!(ids(&["shexp/*"]).unwrap(), shexp::FIGURES.iter().map(|figure| figure.id).collect::<Vec<_>>());
        let told = ids(&["shexp/gamma", "shexp/fig2"]).unwrap_err().to_string();
        assert!(told.starts_with("unknown figure `shexp/fig2`: expected one of shexp/"), "{told}");
    }
}
