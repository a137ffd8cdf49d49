//! Figures of papers: plans in `papers/PAPER/FIGURE/figure.toml`.

use crate::error::SweepError;
use crate::sweep::Plan;
use crate::sweep::report::VERDICT;
use anyhow::Result;
use staya_sim::record::Error;
use staya_sim::scenario::nearest;
use staya_sim::shown::Shown as _;
use std::fs;
use std::path::{Path, PathBuf};

const FILE: &str = "figure.toml";
const HERE: &str = "papers";
/// The checkout that the program was built in.
const CHECKOUT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../papers");
/// From the folder of an installed program; `cargo xtask install` puts the figures there.
const INSTALLED: &str = "../share/staya/papers";

/// A figure of a paper.
#[derive(Clone, Debug)]
pub struct Figure {
    /// File of the plan.
    pub path: PathBuf,
    /// `PAPER/FIGURE`.
    pub place: String,
    /// Short name; results go to `out/experiments/NAME`.
    pub name: String,
    /// Title of the plan; may be empty.
    pub title: String,
}

impl Figure {
    /// Folder of the results.
    #[must_use]
    pub fn out(&self) -> PathBuf {
        Path::new("out/experiments").join(&self.name)
    }

    /// Verdict on the last complete run; `None` without one.
    #[must_use]
    pub fn verdict(&self) -> Option<String> {
        let text = fs::read_to_string(self.out().join(VERDICT)).ok()?;
        text.lines().next().map(str::to_owned)
    }
}

/// All figures, sorted by place: those below `papers/` here, else of the checkout of the program,
/// else of its installation.
///
/// # Errors
/// A folder or a figure cannot be read.
pub fn all() -> Result<Vec<Figure>> {
    let program = std::env::current_exe().unwrap_or_default();
    let installed = program.parent().unwrap_or(Path::new("")).join(INSTALLED);
    all_below([Path::new(HERE), Path::new(CHECKOUT), &installed])
}

/// The figures below the first of these folders that exists.
fn all_below(roots: [&Path; 3]) -> Result<Vec<Figure>> {
    let Some(root) = roots.into_iter().find(|root| root.is_dir()) else {
        let what = "there is no such folder here, in the program's checkout or installed";
        return Err(SweepError::new(HERE, what, "change to a checkout, or name the file of a plan").into());
    };
    let mut figures = Vec::new();
    for path in folders(root)?.iter().map(|paper| folders(paper)).collect::<Result<Vec<_>, _>>()?.concat() {
        let file = path.join(FILE);
        if file.is_file() {
            let (name, title) = Plan::title(&file)?;
            let place = path.strip_prefix(root).unwrap_or(&path).shown().to_string();
            figures.push(Figure { path: file, place, name, title });
        }
    }
    Ok(figures)
}

fn folders(root: &Path) -> Result<Vec<PathBuf>, Error> {
    let entries = fs::read_dir(root).map_err(Error::new("read directory", root))?;
    let mut folders: Vec<_> = entries.flatten().map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    folders.sort();
    Ok(folders)
}

/// The figure with this short name or place, or the plan in this file.
///
/// # Errors
/// There is no such figure, or it cannot be read.
pub fn find(name: &str) -> Result<Figure> {
    let path = PathBuf::from(name);
    if path.is_file() {
        let (short, title) = Plan::title(&path)?;
        return Ok(Figure { path, place: name.to_owned(), name: short, title });
    }
    let figures = all()?;
    let place = name.trim_end_matches('/').trim_start_matches("papers/");
    if let Some(figure) = figures.iter().find(|figure| figure.name == name || figure.place == place) {
        return Ok(figure.clone());
    }
    let names = figures.iter().flat_map(|figure| [&figure.name, &figure.place]).map(String::as_str);
    let remedy = match nearest(name, names) {
        Some(near) => format!("did you mean {near}?"),
        None => "`staya experiment` lists all".to_owned(),
    };
    Err(SweepError::new(name, "there is no such experiment", remedy).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_folder_with_figures_counts() {
        let dir = tempfile::tempdir().unwrap();
        let root = |name: &str| dir.path().join(name);
        for name in ["checkout", "installed"] {
            let folder = root(name).join("paper/figure-1");
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join(FILE), format!("name = '{name}'\nscenario = 'x.toml'\n")).unwrap();
        }
        let [here, checkout, installed] = ["here", "checkout", "installed"].map(root);
        let names = |roots: [&Path; 3]| -> Vec<String> {
            all_below(roots).unwrap().into_iter().map(|figure| figure.name).collect()
        };
        assert_eq!(names([&here, &checkout, &installed]), ["checkout"]);
        assert_eq!(names([&here, &here, &installed]), ["installed"]);
        let none = all_below([&here; 3]).unwrap_err().to_string();
        assert!(none.contains("change to a checkout"), "{none}");
    }
}
