//! The program `staya-hil` with the command `hil`.

fn main() -> std::process::ExitCode {
    staya_console::main(|command: &staya_hil::cli::Command, global| command.run(global))
}
