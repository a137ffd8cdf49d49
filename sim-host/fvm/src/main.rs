//! `staya-voxel`: `staya voxel` and `staya orca`.

fn main() -> std::process::ExitCode {
    staya_console::main(|command: &staya_fvm::cli::Command, global| command.run(global))
}
