//! Sets `STAYA_VERSION`, which results record: the package version, and in a git repository `+`,
//! the last commit that changed the sources of results, and a hash of their uncommitted changes. So
//! a change of documents alone does not change the version.

use std::path::Path;
use std::process::Command;

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
    git(root, &["ls-files", "--error-unmatch", "sim-host/console/build.rs"])?;
    let of_sources = |words: &[&str]| git(root, &[words, &["--"], &SOURCES].concat());
    let commit = of_sources(&["log", "-1", "--abbrev=12", "--format=%h"]).filter(|commit| !commit.is_empty())?;
    let changes = of_sources(&["diff", "HEAD", "--no-ext-diff", "--no-color", "--full-index"])?;
    let new = of_sources(&["ls-files", "--others", "--exclude-standard"])?;
    if changes.is_empty() && new.is_empty() {
        return Some(commit);
    }
    let texts = new.lines().map(|file| std::fs::read_to_string(root.join(file)).unwrap_or_default());
    let all: String = [changes, new.clone()].into_iter().chain(texts).collect();
    let hash = all.bytes().fold(0x811c_9dc5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
    Some(format!("{commit}.{hash:08x}"))
}

/// `None` if git fails.
fn git(root: &Path, words: &[&str]) -> Option<String> {
    let done = Command::new("git").arg("-C").arg(root).args(words).output().ok()?;
    let said = String::from_utf8(done.stdout).ok()?;
    done.status.success().then(|| said.trim().to_owned())
}
