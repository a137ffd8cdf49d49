//! The words of nearly every command. Modules that they come from do not use this one.

pub(crate) use crate::files;
pub(crate) use crate::repo::{Plant, Repo, Words, execute, output_of, run_reading};
pub(crate) use crate::report::{Counts, none_of, skipped};
pub(crate) use crate::session::{MAIN, Session};
pub(crate) use crate::tally::counted;
pub(crate) use anyhow::{Context, Result, anyhow, bail, ensure};
pub(crate) use std::path::{Path, PathBuf};
pub(crate) use std::process::Command;
