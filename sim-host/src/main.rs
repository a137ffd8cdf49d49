//! The program `staya`.

fn main() -> std::process::ExitCode {
    staya::cli::main()
}
