//! `staya-lab`: `staya sweep` and `staya experiment`.

fn main() -> std::process::ExitCode {
    staya_console::main(|command: &staya_lab::cli::Command, global| command.run(global))
}
