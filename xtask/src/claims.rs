//! `cargo xtask claims`: runs figures of papers with all their seeds, and keeps what they showed in
//! their folders; docs/results.md prints it beside what the papers claim.

pub mod planted;

use crate::prelude::*;
use serde_json::Value;

/// The record of a full run, in the folder of its results and in that of the figure.
const RECORD: &str = "measured.json";

/// The command: figures with these short names, or all.
pub fn run(s: &mut Session, names: &[String]) {
    let staya = s.staya("release");
    let figures = match staya.as_ref().map_err(|error| anyhow!("{error}")).and_then(|staya| list(&s.repo, staya)) {
        Ok(figures) => figures,
        Err(error) => {
            s.report.step("the list of figures", || Err(error));
            return;
        }
    };
    for name in names.iter().filter(|name| figures.iter().all(|[known, _]| known != *name)) {
        s.report.step(name, || bail!("there is no such figure; `staya experiment` lists all"));
    }
    let Ok(staya) = staya else { return };
    for [name, place] in figures.iter().filter(|[name, _]| names.is_empty() || names.contains(name)) {
        let out = s.repo.target.join("claims").join(name);
        let folder = s.repo.root.join("papers").join(place);
        let shows = &mut s.repo.command(&staya);
        shows.args(["experiment", name, "--restart", "--out"]).arg(&out);
        s.report.step(name, || {
            let ended = execute(shows);
            let record = out.join(RECORD);
            if record.is_file() {
                files::write(&folder.join(RECORD), &files::read(&record)?)?;
            }
            ended
        });
    }
    println!("\n`cargo xtask bless golden_claims` prints them in docs/results.md");
}

/// Short names and places of all figures.
fn list(repo: &Repo, staya: &Path) -> Result<Vec<[String; 2]>> {
    let text = output_of(repo.command(staya).args(["experiment", "--json"])).context("no list of figures")?;
    let list: Value = serde_json::from_str(&text)?;
    let figures = list["experiments"].as_array().context("no list of figures")?;
    let words = |figure: &Value| Some([figure["name"].as_str()?.to_owned(), figure["place"].as_str()?.to_owned()]);
    figures.iter().map(|figure| words(figure).context("a figure without a name")).collect()
}
