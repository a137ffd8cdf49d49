//! `staya migrate`.

use crate::migrate::migrated;
use anyhow::{Context as _, Result};
use clap::Args;
use staya_console::{Ended, Global, say};
use staya_sim::scenario::{ScenarioError, Source};
use staya_sim::shown::Shown as _;
use std::fs;
use std::path::PathBuf;

/// Rewrite scenarios of earlier versions: `law = "NAME"`, and the law's values in a table NAME.
///
/// Comments and the order of fields stay. Files that need no change are not written.
#[derive(Args, Clone, Debug)]
pub struct MigrateArgs {
    /// Scenario files.
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Print the new text instead of writing it.
    #[arg(long)]
    print: bool,
}

impl MigrateArgs {
    /// Rewrites the files.
    ///
    /// # Errors
    /// A file cannot be read, is not TOML, or cannot be written.
    pub fn run(&self, _: &Global) -> Result<Ended> {
        for path in &self.files {
            let shown = path.shown();
            let read = fs::read_to_string(path);
            let text = read.map_err(|source| ScenarioError::Io { path: path.clone(), source })?;
            // Its errors name the place and the remedy.
            Source::new(path, &text)?;
            let changed = migrated(&text).with_context(|| format!("{shown} is not TOML"))?;
            match changed {
                Some(new) if self.print => print!("{new}"),
                Some(new) => {
                    fs::write(path, new).with_context(|| format!("cannot write {shown}"))?;
                    say(&format!("{shown}: rewritten"));
                }
                None => say(&format!("{shown}: unchanged")),
            }
        }
        Ok(Ended::Done)
    }
}
