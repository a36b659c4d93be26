//! Views on the device, and the tables of their wedges.

use std::sync::Arc;

use halflight_contract::{Meter, Result};
use halflight_gpu::{Gpu, Part, Resident};

use super::words;
use crate::plan::Plan;
use crate::table::Wedges;

/// A plan's views.
#[derive(Default)]
pub(super) struct Views {
    tables: Vec<(Arc<Wedges>, Resident)>,
    shown: Vec<Shown>,
}

/// One of them.
struct Shown {
    settings: Resident,
    wedges: Resident,
    /// The number of its tables.
    tables: usize,
}

impl Views {
    /// Uploads a new plan's wedges, and tables that are not there yet.
    pub(super) fn show(&mut self, gpu: &Gpu, plan: &Plan, meter: &mut dyn Meter) -> Result<()> {
        self.shown.clear();
        for view in &plan.views {
            let tables = self.tables(gpu, &view.tables, meter)?;
            let [settings, mut wedges] = ["view", "wedges"].map(Resident::new);
            wedges.upload(gpu, meter, &words::wedges(view.tables.order, &view.wedges))?;
            self.shown.push(Shown { settings, wedges, tables });
        }
        Ok(())
    }

    fn tables(&mut self, gpu: &Gpu, wanted: &Arc<Wedges>, meter: &mut dyn Meter) -> Result<usize> {
        if let Some(known) = self.tables.iter().position(|(tables, _)| Arc::ptr_eq(tables, wanted)) {
            return Ok(known);
        }
        let mut buffer = Resident::new("wedge tables");
        buffer.upload(gpu, meter, &words::tables(wanted))?;
        self.tables.push((wanted.clone(), buffer));
        Ok(self.tables.len() - 1)
    }

    /// Uploads how the views are looked at, by their numbers.
    pub(super) fn set(&mut self, gpu: &Gpu, meter: &mut dyn Meter, settings: impl Fn(usize) -> Vec<u32>) -> Result<()> {
        let mut shown = self.shown.iter_mut().enumerate();
        Ok(shown.try_for_each(|(number, shown)| shown.settings.upload(gpu, meter, &settings(number)))?)
    }

    /// How a view is looked at, its wedges and its tables.
    pub(super) fn parts(&self, view: usize) -> [Part<'_>; 3] {
        let Shown { settings, wedges, tables } = &self.shown[view];
        [settings.whole(), wedges.whole(), self.tables[*tables].1.whole()]
    }

    /// Bytes on the device: of tables, of all else.
    pub(super) fn bytes(&self) -> [u64; 2] {
        let views = self.shown.iter().map(|shown| shown.settings.bytes() + shown.wedges.bytes());
        [self.tables.iter().map(|(_, buffer)| buffer.bytes()).sum(), views.sum()]
    }
}
