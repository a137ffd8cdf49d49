//! `staya-mav`: `staya bridge`, `staya formation`, `staya companion`.

fn main() -> std::process::ExitCode {
    staya_console::main(|command: &staya_mav::cli::Command, global| command.run(global))
}
