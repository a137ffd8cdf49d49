//! The program `staya-mav` with the commands `bridge`, `formation` and `companion`.

fn main() -> std::process::ExitCode {
    staya_console::main(|command: &staya_mav::cli::Command, global| command.run(global))
}
