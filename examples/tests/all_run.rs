//! Runs each example of this folder; the examples assert their own claims.

use std::path::Path;
use std::process::Command;

#[test]
fn each_example_fulfils_its_own_assertions() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    // Cargo builds examples to target/PROFILE/examples and tests to target/PROFILE/deps.
    let own = std::env::current_exe().expect("a path");
    let built = own.ancestors().nth(2).expect("target/PROFILE").join("examples");
    let mut count = 0;
    for file in folder.read_dir().expect("a folder") {
        let path = file.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "rs") {
            continue;
        }
        let name = path.file_stem().expect("a name");
        let program = built.join(name);
        let output = Command::new(&program).output();
        let output = output.unwrap_or_else(|error| {
            panic!(
                "{}: {error}; is it in Cargo.toml, and did `cargo test` choose the targets?",
                program.display()
            )
        });
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}: {errors}", path.display());
        assert!(!output.stdout.is_empty(), "{} prints nothing", path.display());
        count += 1;
    }
    assert!(count >= 3, "{count} examples");
}
