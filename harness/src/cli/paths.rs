//! Where the cache lies.

use super::CacheDir;
use anyhow::Context;
use std::path::PathBuf;

impl CacheDir {
    /// The folder given, or the user's cache folder.
    pub(super) fn path(&self) -> anyhow::Result<PathBuf> {
        let absolute = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
        let found = self.cache.clone().or_else(|| Some(absolute("XDG_CACHE_HOME")?.join("halflight")));
        found
            .or_else(|| Some(absolute("HOME")?.join(".cache/halflight")))
            .context("no cache folder: neither XDG_CACHE_HOME nor HOME is set; expected --cache DIR")
    }
}
