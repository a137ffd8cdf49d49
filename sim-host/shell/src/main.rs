//! `staya-shell PREFIX`: writes manual pages and shell completions of all programs below
//! PREFIX/share.

use anyhow::{Context as _, Result};
use clap::{Command, CommandFactory as _};
use clap_complete::Shell;
use staya_console::Shown as _;
use staya_console::{Ended, Line};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Folders of completions, relative to a prefix.
const COMPLETIONS: [(Shell, &str, &str); 3] = [
    (Shell::Bash, "share/bash-completion/completions", "staya"),
    (Shell::Zsh, "share/zsh/site-functions", "_staya"),
    (Shell::Fish, "share/fish/vendor_completions.d", "staya.fish"),
];

fn main() -> ExitCode {
    let prefix = std::env::args_os().nth(1).map(PathBuf::from);
    let written = prefix.context("usage: staya-shell PREFIX").and_then(|prefix| write(&prefix));
    staya_console::exit("staya-shell", written.map(|()| Ended::Done))
}

fn programs() -> [Command; 5] {
    [
        Line::<staya_lab::cli::Command>::command(),
        Line::<staya_view::cli::Command>::command(),
        Line::<staya_hil::cli::Command>::command(),
        Line::<staya_mav::cli::Command>::command(),
        Line::<staya_fvm::cli::Command>::command(),
    ]
}

fn whole() -> Command {
    let programs = programs();
    let commands = programs.iter().flat_map(Command::get_subcommands).filter(|command| !command.is_hide_set());
    Line::<staya::cli::Command>::command().subcommands(commands.cloned())
}

fn write(prefix: &Path) -> Result<()> {
    let folder = |path: &str| -> Result<PathBuf> {
        let folder = prefix.join(path);
        fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.shown()))?;
        Ok(folder)
    };
    for (shell, path, name) in COMPLETIONS {
        let mut script = Vec::new();
        clap_complete::generate(shell, &mut whole(), "staya", &mut script);
        let file = folder(path)?.join(name);
        fs::write(&file, script).with_context(|| format!("cannot write {}", file.shown()))?;
    }
    let pages = folder("share/man/man1")?;
    clap_mangen::generate_to(whole(), &pages).with_context(|| format!("cannot write into {}", pages.shown()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use staya::programs::PROGRAMS;

    #[test]
    fn shells_and_man_know_every_command() {
        let prefix = tempfile::tempdir().expect("a folder");
        write(prefix.path()).expect("room");
        let names: Vec<_> = whole().get_subcommands().map(|command| command.get_name().to_owned()).collect();
        assert!(names.contains(&"run".to_owned()) && names.len() > 10, "{names:?}");
        let text = |path: PathBuf| fs::read_to_string(path).expect("written");
        for name in &names {
            for (_, folder, file) in COMPLETIONS {
                assert!(text(prefix.path().join(folder).join(file)).contains(name), "{file} does not know {name}");
            }
            let page = text(prefix.path().join(format!("share/man/man1/staya-{name}.1")));
            assert!(page.contains(".SH SYNOPSIS"), "{name}");
        }
    }

    #[test]
    fn staya_describes_commands_as_their_programs_do() {
        let programs = programs();
        let own = programs.iter().flat_map(Command::get_subcommands).filter(|command| !command.is_hide_set());
        let mut own: Vec<_> =
            own.map(|command| (command.get_name().to_owned(), command.get_about().map(ToString::to_string))).collect();
        let told = PROGRAMS.iter().flat_map(|program| program.commands);
        let mut told: Vec<_> = told.map(|(name, about)| ((*name).to_owned(), Some((*about).to_owned()))).collect();
        own.sort();
        told.sort();
        assert_eq!(own, told);
        whole().debug_assert();
    }
}
