//! `staya-hil`: `staya hil`.

fn main() -> std::process::ExitCode {
    staya_console::main(|command: &staya_hil::cli::Command, global| command.run(global))
}
