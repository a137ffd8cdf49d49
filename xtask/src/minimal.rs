//! The oldest Rust that the workspace declares (`rust-version`) compiles it.

use crate::session::Session;

/// If the toolchain here is that Rust, all that is compiled shows it; else rustup's of that version
/// has to check the workspace.
pub fn check(s: &mut Session) {
    const NAME: &str = "the declared minimal Rust";
    const DECLARED: &str = env!("CARGO_PKG_RUST_VERSION");
    let here = s.repo.answer("rustc --version").unwrap_or_default();
    if is_release_of(&here, DECLARED) {
        println!("{here} compiles everything here");
        s.report.step(NAME, || Ok(()));
    } else if s.repo.says(&format!("rustup run {DECLARED} rustc --version")) {
        let mut check = s.repo.command("rustup");
        check.args(["run", DECLARED, "cargo", "check", "--locked", "--workspace", "--target-dir"]);
        check.arg(s.repo.target.join("minimal"));
        s.report.command(NAME, check);
    } else {
        let remedy = "or declare another rust-version in Cargo.toml";
        s.report.skip(NAME, &format!("this is {here}; run `rustup toolchain install {DECLARED}`, {remedy}"));
    }
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
}
