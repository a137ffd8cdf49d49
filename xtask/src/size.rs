//! `cargo xtask size`: what the firmware takes on each part, against `hil/budgets.toml`, and the
//! search for the longest step behind ORCA.

mod bench;
mod budget;
mod laws;
mod reach;

use crate::device::{PARTS, Part, STM32F405};
use crate::emulate::{self, on_part};
use crate::files;
use crate::firmware::{self, Profile, Sections};
use crate::options::Options;
use crate::repo::Repo;
use crate::session::Session;
use bench::Row;
use budget::Budget;
use serde::Serialize;

/// Where the limits are.
const BUDGETS: &str = "hil/budgets.toml";

/// The measurements of a part.
#[derive(Serialize)]
struct Measured {
    part: &'static str,
    /// Programs with their sections, bytes.
    programs: Vec<(String, Sections)>,
    rows: Vec<Row>,
    /// The agent of each law and `lockstep`, in the kind of number that limits are for.
    laws: Vec<laws::Law>,
    /// The flash that each behaviour's step needs.
    steps: Vec<reach::Step>,
    /// The flash that encoder and decoder of each wire format need.
    formats: Vec<reach::Step>,
}

/// Measures all parts; one step for each part's budget. `is_json`: prints the figures as JSON
/// instead of as tables.
pub fn run(s: &mut Session, is_json: bool) {
    let mut all = Vec::new();
    for part in &PARTS {
        on_part(s, &format!("budget of the {}", part.name), part, (Profile::Firmware, &[]), |repo| {
            let text = files::read(&repo.root.join(BUDGETS))?;
            let budget = Budget::read(&text, part.name).map_err(|error| format!("{BUDGETS}: {error}"))?;
            let measured = measure(repo, part, budget.number())?;
            let breaches = budget.breaches(&measured);
            if !is_json {
                print!("{}", measured.table());
            }
            all.push(measured);
            breaches.iter().for_each(|breach| println!("{breach}"));
            if breaches.is_empty() { Ok(()) } else { Err(breaches.join("; ")) }
        });
    }
    if is_json {
        match serde_json::to_string_pretty(&all) {
            Ok(text) => println!("{text}"),
            Err(error) => println!("{error}"),
        }
    }
}

/// Searches for the scene with the longest step behind ORCA, and prints it as an expression for
/// `hil/cases/src/scene/found.rs`.
pub fn search(s: &mut Session, options: &Options<'_>) {
    let seed = options.value("--seed").unwrap_or("1");
    let scenes = options.value("--scenes").unwrap_or("20000");
    on_part(s, "search for the longest step", STM32F405, (Profile::Firmware, &["search"]), |repo| {
        let elf = Profile::Firmware.elf(repo, STM32F405, "search");
        let said = emulate::run_with(repo, STM32F405, &elf, "none", &[seed, scenes])?;
        print!("{said}");
        Ok(())
    });
}

fn measure(repo: &Repo, part: &'static Part, number: &str) -> Result<Measured, String> {
    let elf = |program: &str| Profile::Firmware.elf(repo, part, program);
    let programs = ["lockstep", "replay", "bench"];
    let sections = |program: &&str| Ok((program.to_string(), firmware::sections(&elf(program))?));
    let rows = bench::rows(&emulate::run(repo, part, &elf("bench"), "none")?)?;
    let bytes = files::bytes(&elf("bench"))?;
    let program = reach::Program::read(&bytes)?;
    let steps = reach::steps(&program);
    let programs = programs.iter().map(sections).collect::<Result<Vec<_>, String>>()?;
    let mut laws = laws::laws(number, &rows, &steps);
    if let Some((_, Sections { text, rodata, ram, .. })) = programs.iter().find(|(name, _)| name == "lockstep") {
        let stack = rows.iter().filter(|row| row.number == number).map(|row| row.stack).max().unwrap_or(0);
        laws.push(laws::Law { law: "lockstep, all laws", text: *text, rodata: *rodata, ram: *ram, stack });
    }
    Ok(Measured { part: part.name, programs, laws, rows, steps, formats: reach::formats(&program) })
}

impl Measured {
    /// For people.
    fn table(&self) -> String {
        let mut text = format!("\n{:<24} {:>8} {:>8} {:>8} {:>8}\n", self.part, "text", "rodata", "flash", "RAM");
        for (program, sections) in &self.programs {
            let Sections { text: code, rodata, flash, ram } = sections;
            text += &format!("{program:<24} {code:>8} {rodata:>8} {flash:>8} {ram:>8}\n");
        }
        text += &format!(
            "\n{:<26} {:>6} {:>6} {:>9} {:>9} {:>6} {:>6} {:>9}\n",
            "bytes, instructions", "number", "steps", "median", "worst", "stack", "agent", "workspace"
        );
        for row in &self.rows {
            text += &format!("{row}\n");
        }
        text +=
            &format!("\n{:<24} {:>8} {:>8} {:>8} {:>8}\n", "law: bytes of an agent", "text", "rodata", "RAM", "stack");
        for laws::Law { law, text: code, rodata, ram, stack } in &self.laws {
            text += &format!("{law:<24} {code:>8} {rodata:>8} {ram:>8} {stack:>8}\n");
        }
        text += &format!(
            "\n{:>8} {:>8}  step of a behaviour: number, guidance, safety, wire format, neighbours\n",
            "text", "rodata"
        );
        for reach::Step { behaviour, reach } in &self.steps {
            text += &format!("{:>8} {:>8}  {behaviour}\n", reach.text, reach.rodata);
        }
        text += &format!("\n{:>8} {:>8}  one frame of a wire format\n", "text", "rodata");
        for reach::Step { behaviour, reach } in &self.formats {
            text += &format!("{:>8} {:>8}  {behaviour}\n", reach.text, reach.rodata);
        }
        text
    }
}
