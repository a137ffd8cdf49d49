//! `cargo xtask size`: what the firmware takes on each part, against `hil/budgets.toml`, and the
//! search for the longest step behind ORCA.

mod budget;
mod laws;
mod reach;

use crate::device::{PARTS, Part, STM32F405};
use crate::emulate::{self, on_part};
use crate::firmware::{FIRMWARE, Sections, sections};
use crate::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Where the limits are.
const BUDGETS: &str = "hil/budgets.toml";

/// Figures by their columns.
type Row = BTreeMap<&'static str, u64>;
/// Figures of one kind: rows with the same columns.
type Table = BTreeMap<String, Row>;

/// A table for people.
fn text(name: &str, table: &Table) -> String {
    let width = table.keys().map(String::len).chain([name.len()]).max().unwrap_or(0);
    let mut text = format!("\n{name:width$}");
    text.extend(table.values().take(1).flat_map(Row::keys).map(|column| format!(" {column:>9}")));
    for (name, figures) in table {
        text += &format!("\n{name:width$}");
        text.extend(figures.values().map(|figure| format!(" {figure:>9}")));
    }
    text + "\n"
}

/// The measurements of a part.
#[derive(Default)]
struct Measured {
    /// Programs with their sections, bytes.
    programs: Table,
    /// Cases of `bench` with the kind of number: instructions and bytes.
    cases: Table,
    /// The agent of each law and `lockstep`, in the kind of number that limits are for.
    laws: Table,
    /// The flash that the step of each behaviour in `bench` needs: number, guidance, safety, wire
    /// format, neighbours; of those with most neighbours.
    steps: Table,
    /// The flash that one frame of each wire format needs. Formats share some constants and code.
    formats: Table,
}

#[derive(clap::Args, Default)]
pub struct Options {
    /// Print JSON instead of tables
    #[arg(long)]
    json: bool,
    /// Search for the longest step behind ORCA
    #[arg(long, conflicts_with = "json")]
    search: bool,
    /// The first random number of the search
    #[arg(long, value_name = "N", requires = "search", default_value = "1", value_parser = clap::value_parser!(u64).range(1..))]
    seed: u64,
    /// How many scenes are searched
    #[arg(long, value_name = "N", requires = "search", default_value = "20000", value_parser = clap::value_parser!(u64).range(1..))]
    scenes: u64,
}

/// Measures all parts; one step for each part's budget. Prints the figures as JSON or as tables.
pub fn run(s: &mut Session, options: &Options) {
    if options.search {
        return search(s, options);
    }
    let mut all = Vec::new();
    for part in &PARTS {
        on_part(s, &format!("budget of the {}", part.name), part, (FIRMWARE, &[]), |repo| {
            let budget = budget::read(&files::read(&repo.root.join(BUDGETS))?, part.name).context(BUDGETS)?;
            let measured = measure(repo, part, budget::number(&budget))?;
            let Measured { programs, cases, laws, steps, formats } = &measured;
            if options.json {
                all.push(json!({ "part": part.name, "programs": programs, "cases": cases, "laws": laws,
                    "steps": steps, "formats": formats }));
            } else {
                println!("{}\n{}{}", part.name, text("program", programs), text("case", cases));
                println!("{}{}{}", text("agent of a law", laws), text("step", steps), text("frame", formats));
            }
            none_of(&budget::breaches(&budget, &measured), "limits are breached")
        });
    }
    if options.json {
        println!("{:#}", Value::Array(all));
    }
}

/// What `lockstep` takes on the part with an FPU: the quick part of [`run`].
pub fn run_short(s: &mut Session) {
    s.report.step("flash and static RAM of all behaviours", || {
        let limits = budget::read(&files::read(&s.repo.root.join(BUDGETS))?, STM32F405.name).context(BUDGETS)?;
        let row = row(&FIRMWARE.find(&s.repo, STM32F405, "lockstep")?)?;
        println!("{}", text("program", &[("lockstep".into(), row.clone())].into()));
        none_of(&budget::breaches_of("lockstep", row, &limits), "limits are breached")
    });
}

/// The sections of a program.
fn row(elf: &Path) -> Result<Row> {
    let Sections { text, rodata, flash, ram } = sections(elf)?;
    Ok(Row::from([("text", text), ("rodata", rodata), ("flash", flash), ("ram", ram)]))
}

/// Searches for the scene with the longest step behind ORCA, and prints it as an expression for
/// `hil/cases/src/scene/found.rs`.
fn search(s: &mut Session, options: &Options) {
    on_part(s, "search for the longest step", STM32F405, (FIRMWARE, &["search"]), |repo| {
        let elf = FIRMWARE.elf(repo, STM32F405, "search");
        let arguments = [options.seed, options.scenes].map(|number| number.to_string());
        print!("{}", emulate::run(repo, STM32F405, &elf, "none", &arguments.each_ref().map(String::as_str))?);
        Ok(())
    });
}

fn measure(repo: &Repo, part: &Part, number: &str) -> Result<Measured> {
    let elf = |program: &str| FIRMWARE.elf(repo, part, program);
    let sizes = ["lockstep", "replay", "bench"].map(|program| Ok((program.to_string(), row(&elf(program))?)));
    let programs = sizes.into_iter().collect::<Result<_>>()?;
    let cases = cases(&emulate::run(repo, part, &elf("bench"), "none", &[])?)?;
    let program = reach::Program::read(&files::bytes(&elf("bench"))?)?;
    let (steps, formats) = (program.steps(), program.formats());
    let laws = laws::laws(number, &programs, &cases, &steps);
    Ok(Measured { programs, cases, laws, steps, formats })
}

/// The output of `bench`: rows of case, kind of number (`-` for wire formats) and figures. The
/// error names the first line of another form.
fn cases(output: &str) -> Result<Table> {
    const COLUMNS: [&str; 6] = ["steps", "median", "worst", "stack", "agent", "workspace"];
    let row = |line: &str| {
        let [case, number, figures @ ..] = &line.split(' ').collect::<Vec<_>>()[..] else { return None };
        let figures: Vec<u64> = figures.iter().map(|figure| figure.parse().ok()).collect::<Option<_>>()?;
        (figures.len() == COLUMNS.len())
            .then(|| (format!("{case} {number}"), COLUMNS.into_iter().zip(figures).collect()))
    };
    let rows = output.lines().map(|line| row(line).with_context(|| format!("`bench` printed `{line}`")));
    let rows = rows.collect::<Result<Table>>()?;
    ensure!(!rows.is_empty(), "`bench` printed nothing");
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_bench_prints_is_read_and_nothing_else() {
        let line = "route f32 256 11071 73154 1944 1296 2704";
        let read = cases(&format!("{line}\n")).unwrap();
        let row = &read["route f32"];
        assert_eq!([row["worst"], row["stack"], row["agent"], row["workspace"]], [73154, 1944, 1296, 2704]);
        assert_eq!(text("case", &read).lines().nth(1).map(|head| head.split_whitespace().count()), Some(7));
        for bad in ["", "panicked at 3\n", &line[..35], &format!("{line} 1\n")] {
            assert!(cases(bad).is_err(), "{bad}");
        }
    }
}
