//! Sets the version that results record.
//!
//! `STAYA_VERSION` is the package version. In a git repository it continues with `+` and the last
//! commit that changed the sources of results, and with a hash of uncommitted changes to them. So
//! results of different builds differ in version, and a change of documents alone does not.

use std::path::Path;
use std::process::Command;

/// Files that influence results.
const SOURCES: [&str; 7] = [
    "Cargo.lock",
    "controller",
    "sim-host/lab/src",
    "sim-host/plot/src",
    "sim-host/sim/src",
    "sim-host/src",
    "sim-host/stats/src",
];

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for source in SOURCES.iter().map(|source| root.join(source)).filter(|source| source.exists()) {
        println!("cargo::rerun-if-changed={}", source.display());
    }
    if let Some(log) = git(&root, &["rev-parse", "--git-path", "logs/HEAD"]).filter(|log| root.join(log).exists()) {
        println!("cargo::rerun-if-changed={}", root.join(log).display());
    }
    let commit = commit(&root).map_or(String::new(), |commit| format!("+{commit}"));
    println!("cargo::rustc-env=STAYA_VERSION={}{commit}", env!("CARGO_PKG_VERSION"));
}

/// `None` without git or outside its repository.
fn commit(root: &Path) -> Option<String> {
    // The sources may lie inside a foreign repository.
    git(root, &["ls-files", "--error-unmatch", "sim-host/console/build.rs"])?;
    let of_sources = |words: &[&str]| git(root, &[words, &["--"], &SOURCES].concat());
    let commit = of_sources(&["log", "-1", "--abbrev=12", "--format=%h"]).filter(|commit| !commit.is_empty())?;
    let changes = of_sources(&["diff", "HEAD", "--no-ext-diff", "--no-color", "--full-index"])?;
    let new = of_sources(&["ls-files", "--others", "--exclude-standard"])?;
    if changes.is_empty() && new.is_empty() {
        return Some(commit);
    }
    // FNV-1a hash.
    let texts = new.lines().map(|file| std::fs::read_to_string(root.join(file)).unwrap_or_default());
    let all: String = [changes, new.clone()].into_iter().chain(texts).collect();
    let hash = all.bytes().fold(0x811c_9dc5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
    Some(format!("{commit}.{hash:08x}"))
}

/// Output of git; `None` if it fails.
fn git(root: &Path, words: &[&str]) -> Option<String> {
    let done = Command::new("git").arg("-C").arg(root).args(words).output().ok()?;
    let said = String::from_utf8(done.stdout).ok()?;
    done.status.success().then(|| said.trim().to_owned())
}
