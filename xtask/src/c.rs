//! `cargo xtask c`: the library for C. Its programs on this machine, the canned swarms on an
//! emulated part, templates for firmware of others.

use crate::apt::Tools;
use crate::device::{STM32F405, Toolchain};
use crate::emulate;
use crate::files;
use crate::firmware::sections;
use crate::repo::{Repo, output_of, run as run_command_line, shown};
use crate::session::Session;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The rows that every program must print.
const TABLE: &str = "tests/golden/cases.txt";
/// Debian's packages of the compiler for the part; no library of C is needed.
const COMPILER: Tools = Tools {
    packages: &["gcc-arm-none-eabi", "binutils-arm-none-eabi"],
    programs: &["arm-none-eabi-gcc", "arm-none-eabi-g++", "arm-none-eabi-nm"],
};
/// Warnings that the sources must not cause.
const STRICT: [&str; 6] = ["-Wall", "-Wextra", "-Werror", "-pedantic", "-Wno-variadic-macros", "-ffp-contract=off"];
const INCLUDES: [&str; 2] = ["-Icontroller/c/include", "-Icontroller/c/tests"];
/// System libraries that Rust's standard library needs on a host.
const SYSTEM: [&str; 3] = ["-lm", "-lpthread", "-ldl"];
/// The symbol that the panic handler calls and that no crate defines.
const PANIC: &str = "staya_panic_is_reachable";

/// On the host, on the emulated part, and for other people's firmware.
pub fn run(s: &mut Session) {
    on_host(s);
    sanitized(s);
    on_part(s);
}

fn on_host(s: &mut Session) {
    let repo = &s.repo;
    let name = "the library for C, on this machine";
    for compiler in ["cc", "c++"] {
        if output_of(repo.command(compiler).arg("--version")).is_none() {
            return s.report.skip(name, &format!("no {compiler}; on Debian run, as root, `apt-get install g++`"));
        }
    }
    s.report.step(name, || {
        run_command_line(&mut repo.cargo(&["build", "--locked", "--package", "staya-c"]))?;
        let library = repo.target.join("debug/libstaya_c.a");
        let swarms = ["controller/c/tests/swarms.c", "controller/c/tests/host.c"];
        compare(repo, &program(repo, &library, "cc", "-std=c11", &swarms)?)?;
        for (compiler, standard, source) in [
            ("cc", "-std=c11", "examples/c/orca_circle.c"),
            ("cc", "-std=c11", "examples/c/own_law.c"),
            ("c++", "-std=c++17", "examples/c/two_robots.cpp"),
        ] {
            print!("{}", program(repo, &library, compiler, standard, &[source])?);
        }
        Ok(())
    });
}

/// The tests of the library, misuse above all, with each access to memory checked: the sanitizer
/// ends a test at the first byte that is not the library's to touch. Stable Rust has it behind the
/// variable that lets it take unstable options.
fn sanitized(s: &mut Session) {
    let repo = &s.repo;
    let name = "the library for C, each access to memory checked";
    let Some(host) = sanitized_host(repo) else {
        return s.report.skip(name, "this Rust has no librustc-stable_rt.asan.a; rustup's for Linux has");
    };
    s.report.step(name, || {
        let mut test = repo.cargo(&["test", "--locked", "--package", "staya-c", "--target", &host]);
        // A folder of its own, or flags that differ would compile everything again.
        test.env("CARGO_TARGET_DIR", repo.target.join("asan")).env("CARGO_INCREMENTAL", "0");
        test.env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", "-Zsanitizer=address").env("RUST_MIN_STACK", "16777216");
        run_command_line(test.args(["--config", "profile.dev.opt-level=0", "--config", "profile.dev.debug=1"]))
    });
}

/// This machine's target, if the Rust here has the run-time part of AddressSanitizer for it.
fn sanitized_host(repo: &Repo) -> Option<String> {
    let about = output_of(repo.command("rustc").arg("-vV"))?;
    let host = about.lines().find_map(|line| line.strip_prefix("host: "))?;
    let root = output_of(repo.command("rustc").args(["--print", "sysroot"]))?;
    let library = Path::new(&root).join("lib/rustlib").join(host).join("lib/librustc-stable_rt.asan.a");
    library.is_file().then(|| host.to_string())
}

/// Compiles a program, runs it, and gives what it prints.
fn program(repo: &Repo, library: &Path, compiler: &str, standard: &str, sources: &[&str]) -> Result<String, String> {
    let folder = folder(repo)?;
    let name = sources.first().and_then(|source| Path::new(source).file_stem()).unwrap_or_default();
    let to = folder.join(name);
    let mut build = repo.command(compiler);
    build.args([standard, "-O1"]).args(STRICT).args(INCLUDES).args(sources).arg(library).args(SYSTEM);
    run_command_line(build.arg("-o").arg(&to))?;
    let mut start = repo.command(&to);
    println!("$ {}", shown(&start));
    output_of(&mut start).map(|text| text + "\n").ok_or_else(|| format!("{} fails", to.display()))
}

fn on_part(s: &mut Session) {
    let name = "the library for C, on the emulated stm32f405";
    if let Err(reason) = compilers(&s.repo).and_then(|()| emulate::prepare(&s.repo, STM32F405)) {
        return s.report.skip(name, &reason);
    }
    s.with_toolchain(name, STM32F405.target, |repo, toolchain| {
        let library = library(repo, toolchain)?;
        has_no_panic(repo, &library)?;
        templates(repo)?;
        let output = emulate::run(repo, STM32F405, &link(repo, &library)?, "none")?;
        let (stack, rows): (Vec<&str>, Vec<&str>) = output.lines().partition(|line| line.starts_with(STACK));
        let stack = stack.first().and_then(|line| line.strip_prefix(STACK));
        let stack = stack.ok_or("the program says nothing of its stack")?;
        println!("{} bytes of stack at most, the program's own included", stack.trim());
        compare(repo, &rows.join("\n"))
    });
}

/// Makes sure that the compiler for the part is there; unpacks it on Debian.
pub fn compilers(repo: &Repo) -> Result<(), String> {
    let starts = |name: &&str| output_of(repo.command(name).arg("--version")).is_some();
    COMPILER.prepare(repo, || COMPILER.programs.iter().all(starts))
}

/// The library as a user of the part makes it.
pub fn library(repo: &Repo, toolchain: &Toolchain) -> Result<PathBuf, String> {
    let mut build = toolchain.cargo(repo, STM32F405.target, "build");
    run_command_line(build.args(["--locked", "--profile", "firmware", "--package", "staya-c"]))?;
    Ok(toolchain.target_folder(repo).join(STM32F405.target).join("firmware/libstaya_c.a"))
}

/// The word before the deepest stack that the program on the part has seen.
const STACK: &str = "stack";

/// Everything that C can call is in the library. A remaining call of the panic handler would be an
/// undefined symbol.
fn has_no_panic(repo: &Repo, library: &Path) -> Result<(), String> {
    let symbols = output_of(repo.command("arm-none-eabi-nm").arg("--undefined-only").arg(library));
    let symbols = symbols.ok_or("arm-none-eabi-nm cannot read the library")?;
    let own = output_of(repo.command("arm-none-eabi-nm").arg("--defined-only").arg(library)).unwrap_or_default();
    if !own.contains(" T staya_step") {
        return Err(String::from("no staya_step in the library"));
    }
    if symbols.contains(PANIC) { Err(String::from("a panic is reachable")) } else { Ok(()) }
}

fn cross(repo: &Repo, compiler: &str) -> Command {
    let mut build = repo.command(compiler);
    build.args(["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-ffreestanding", "-Os"]);
    build.args(STRICT).args(INCLUDES);
    build
}

/// The templates compile against declarations of the few functions of their systems that they call.
fn templates(repo: &Repo) -> Result<(), String> {
    let folder = folder(repo)?;
    for (name, source) in
        [("crazyflie", "examples/c/crazyflie/src/staya_app.c"), ("esp-idf", "examples/c/esp-idf/main/main.c")]
    {
        let mut build = cross(repo, "arm-none-eabi-gcc");
        build.arg(format!("-Iexamples/c/{name}/stubs")).args(["-std=gnu11", "-c", source, "-o"]);
        run_command_line(build.arg(folder.join(name).with_extension("o")))?;
    }
    Ok(())
}

/// Links the canned swarms into a program of the part, and prints its size.
fn link(repo: &Repo, library: &Path) -> Result<PathBuf, String> {
    let elf = folder(repo)?.join("swarms.elf");
    let mut build = cross(repo, "arm-none-eabi-gcc");
    build.args([
        "-std=gnu11",
        "-nostdlib",
        "-Wl,--gc-sections,-z,noexecstack",
        "-Wl,-T,memory.x",
        "-Wl,-T,controller/c/tests/stm32f405.ld",
    ]);
    build.args(["controller/c/tests/stm32f405.c", "controller/c/tests/swarms.c"]).arg(library);
    run_command_line(build.args(["-lgcc", "-o"]).arg(&elf))?;
    let sizes = sections(&elf)?;
    println!("{} bytes of flash, {} of RAM for five agents", sizes.flash, sizes.ram);
    Ok(elf)
}

/// Compares with the rows of the golden table that C can make.
fn compare(repo: &Repo, output: &str) -> Result<(), String> {
    let table = files::read(&repo.root.join(TABLE))?;
    let faults = foreign(&table, output);
    let rows = output.lines().count();
    println!("{rows} rows, {} differ", faults.len());
    match faults.first() {
        None if rows == CASES => Ok(()),
        None => Err(format!("{rows} rows instead of {CASES}")),
        Some(first) => Err(format!("not in {TABLE}: {first}")),
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
