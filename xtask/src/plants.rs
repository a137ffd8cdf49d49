//! Firmware with a panic does not link: panics are planted in a copy of the sources, one at a time,
//! and the linker must refuse each.
//!
//! That the sources as they are link, without one, is seen whenever the firmware is built.

use crate::device::{Part, STM32F405, Toolchain};
use crate::prelude::*;
use crate::repo::shown;

/// The symbol that the panic handler calls and that no crate defines.
pub const SYMBOL: &str = "staya_panic_is_reachable";
/// Where the copy is, in the target folder.
const COPY: &str = "planted";

/// A mistake of the kind that people make.
struct Mistake {
    plant: Plant,
    /// The program that must not link then.
    bin: &'static str,
    /// Whether that takes minutes.
    is_long: bool,
}

/// Each kind of code that the proof is for.
#[rustfmt::skip]
const MISTAKES: [Mistake; 6] = [
    Mistake { bin: "lockstep", is_long: false, plant: Plant { name: "the UART's ring", file: "hil/firmware/src/ring.rs",
        right: "self.bytes.get(tail)?.load(",
        wrong: "self.bytes[tail].load(" } },
    Mistake { bin: "lockstep", is_long: false, plant: Plant { name: "the UART's interrupt", file: "hil/firmware/src/part/stm32f405.rs",
        right: "RECEIVED.push(byte);",
        wrong: "RECEIVED.push(byte.checked_add(1).unwrap());" } },
    Mistake { bin: "lockstep", is_long: false, plant: Plant { name: "start-up", file: "hil/firmware/src/part/stm32f405.rs",
        right: "    if !comes(|| RCC.cr().read().pllrdy()) {",
        wrong: "    assert!(comes(|| RCC.cr().read().pllrdy()));\n    if false {" } },
    Mistake { bin: "lockstep", is_long: false, plant: Plant { name: "lockstep itself", file: "hil/firmware/src/lockstep.rs",
        right: "fault::over_the_link(format_args!(\"stack overflow: all of {} bytes used\", stack::size()));",
        wrong: "panic!(\"stack overflow: all of {} bytes used\", stack::size());" } },
    Mistake { bin: "lockstep", is_long: false, plant: Plant { name: "logs", file: "hil/firmware/src/log.rs",
        right: "if let Some(place) = self.bytes.get_mut(self.used) {",
        wrong: "{\n                let place = &mut self.bytes[self.used];" } },
    Mistake { bin: "nopanic_operator", is_long: true, plant: Plant { name: "an operator's orders", file: "controller/src/laws/guided.rs",
        right: "self.wish = wish;",
        wrong: "self.wish = [wish][core::hint::black_box(1)];" } },
];

/// Plants on the part whose firmware has them all; those that take minutes only if `all` is set.
pub fn run(s: &mut Session, all: bool) {
    for mistake in MISTAKES.iter().filter(|mistake| all || !mistake.is_long) {
        let name = format!("a panic in {} does not link", mistake.plant.name);
        s.with_toolchain(&name, STM32F405.target, |repo, toolchain| is_refused(repo, toolchain, STM32F405, mistake));
    }
}

/// Refuses sources that name a macro of `defmt` that panics: these have a panic handler of their
/// own, which the linker accepts (`hil/firmware/build.rs`). Lints on the host do not see the
/// firmware's code.
pub fn check_logs(root: &Path) -> Result<()> {
    let [controller, hil] = ["controller", "hil"].map(|folder| files::sources(&root.join(folder), &["rs"]));
    for file in [controller?, hil?].concat() {
        if let Some(found) = panicking_log(&files::read(&file)?) {
            bail!("{}: `{found}` panics without the linker noticing; log, then continue or reset", file.display());
        }
    }
    Ok(())
}

/// The first macro of `defmt` in a text that panics.
fn panicking_log(text: &str) -> Option<String> {
    const PANICS: [&str; 7] = ["panic", "assert", "unwrap", "expect", "todo", "unreachable", "unimplemented"];
    PANICS.iter().map(|name| format!("defmt::{name}")).find(|name| text.contains(name))
}

fn is_refused(repo: &Repo, toolchain: &Toolchain, part: &Part, mistake: &Mistake) -> Result<()> {
    let copy = repo.target.join(COPY);
    repo.plant(&copy, &mistake.plant)?;
    let line = "build --locked --profile firmware --package staya-firmware --bin";
    let mut build = toolchain.cargo(repo, part.target, line);
    build.arg(mistake.bin).current_dir(&copy);
    println!("$ {}", shown(&build));
    let output = build.output().context("cannot start")?;
    ensure!(!output.status.success(), "it links");
    let said = String::from_utf8_lossy(&output.stderr);
    if !said.contains(&format!("undefined symbol: {SYMBOL}")) {
        print!("{said}");
        bail!("it fails, but not for want of {SYMBOL}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_that_panic_are_found() {
        assert_eq!(panicking_log("defmt::info!(1); #[derive(defmt::Format)]"), None);
        assert_eq!(panicking_log("defmt::info!(1); defmt::unwrap!(x)").as_deref(), Some("defmt::unwrap"));
        assert_eq!(panicking_log("defmt::assert_eq!(1, 2)").as_deref(), Some("defmt::assert"));
    }

    #[test]
    fn every_plant_has_its_place() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        for Mistake { plant, .. } in &MISTAKES {
            let text = files::read(&root.join(plant.file)).expect(plant.file);
            assert_eq!(text.matches(plant.right).count(), 1, "{}", plant.name);
        }
    }
}
