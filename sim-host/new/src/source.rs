//! Where a project finds Staya.

use anyhow::{Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};

/// A clone of Staya's repository on this computer, or its address.
pub(crate) enum Source {
    Folder { root: PathBuf, text: String },
    Address(String),
}

impl Source {
    /// What was said, or else the repository that this program was built from.
    ///
    /// # Errors
    /// No such folder, or a path or address that the files of a project cannot hold.
    pub(crate) fn find(said: Option<&str>) -> Result<Self> {
        let is_address = |text: &&str| text.contains("://") || text.starts_with("git@");
        if let Some(address) = said.filter(is_address) {
            ensure!(is_plain(address), "{address}: an address with blanks or quotes; take it without");
            return Ok(Self::Address(address.to_string()));
        }
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        let folder = said.map_or_else(|| here.ancestors().nth(2).unwrap_or(here), Path::new);
        let is_there = folder.join("controller/Cargo.toml").is_file() && folder.join("sim-host/sim").is_dir();
        let shown = folder.display();
        let why = match said {
            Some(_) => {
                format!("{shown}: no repository of Staya's; give --staya the folder of a clone, or an address for git")
            }
            None => format!(
                "the sources that this program was built from are not at {shown} any more; say where they are by --staya PATH or --staya URL"
            ),
        };
        ensure!(is_there, "{why}");
        let root = fs::canonicalize(folder)?;
        let text = root.to_str().map(|text| text.replace('\\', "/")).filter(|text| is_plain(text));
        let text = text.ok_or_else(|| {
            anyhow::anyhow!(
                "{}: blanks, quotes, $ or # in the path of Staya's sources, which Makefiles cannot hold; move them",
                root.display()
            )
        })?;
        Ok(Self::Folder { root, text })
    }

    /// A template as the file of a project of this name.
    pub(crate) fn fill(&self, template: &str, name: &str) -> String {
        let text = template.replace("my-swarm", name).replace("my_swarm", &name.replace('-', "_"));
        match self {
            Self::Folder { text: folder, .. } => text.replace("/STAYA_URL", "").replace("/STAYA", folder),
            Self::Address(address) => {
                // Cargo finds a package by its name in a repository.
                let lines = text.split_inclusive('\n').map(|line| match line.split_once("path = \"/STAYA/") {
                    Some((before, rest)) => {
                        let after = rest.split_once('"').map_or("", |(_, after)| after);
                        format!("{before}git = \"{address}\"{after}")
                    }
                    None => line.replace("staya @ file:///STAYA", &format!("staya @ git+{address}")),
                });
                // What is no package is cloned beside what is built.
                lines.collect::<String>().replace("/STAYA_URL", address).replace("/STAYA", "build/staya")
            }
        }
    }

    /// A lock file of this repository, if it is a folder.
    pub(crate) fn lock(&self, path: &str) -> Option<String> {
        match self {
            Self::Folder { root, .. } => fs::read_to_string(root.join(path)).ok(),
            Self::Address(_) => None,
        }
    }
}

/// Whether TOML, Makefiles and shells take it as it is.
fn is_plain(text: &str) -> bool {
    !text.contains(|c: char| c.is_whitespace() || c.is_control() || "\"'`$#\\&;".contains(c))
}
