//! The program `staya-voxel`.

fn main() -> std::process::ExitCode {
    staya_console::main(|command: &staya_fvm::cli::Command, global| command.run(global))
}
