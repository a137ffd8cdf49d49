//! The oldest Rust that the workspace declares (`rust-version`) compiles it.

use crate::files;
use crate::repo::{Repo, output_of};
use crate::session::Session;

const NAME: &str = "the declared minimal Rust";

/// If the toolchain here is that Rust, all that is compiled shows it; else rustup's of that version
/// has to check the workspace.
pub fn check(s: &mut Session) {
    let declared = match declared(&s.repo) {
        Ok(declared) => declared,
        Err(reason) => {
            s.report.step(NAME, || Err(reason));
            return;
        }
    };
    let here = output_of(s.repo.command("rustc").arg("--version")).unwrap_or_default();
    let rustup = |arguments: &[&str]| {
        let mut command = s.repo.command("rustup");
        command.args(["run", &declared]).args(arguments);
        command
    };
    if is_release_of(&here, &declared) {
        println!("{here} compiles everything here");
        s.report.step(NAME, || Ok(()));
    } else if output_of(&mut rustup(&["rustc", "--version"])).is_some() {
        let mut check = rustup(&["cargo", "check", "--locked", "--workspace", "--target-dir"]);
        check.arg(s.repo.target.join("minimal"));
        s.report.command(NAME, check);
    } else {
        let remedy = "or declare another rust-version in Cargo.toml";
        s.report.skip(NAME, &format!("this is {here}; run `rustup toolchain install {declared}`, {remedy}"));
    }
}

/// `rust-version` of the workspace.
fn declared(repo: &Repo) -> Result<String, String> {
    let path = repo.root.join("Cargo.toml");
    let manifest: toml::Table = files::read(&path)?.parse().map_err(|error| format!("{}: {error}", path.display()))?;
    let version = manifest["workspace"]["package"].get("rust-version").and_then(toml::Value::as_str);
    version.map(String::from).ok_or_else(|| format!("{}: no rust-version", path.display()))
}

/// Whether what `rustc --version` says is a release of `version`, such as `rustc 1.95.0 (...)` of
/// `1.95`.
fn is_release_of(said: &str, version: &str) -> bool {
    let release = said.split_whitespace().nth(1).and_then(|release| release.strip_prefix(version));
    release.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn releases_of_a_version() {
        for (said, version, is) in [
            ("rustc 1.95.0 (59807616e 2026-04-14)", "1.95", true),
            ("rustc 1.95.0", "1.95.0", true),
            ("rustc 1.9.0", "1.95", false),
            ("rustc 1.95.0", "1.9", false),
            ("rustc 1.96.0-nightly", "1.95", false),
            ("", "1.95", false),
        ] {
            assert_eq!(is_release_of(said, version), is, "{said} {version}");
        }
    }

    #[test]
    fn this_repository_declares_one() {
        let version = declared(&Repo::find()).unwrap();
        assert!(version.starts_with("1."), "{version}");
    }
}
