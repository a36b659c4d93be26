//! What is asked for: a suite, or scenes, methods and settings, as entries of a plan.

use crate::Error;
use crate::settings::Setting;
use crate::suite::{DEFAULT_REFERENCES, Entry, Suite};

/// The suite that runs when nothing is said.
pub const DEFAULT_SUITE: &str = "quick";

/// What a user asks for.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// A suite's name or path; used alone.
    pub suite: Option<String>,
    /// Scenes by name or path; all shipped ones if none is named.
    pub scenes: Vec<String>,
    /// Method ids; all if none is named.
    pub methods: Vec<String>,
    /// Settings of parameters.
    pub set: Vec<Setting>,
    /// What is computed; `direct` if nothing is named.
    pub quantities: Vec<String>,
    /// References; [`DEFAULT_REFERENCES`] if none is named.
    pub references: Vec<String>,
}

impl Selection {
    /// The entries to plan: those of the suite, or one that holds the scenes, methods and settings; those of the default
    /// suite if nothing is named at all.
    ///
    /// # Errors
    /// There is no such suite, or its file is wrong. Names of scenes and methods are checked when they are planned.
    pub fn entries(&self) -> Result<Vec<Entry>, Error> {
        match &self.suite {
            Some(suite) => Ok(Suite::find(suite)?.entries),
            None if self.names_nothing() => Ok(Suite::find(DEFAULT_SUITE)?.entries),
            None => Ok(vec![self.entry()]),
        }
    }

    /// Whether neither a suite nor any part of a selection is named.
    pub fn names_nothing(&self) -> bool {
        let lists = [&self.scenes, &self.methods, &self.references, &self.quantities];
        self.suite.is_none() && self.set.is_empty() && lists.iter().all(|list| list.is_empty())
    }

    fn entry(&self) -> Entry {
        let or = |named: &[String], all: Vec<String>| if named.is_empty() { all } else { named.to_vec() };
        Entry {
            scenes: or(&self.scenes, halflight_scenes::shipped().into_iter().map(|(name, ..)| name).collect()),
            methods: or(&self.methods, halflight_registry::methods().iter().map(|m| m.info().id.to_owned()).collect()),
            set: self.set.clone(),
            quantities: or(&self.quantities, crate::suite::direct()),
            references: or(&self.references, DEFAULT_REFERENCES.map(str::to_owned).to_vec()),
            frames: None,
        }
    }
}
