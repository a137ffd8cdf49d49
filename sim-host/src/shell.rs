//! `staya completions SHELL`, `staya man FOLDER`: what shells and `man` know of the command line.

use anyhow::{Context as _, Result, anyhow};
use clap::{Args, Command};
use clap_complete::Shell;
use staya_console::{Ended, Global, print};
use std::fs;
use std::path::PathBuf;

/// Print what a shell completes `staya` by.
#[derive(Args, Clone, Debug)]
#[command(after_help = "bash: staya completions bash > ~/.local/share/bash-completion/completions/staya\n\
    zsh:  staya completions zsh > a folder of $fpath, as _staya\n\
    fish: staya completions fish > ~/.config/fish/completions/staya.fish")]
pub struct CompletionsArgs {
    /// The shell.
    shell: Shell,
}

impl CompletionsArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// Standard output cannot be written.
    pub fn run(&self, mut command: Command) -> Result<Ended> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut command, "staya", &mut script);
        print(&String::from_utf8_lossy(&script))?;
        Ok(Ended::Done)
    }
}

/// Write a manual page for each command: staya.1, staya-run.1 and so on.
#[derive(Args, Clone, Debug)]
#[command(after_help = "To read them: staya man ~/.local/share/man/man1, then man staya-run")]
pub struct ManArgs {
    /// Folder for them; made if it is not there. Pages of other programs in it stay.
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

impl ManArgs {
    /// Runs the command.
    ///
    /// # Errors
    /// The folder cannot be made or written to.
    pub fn run(&self, command: Command, global: &Global) -> Result<Ended> {
        let folder = self.folder.display();
        fs::create_dir_all(&self.folder).with_context(|| format!("{folder}; name a folder that can be made"))?;
        clap_mangen::generate_to(command, &self.folder)
            .map_err(|error| anyhow!("{folder}: {error}; name a folder that can be written to"))?;
        if !global.quiet {
            print(&format!("manual pages are in {folder}\n"))?;
        }
        Ok(Ended::Done)
    }
}
