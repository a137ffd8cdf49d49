//! `cargo xtask c`: the library for C. Its programs on this machine, the canned swarms on an
//! emulated part, templates for firmware of others.

use crate::apt::Tools;
use crate::device::{STM32F405, Toolchain};
use crate::emulate::{self, QEMU};
use crate::files;
use crate::firmware::sections;
use crate::plants::SYMBOL;
use crate::repo::{Repo, output_of, run as run_command, shown};
use crate::session::Session;
use crate::swarms::TABLE;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Debian's packages of the compiler for the part; no library of C is needed.
pub const COMPILER: Tools = Tools {
    packages: &["gcc-arm-none-eabi", "binutils-arm-none-eabi"],
    programs: &["arm-none-eabi-gcc", "arm-none-eabi-g++", "arm-none-eabi-nm"],
    question: "arm-none-eabi-gcc --version && arm-none-eabi-g++ --version && arm-none-eabi-nm --version",
};
/// Warnings that the sources must not cause.
const STRICT: [&str; 6] = ["-Wall", "-Wextra", "-Werror", "-pedantic", "-Wno-variadic-macros", "-ffp-contract=off"];
const INCLUDES: [&str; 2] = ["-Icontroller/c/include", "-Icontroller/c/tests"];
/// System libraries that Rust's standard library needs on a host.
const SYSTEM: [&str; 3] = ["-lm", "-lpthread", "-ldl"];

/// On the host, on the emulated part, and for other people's firmware.
pub fn run(s: &mut Session) {
    let compilers = s.repo.says("cc --version && c++ --version");
    let compilers =
        compilers.then_some(()).ok_or("no cc and c++; on Debian run, as root, `apt-get install g++`".into());
    s.report.step_with("the library for C, on this machine", compilers, |()| on_host(&s.repo));
    sanitized(s);
    on_part(s);
}

fn on_host(repo: &Repo) -> Result<(), String> {
    run_command(&mut repo.cargo(&["build", "--locked", "--package", "staya-c"]))?;
    let swarms = ["controller/c/tests/swarms.c", "controller/c/tests/host.c"];
    compare(repo, &program(repo, "cc", "-std=c11", &swarms)?)?;
    for (compiler, standard, source) in [
        ("cc", "-std=c11", "examples/c/orca_circle.c"),
        ("cc", "-std=c11", "examples/c/own_law.c"),
        ("c++", "-std=c++17", "examples/c/two_robots.cpp"),
    ] {
        print!("{}", program(repo, compiler, standard, &[source])?);
    }
    Ok(())
}

/// The tests of the library, misuse above all, with each access to memory checked: the sanitizer
/// ends a test at the first byte that is not the library's to touch. Stable Rust has it behind the
/// variable that lets it take unstable options.
fn sanitized(s: &mut Session) {
    let repo = &s.repo;
    let host = sanitized_host(repo);
    let host = host.ok_or("this Rust has no librustc-stable_rt.asan.a; rustup's for Linux has".into());
    s.report.step_with("the library for C, each access to memory checked", host, |host| {
        let mut test = repo.cargo(&["test", "--locked", "--package", "staya-c", "--target", &host]);
        // A folder of its own, or flags that differ would compile everything again.
        test.env("CARGO_TARGET_DIR", repo.target.join("asan")).env("CARGO_INCREMENTAL", "0");
        test.env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", "-Zsanitizer=address").env("RUST_MIN_STACK", "16777216");
        run_command(test.args(["--config", "profile.dev.opt-level=0", "--config", "profile.dev.debug=1"]))
    });
}

/// This machine's target, if the Rust here has the run-time part of AddressSanitizer for it.
fn sanitized_host(repo: &Repo) -> Option<String> {
    let host = repo.answer("rustc --print host-tuple")?;
    let libraries = output_of(repo.command("rustc").args(["--print", "target-libdir"]))?;
    Path::new(&libraries).join("librustc-stable_rt.asan.a").is_file().then_some(host)
}

/// Compiles a program, runs it, and gives what it prints.
fn program(repo: &Repo, compiler: &str, standard: &str, sources: &[&str]) -> Result<String, String> {
    let to = folder(repo)?.join(files::stem(Path::new(sources[0])));
    let library = repo.target.join("debug/libstaya_c.a");
    let mut build = repo.command(compiler);
    build.args([standard, "-O1"]).args(STRICT).args(INCLUDES).args(sources).arg(library).args(SYSTEM);
    run_command(build.arg("-o").arg(&to))?;
    let mut start = repo.command(&to);
    println!("$ {}", shown(&start));
    output_of(&mut start).map(|text| text + "\n").ok_or_else(|| format!("{} fails", to.display()))
}

fn on_part(s: &mut Session) {
    let name = "the library for C, on the emulated stm32f405";
    let tools = COMPILER.prepare(&s.repo).and_then(|()| QEMU.prepare(&s.repo));
    if s.report.need(name, tools).is_none() {
        return;
    }
    s.with_toolchain(name, STM32F405.target, |repo, toolchain| {
        let library = library(repo, toolchain)?;
        has_no_panic(repo, &library)?;
        templates(repo)?;
        let output = emulate::run(repo, STM32F405, &link(repo, &library)?, "none", &[])?;
        let (stack, rows): (Vec<&str>, Vec<&str>) = output.lines().partition(|line| line.starts_with(STACK));
        let stack = stack.first().and_then(|line| line.strip_prefix(STACK));
        let stack = stack.ok_or("the program says nothing of its stack")?;
        println!("{} bytes of stack at most, the program's own included", stack.trim());
        compare(repo, &rows.join("\n"))
    });
}

/// The library as a user of the part makes it.
pub fn library(repo: &Repo, toolchain: &Toolchain) -> Result<PathBuf, String> {
    let mut build = toolchain.cargo(repo, STM32F405.target, "build");
    run_command(build.args(["--locked", "--profile", "firmware", "--package", "staya-c"]))?;
    Ok(toolchain.target_folder(repo).join(STM32F405.target).join("firmware/libstaya_c.a"))
}

/// The word before the deepest stack that the program on the part has seen.
const STACK: &str = "stack";

/// Everything that C can call is in the library. A remaining call of the panic handler would be an
/// undefined symbol.
fn has_no_panic(repo: &Repo, library: &Path) -> Result<(), String> {
    let symbols = output_of(repo.command("arm-none-eabi-nm").arg(library));
    let symbols = symbols.ok_or("arm-none-eabi-nm cannot read the library")?;
    if !symbols.contains(" T staya_step") {
        return Err(String::from("no staya_step in the library"));
    }
    if symbols.contains(SYMBOL) { Err(String::from("a panic is reachable")) } else { Ok(()) }
}

fn cross(repo: &Repo) -> Command {
    let mut build = repo.command("arm-none-eabi-gcc");
    build.args(["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-ffreestanding", "-Os"]);
    build.args(STRICT).args(INCLUDES).arg("-std=gnu11");
    build
}

/// The templates compile against declarations of the few functions of their systems that they call.
fn templates(repo: &Repo) -> Result<(), String> {
    let folder = folder(repo)?;
    let templates = [("crazyflie", "src/staya_app.c"), ("esp-idf", "main/main.c")];
    templates.into_iter().try_for_each(|(name, source)| {
        let mut build = cross(repo);
        build.arg(format!("-Iexamples/c/{name}/stubs")).arg("-c").arg(format!("examples/c/{name}/{source}"));
        run_command(build.arg("-o").arg(folder.join(name).with_extension("o")))
    })
}

/// Links the canned swarms into a program of the part, and prints its size.
fn link(repo: &Repo, library: &Path) -> Result<PathBuf, String> {
    let elf = folder(repo)?.join("swarms.elf");
    let mut build = cross(repo);
    build.args(["-nostdlib", "-Wl,--gc-sections,-z,noexecstack", "-Wl,-T,memory.x"]);
    build.args(["-Wl,-T,controller/c/tests/stm32f405.ld", "controller/c/tests/stm32f405.c"]);
    build.arg("controller/c/tests/swarms.c").arg(library).args(["-lgcc", "-o"]).arg(&elf);
    run_command(&mut build)?;
    let sizes = sections(&elf)?;
    println!("{} bytes of flash, {} of RAM for five agents", sizes.flash, sizes.ram);
    Ok(elf)
}

/// Compares with the rows of the golden table that C can make.
fn compare(repo: &Repo, output: &str) -> Result<(), String> {
    let table = files::read(&repo.root.join(TABLE))?;
    match (foreign(&table, output).first(), output.lines().count()) {
        (Some(first), _) => Err(format!("not in {TABLE}: {first}")),
        (None, CASES) => Ok(()),
        (None, rows) => Err(format!("{rows} rows instead of {CASES}")),
    }
}

/// Canned swarms in controller/c/tests/swarms.c.
const CASES: usize = 8;

/// Rows that the table does not have. Its next to last column, the digests of the agents, is left
/// out: payloads have another form in C.
fn foreign<'a>(table: &str, output: &'a str) -> Vec<&'a str> {
    let without_digest = |row: &str| {
        let (rest, steps) = row.rsplit_once(' ')?;
        Some(format!("{} {steps}", rest.rsplit_once(' ')?.0))
    };
    let known: Vec<String> = table.lines().filter_map(without_digest).collect();
    output.lines().filter(|row| !known.iter().any(|known| known == row)).collect()
}

fn folder(repo: &Repo) -> Result<PathBuf, String> {
    let folder = repo.target.join("c");
    files::make(&folder)?;
    Ok(folder)
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
