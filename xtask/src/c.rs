//! `cargo xtask c`: the library for C. Its programs on this machine, the canned swarms on an
//! emulated part, templates for firmware of others.

use crate::apt::Tools;
use crate::device::{STM32F405, Toolchain};
use crate::emulate::{self, QEMU};
use crate::firmware::sections;
use crate::plants::SYMBOL;
use crate::prelude::*;
use crate::swarms::TABLE;

/// Debian's packages of the compiler for the part; no library of C is needed.
pub const COMPILER: Tools = Tools {
    packages: "gcc-arm-none-eabi binutils-arm-none-eabi",
    programs: "arm-none-eabi-gcc arm-none-eabi-g++ arm-none-eabi-nm",
    question: "arm-none-eabi-gcc --version && arm-none-eabi-g++ --version && arm-none-eabi-nm --version",
    ways: "unpack",
};
/// Warnings that the sources must not cause, and where headers are.
const STRICT: &str = "-Wall -Wextra -Werror -pedantic -Wno-variadic-macros -ffp-contract=off \
    -Icontroller/c/include -Icontroller/c/tests";

/// On the host, on the emulated part, and for other people's firmware.
pub fn run(s: &mut Session) {
    s.report.step("the library for C, on this machine", || on_host(&s.repo));
    s.report.step("the library for C, each access to memory checked", || sanitized(&s.repo));
    s.with_toolchain("the library for C, on the emulated stm32f405", STM32F405.target, |repo, toolchain| {
        COMPILER.prepare(repo)?;
        QEMU.prepare(repo)?;
        on_part(repo, &library(repo, toolchain)?)
    });
}

fn on_host(repo: &Repo) -> Result<()> {
    let remedy = "no cc and c++; on Debian run, as root, `apt-get install g++`";
    ensure!(repo.says("cc --version && c++ --version"), skipped(remedy));
    execute(&mut repo.cargo("build --locked --package staya-c"))?;
    compare(repo, &program(repo, "cc -std=c11 controller/c/tests/swarms.c", "controller/c/tests/host.c")?)?;
    print!("{}", program(repo, "cc -std=c11", "examples/c/orca_circle.c")?);
    print!("{}", program(repo, "cc -std=c11", "examples/c/own_law.c")?);
    print!("{}", program(repo, "c++ -std=c++17", "examples/c/two_robots.cpp")?);
    Ok(())
}

/// The tests of the library, misuse above all, with each access to memory checked: the sanitizer
/// ends a test at the first byte that is not the library's to touch. Stable Rust has it behind the
/// variable that lets it take unstable options.
fn sanitized(repo: &Repo) -> Result<()> {
    let libraries = repo.answer("rustc --print target-libdir").context("no rustc")?;
    let is_there = Path::new(&libraries).join("librustc-stable_rt.asan.a").is_file();
    ensure!(is_there, skipped("this Rust has no librustc-stable_rt.asan.a; rustup's for Linux has"));
    let mut test = repo.cargo("test --locked --package staya-c --target");
    test.arg(repo.answer("rustc --print host-tuple").context("rustc does not say for which machine it compiles")?);
    // A folder of its own, or flags that differ would compile everything again.
    test.env("CARGO_TARGET_DIR", repo.target.join("asan")).env("CARGO_INCREMENTAL", "0");
    test.env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", "-Zsanitizer=address").env("RUST_MIN_STACK", "16777216");
    execute(test.words("--config profile.dev.opt-level=0 --config profile.dev.debug=1"))
}

/// Compiles a program by the command of this line, runs it, and gives what it prints.
pub fn program(repo: &Repo, line: &str, source: &str) -> Result<String> {
    let to = object(repo, source, "")?;
    let (compiler, options) = line.split_once(' ').unwrap_or((line, ""));
    let mut build = repo.command(compiler);
    build.words(options).arg("-O1").words(STRICT).arg(source).arg(repo.target.join("debug/libstaya_c.a"));
    // System libraries that Rust's standard library needs on a host.
    execute(build.words("-lm -lpthread -ldl -o").arg(&to))?;
    println!("$ {}", to.display());
    output_of(&mut repo.command(&to)).map(|text| text + "\n").with_context(|| format!("{} fails", to.display()))
}

/// Where something is compiled to.
fn object(repo: &Repo, source: &str, extension: &str) -> Result<PathBuf> {
    let folder = repo.target.join("c");
    files::make(&folder)?;
    Ok(folder.join(files::stem(Path::new(source))).with_extension(extension))
}

/// The library as a user of the part makes it.
pub fn library(repo: &Repo, toolchain: &Toolchain) -> Result<PathBuf> {
    let line = "build --locked --profile firmware --package staya-c";
    execute(&mut toolchain.cargo(repo, STM32F405.target, line))?;
    Ok(toolchain.target_folder(repo).join(STM32F405.target).join("firmware/libstaya_c.a"))
}

/// The library has no panic, the templates compile, and the canned swarms give the golden hashes.
fn on_part(repo: &Repo, library: &Path) -> Result<()> {
    // Everything that C can call is in the library. A remaining call of the panic handler would be
    // an undefined symbol.
    let symbols = output_of(repo.command("arm-none-eabi-nm").arg(library));
    let symbols = symbols.context("arm-none-eabi-nm cannot read the library")?;
    ensure!(symbols.contains(" T staya_step"), "no staya_step in the library");
    ensure!(!symbols.contains(SYMBOL), "a panic is reachable");
    // The templates compile against declarations of the few functions of their systems that they
    // call.
    for (folder, source) in [("crazyflie", "src/staya_app.c"), ("esp-idf", "main/main.c")] {
        let mut build = cross(repo);
        build.arg(format!("-Iexamples/c/{folder}/stubs")).arg("-c").arg(format!("examples/c/{folder}/{source}"));
        execute(build.arg("-o").arg(object(repo, source, "o")?))?;
    }
    let elf = object(repo, "swarms", "elf")?;
    let mut build = cross(repo);
    build.words("-nostdlib -Wl,--gc-sections,-z,noexecstack -Wl,-T,memory.x -Wl,-T,controller/c/tests/stm32f405.ld");
    build.words("controller/c/tests/stm32f405.c controller/c/tests/swarms.c").arg(library);
    execute(build.words("-lgcc -o").arg(&elf))?;
    let sizes = sections(&elf)?;
    println!("{} bytes of flash, {} of RAM for five agents", sizes.flash, sizes.ram);
    let output = emulate::run(repo, STM32F405, &elf, "none", &[])?;
    // The deepest stack that the program has seen.
    let (stack, rows): (Vec<&str>, Vec<&str>) = output.lines().partition(|line| line.starts_with("stack"));
    let stack = stack.first().context("the program says nothing of its stack")?;
    println!("{stack} bytes at most, the program's own included");
    compare(repo, &rows.join("\n"))
}

/// The compiler of the part.
fn cross(repo: &Repo) -> Command {
    let mut build = repo.command("arm-none-eabi-gcc");
    build.words("-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -ffreestanding -Os -std=gnu11");
    build.words(STRICT);
    build
}

/// Compares with the rows of the golden table that C can make.
fn compare(repo: &Repo, output: &str) -> Result<()> {
    none_of(&foreign(&files::read(&repo.root.join(TABLE))?, output), "rows are not in the table")?;
    let rows = output.lines().count();
    ensure!(rows == CASES, "{rows} rows instead of {CASES}");
    Ok(())
}

/// Canned swarms in controller/c/tests/swarms.c.
const CASES: usize = 8;

/// Rows that the table does not have. Its next to last column, the digests of the agents, is left
/// out: payloads have another form in C.
fn foreign(table: &str, output: &str) -> Vec<String> {
    let without_digest = |row: &str| {
        let (rest, steps) = row.rsplit_once(' ')?;
        Some(format!("{} {steps}", rest.rsplit_once(' ')?.0))
    };
    let known: Vec<String> = table.lines().filter_map(without_digest).collect();
    output.lines().map(String::from).filter(|row| !known.contains(row)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_differ_are_reported() {
        let table = "a f32 1 2 8 3\nb f32 3 4 9 3\n";
        assert!(foreign(table, "b f32 3 4 3\n").is_empty());
        assert_eq!(foreign(table, "a f32 1 2 3\nb f32 3 5 3\n"), ["b f32 3 5 3"]);
    }
}
