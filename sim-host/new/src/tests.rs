use super::*;
use clap::Parser;

#[derive(Debug, Parser)]
struct Line {
    #[command(flatten)]
    new: NewArgs,
}

fn run(arguments: &[&str]) -> Result<Ended, String> {
    let line = Line::try_parse_from([&["new"], arguments].concat()).map_err(|error| error.to_string())?;
    let global = Global { quiet: true, ..Global::default() };
    line.new.run(&global).map_err(|error| format!("{error:#}"))
}

fn top() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

fn all_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    entries.flat_map(|path| if path.is_dir() { all_files(&path) } else { vec![path] }).collect()
}

#[test]
fn every_kind_of_project_is_complete_without_placeholders() {
    let mut kinds: Vec<Vec<&str>> = vec![vec!["--c"], vec!["--c", "--part", "nrf52840"], vec!["--python"]];
    kinds.extend(["f32", "fast32", "q16"].map(|numbers| vec!["--numbers", numbers]));
    kinds.extend(PARTS.iter().map(|part| vec!["--part", part.name]));
    for kind in kinds {
        for staya in [None, Some("https://example.org/staya.git")] {
            let top = top();
            let folder = top.path().join("pack-2");
            let mut arguments = vec![folder.to_str().expect("text")];
            arguments.extend(&kind);
            arguments.extend(staya.iter().flat_map(|staya| ["--staya", staya]));
            run(&arguments).unwrap_or_else(|error| panic!("{kind:?}: {error}"));
            for file in all_files(&folder).iter().filter(|file| !file.ends_with("Cargo.lock")) {
                assert!(!file.to_string_lossy().contains("my_swarm"), "{file:?}");
                let text = fs::read_to_string(file).expect("a file");
                let root = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).expect("the repository");
                // Relative paths to the sources are fine.
                let text = text.replace("../", ".");
                for left in ["my-swarm", "my_swarm", "MY_", "/STAYA", root.to_str().expect("text")] {
                    assert!(!text.contains(left), "{left} in {}", file.display());
                }
            }
            assert!(
                folder.join("README.md").is_file() && folder.join("scenario.toml").is_file() != kind.contains(&"--c")
            );
        }
    }
}

#[test]
fn an_existing_folder_is_unchanged() {
    let top = top();
    let folder = top.path().join("pack");
    let text = folder.to_str().expect("text");
    fs::create_dir(&folder).expect("a folder");
    fs::write(folder.join("README.md"), "mine").expect("a file");
    let error = run(&[text]).expect_err("a folder that is there");
    assert!(error.contains(text) && error.contains("already exists"), "{error}");
    assert_eq!(fs::read_to_string(folder.join("README.md")).expect("a file"), "mine");
    assert_eq!(all_files(top.path()).len(), 1);
    let deep = top.path().join("none/pack");
    let error = run(&[deep.to_str().expect("text")]).expect_err("no folder around it");
    assert!(error.contains("no such folder"), "{error}");
}

#[test]
fn a_failed_file_is_named_and_the_folder_removed() {
    let top = top();
    let folder = top.path().join("pack");
    let files: [File<'_>; 2] = [("a", ""), ("a/b", "")];
    let source = Source::Address(String::from("https://example.org/staya.git"));
    let error = write(&folder, "pack", &files, &[], &source).expect_err("a file in a file").to_string();
    assert!(error.contains("a/b") && error.contains("nothing was created"), "{error}");
    assert!(!folder.exists());
}

#[test]
fn project_names_must_be_valid_package_names() {
    for good in ["pack", "pack-2", "a", "swarm_of_ours"] {
        assert_eq!(name(Path::new(good)).ok(), Some(good));
        assert_eq!(name(&Path::new("some/where").join(good)).ok(), Some(good));
    }
    let long = "a".repeat(LONGEST + 1);
    for bad in ["Pack", "2pack", "-pack", "pack!", "pa ck", "рой", "", "..", long.as_str()] {
        assert!(name(Path::new(bad)).is_err(), "{bad}");
    }
    for taken in ["match", "test", "staya-sim", "class", "serde"] {
        let error = name(Path::new(taken)).expect_err(taken).to_string();
        assert!(error.contains("reserved"), "{error}");
    }
}

#[test]
fn invalid_arguments_list_the_choices() {
    let error = run(&["pack", "--part", "stm32f103"]).expect_err("no such part");
    assert!(PARTS.iter().all(|part| error.contains(part.name)), "{error}");
    let error = run(&["pack", "--c", "--part", "esp32c3"]).expect_err("no template");
    assert!(error.contains("stm32f405, nrf52840"), "{error}");
    assert!(run(&["pack", "--c", "--python"]).is_err());
    assert!(run(&["pack", "--python", "--part", "rp2350"]).is_err());
    assert!(run(&[]).is_err());
    let error = run(&["pack", "--staya", "/no/such"]).expect_err("no repository");
    assert!(error.contains("/no/such") && error.contains("--staya"), "{error}");
    let error = run(&["pack", "--staya", "https://a b"]).expect_err("an address with a blank");
    assert!(error.contains("blanks"), "{error}");
    assert!(!Path::new("pack").exists());
}

#[test]
fn a_git_url_replaces_paths() {
    let source = Source::Address(String::from("https://example.org/staya.git"));
    let line = "a = { path = \"/STAYA/controller/robot\", features = [\"async\"] }\n";
    assert_eq!(
        source.fill("Cargo.toml", line, "pack"),
        "a = { git = \"https://example.org/staya.git\", features = [\"async\"] }\n"
    );
}
