//! The program `staya-view`: `staya view`, and `staya run` with a live page or an MCAP file.

fn main() -> std::process::ExitCode {
    staya_console::main(|command: &staya_view::cli::Command, global| command.run(global))
}
