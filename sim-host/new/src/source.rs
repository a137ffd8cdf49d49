use anyhow::{Result, ensure};
use staya_console::Shown as _;
use std::fs;
use std::path::{Path, PathBuf};

pub(crate) enum Source {
    /// The repository, and its path from the new project's folder.
    Folder {
        root: PathBuf,
        relative: String,
    },
    Address(String),
}

impl Source {
    /// The given source, or the repository from which this program was built, for a project in
    /// `project`.
    pub(crate) fn find(said: Option<&str>, project: &Path) -> Result<Self> {
        let is_address = |text: &&str| text.contains("://") || text.starts_with("git@");
        if let Some(address) = said.filter(is_address) {
            ensure!(is_plain(address), "{address}: the URL contains blanks or quotes; give one without");
            return Ok(Self::Address(address.to_string()));
        }
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        let folder = said.map_or_else(|| here.ancestors().nth(2).unwrap_or(here), Path::new);
        let is_there = folder.join("controller/Cargo.toml").is_file() && folder.join("sim-host/sim").is_dir();
        let shown = folder.shown();
        let why = match said {
            Some(_) => {
                format!("{shown}: not a repository of Staya; give --staya the folder of a clone or a git URL")
            }
            None => format!("the sources of this program are no longer at {shown}; give --staya PATH or --staya URL"),
        };
        ensure!(is_there, "{why}");
        let root = fs::canonicalize(folder)?;
        let parent = project.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        // A missing folder is an error later.
        let parent = fs::canonicalize(parent).or_else(|_| std::path::absolute(parent))?;
        let relative = relative(&parent.join(project.file_name().unwrap_or_default()), &root);
        let relative = relative.to_str().map(|text| text.replace('\\', "/")).filter(|text| is_plain(text));
        let relative = relative.ok_or_else(|| {
            anyhow::anyhow!(
                "{}: the path of Staya's sources contains blanks, quotes, $ or #, which Makefiles do not support; move them",
                root.shown()
            )
        })?;
        Ok(Self::Folder { root, relative })
    }

    /// The text of `file`, a path in the project.
    pub(crate) fn fill(&self, file: &str, template: &str, name: &str) -> String {
        let text = template.replace("my-swarm", name).replace("my_swarm", &name.replace('-', "_"));
        match self {
            Self::Folder { relative, .. } => {
                let up = "../".repeat(file.matches('/').count());
                let text =
                    text.replace("/STAYA_URL", "").replace("/STAYA_ROOT", relative).replace("/STAYA_PIP", relative);
                text.replace("/STAYA", &format!("{up}{relative}"))
            }
            Self::Address(address) => {
                // Cargo finds a package in a repository by its name.
                let lines = text.split_inclusive('\n').map(|line| match line.split_once("path = \"/STAYA/") {
                    Some((before, rest)) => {
                        let after = rest.split_once('"').map_or("", |(_, after)| after);
                        format!("{before}git = \"{address}\"{after}")
                    }
                    None => line.replace("/STAYA_PIP", &format!("git+{address}")),
                });
                // Files outside of packages are in a clone in the build folder.
                let text = lines.collect::<String>().replace("/STAYA_URL", address);
                text.replace("/STAYA_ROOT", "build/staya").replace("/STAYA", "build/staya")
            }
        }
    }

    /// `None` if the source is a URL.
    pub(crate) fn lock(&self, path: &str) -> Option<String> {
        match self {
            Self::Folder { root, .. } => fs::read_to_string(root.join(path)).ok(),
            Self::Address(_) => None,
        }
    }
}

/// The path from one absolute folder to another.
fn relative(from: &Path, to: &Path) -> PathBuf {
    let common = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().skip(common).map(|_| std::path::Component::ParentDir);
    up.chain(to.components().skip(common)).collect()
}

fn is_plain(text: &str) -> bool {
    !text.contains(|c: char| c.is_whitespace() || c.is_control() || "\"'`$#\\&;".contains(c))
}
