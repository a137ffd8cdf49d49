//! `cargo xtask size`: what the firmware takes on each part, against `hil/budgets.toml`, and the
//! search for the longest step behind ORCA.

use crate::prelude::*;
mod budget;
mod laws;
mod reach;

use crate::device::{PARTS, Part, STM32F405};
use crate::emulate::{self, on_part};
use crate::firmware::{Profile, Sections, sections};
use serde_json::{Value, json};

/// Where the limits are.
const BUDGETS: &str = "hil/budgets.toml";

/// Figures of one kind: rows with a name and a figure for each column, after the first column.
struct Table {
    columns: &'static [&'static str],
    rows: Vec<(String, Vec<u64>)>,
}

impl Table {
    /// The figure in a row and a column.
    fn get(&self, name: &str, column: &str) -> Option<u64> {
        let (_, figures) = self.rows.iter().find(|(known, _)| known == name)?;
        figures.get(self.columns[1..].iter().position(|known| *known == column)?).copied()
    }

    /// For people.
    fn text(&self) -> String {
        let width = self.rows.iter().map(|(name, _)| name.len()).chain([self.columns[0].len()]).max().unwrap_or(0);
        let mut text = format!("\n{:width$}", self.columns[0]);
        text.extend(self.columns[1..].iter().map(|column| format!(" {column:>9}")));
        for (name, figures) in &self.rows {
            text += &format!("\n{name:width$}");
            text.extend(figures.iter().map(|figure| format!(" {figure:>9}")));
        }
        text + "\n"
    }

    /// For programs: an object by row.
    fn json(&self) -> Value {
        let object = |figures: &[u64]| -> Value {
            let columns = self.columns[1..].iter().map(ToString::to_string);
            columns.zip(figures.iter().copied().map(Value::from)).collect()
        };
        self.rows.iter().map(|(name, figures)| (name.clone(), object(figures))).collect()
    }
}

/// The measurements of a part.
struct Measured {
    /// Programs with their sections, bytes.
    programs: Table,
    /// Cases of `bench` with the kind of number: instructions and bytes.
    cases: Table,
    /// The agent of each law and `lockstep`, in the kind of number that limits are for.
    laws: Table,
    /// The flash that each behaviour's step needs.
    steps: Table,
    /// The flash that encoder and decoder of each wire format need.
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
        on_part(s, &format!("budget of the {}", part.name), part, (Profile::Firmware, &[]), |repo| {
            let budget = budget::read(&files::read(&repo.root.join(BUDGETS))?, part.name).context(BUDGETS)?;
            let measured = measure(repo, part, budget::number(&budget))?;
            let Measured { programs, cases, laws, steps, formats } = &measured;
            if options.json {
                let [programs, cases, laws, steps, formats] = [programs, cases, laws, steps, formats].map(Table::json);
                all.push(json!({ "part": part.name, "programs": programs, "cases": cases, "laws": laws,
                    "steps": steps, "formats": formats }));
            } else {
                println!("{}", part.name);
                [programs, cases, laws, steps, formats].iter().for_each(|table| print!("{}", table.text()));
            }
            none_of(&budget::breaches(&budget, &measured), "limits are breached")
        });
    }
    if options.json {
        println!("{:#}", Value::Array(all));
    }
}

/// Searches for the scene with the longest step behind ORCA, and prints it as an expression for
/// `hil/cases/src/scene/found.rs`.
fn search(s: &mut Session, options: &Options) {
    on_part(s, "search for the longest step", STM32F405, (Profile::Firmware, &["search"]), |repo| {
        let elf = Profile::Firmware.elf(repo, STM32F405, "search");
        let arguments = [options.seed, options.scenes].map(|number| number.to_string());
        print!("{}", emulate::run(repo, STM32F405, &elf, "none", &arguments.each_ref().map(String::as_str))?);
        Ok(())
    });
}

fn measure(repo: &Repo, part: &Part, number: &str) -> Result<Measured> {
    let elf = |program: &str| Profile::Firmware.elf(repo, part, program);
    let sizes = ["lockstep", "replay", "bench"].map(|program| {
        let Sections { text, rodata, flash, ram } = sections(&elf(program))?;
        Ok((program.to_string(), vec![text, rodata, flash, ram]))
    });
    let rows = sizes.into_iter().collect::<Result<_>>()?;
    let programs = Table { columns: &["program", "text", "rodata", "flash", "ram"], rows };
    let cases = cases(&emulate::run(repo, part, &elf("bench"), "none", &[])?)?;
    let program = reach::Program::read(&files::bytes(&elf("bench"))?)?;
    let (steps, formats) = (program.steps(), program.formats());
    let laws = laws::laws(number, &programs, &cases, &steps);
    Ok(Measured { programs, cases, laws, steps, formats })
}

/// The output of `bench`: rows of case, kind of number (`-` for wire formats) and figures. The
/// error names the first line of another form.
fn cases(output: &str) -> Result<Table> {
    const COLUMNS: [&str; 7] = ["case", "steps", "median", "worst", "stack", "agent", "workspace"];
    let row = |line: &str| {
        let (case, rest) = line.split_once(' ')?;
        let (number, figures) = rest.split_once(' ')?;
        let figures: Vec<u64> = figures.split(' ').map(|figure| figure.parse().ok()).collect::<Option<_>>()?;
        (figures.len() == COLUMNS.len() - 1).then(|| (format!("{case} {number}"), figures))
    };
    let rows = output.lines().map(|line| row(line).with_context(|| format!("`bench` printed `{line}`")));
    let rows: Vec<_> = rows.collect::<Result<_>>()?;
    ensure!(!rows.is_empty(), "`bench` printed nothing");
    Ok(Table { columns: &COLUMNS, rows })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_bench_prints_is_read_and_nothing_else() {
        let read = cases("route f32 256 11071 73154 1944 1296 2704\n").unwrap();
        let figure = |column| read.get("route f32", column);
        assert_eq!([figure("worst"), figure("stack"), figure("workspace")], [Some(73154), Some(1944), Some(2704)]);
        assert_eq!(read.text().lines().nth(1).map(|head| head.split_whitespace().count()), Some(7));
        assert_eq!(read.json()["route f32"]["agent"], 1296);
        for bad in [
            "",
            "panicked at 3\n",
            "route f32 256 11071 73154 1944 1296\n",
            "route f32 256 11071 73154 1944 1296 2704 1\n",
        ] {
            assert!(cases(bad).is_err(), "{bad}");
        }
    }
}
