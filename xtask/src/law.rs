//! The law of docs/laws.md, planted in a copy of the sources, is in all programs. Nothing else of
//! the copy is changed: a law is its folder and its line of a list.

mod circle;
mod live;
mod page;

use crate::device::STM32F405;
use crate::emulate::{QEMU, is_identical};
use crate::firmware::{self, FIRMWARE};
use crate::repo::{ended, shown};
use crate::session::{PROGRAMS, packages};
use crate::{c, mpi, prelude::*, python};
use circle::{Circle, circles};
use live::Live;
pub use page::Page;
use serde_json::{Value, json};

/// The folder of the copy in the target folder.
const FOLDER: &str = "law";
/// The file with the list of laws.
const LIST: &str = "controller/src/laws/list.rs";
/// Values of the page's scenario, and the limits of its row.
const RING_M: f64 = 3.0;
const LIMITS: [f64; 2] = [0.5, 100.0];
/// The page's commands, in its order.
const COMMANDS: [&str; 9] = [RUN, SET, REFUSED, SWEEP, VIEW, SAVED, CONTINUED, RANKS, DEVICE];
const RUN: &str = "staya run orbit.toml";
const SET: &str = "staya run orbit.toml --set plane.orbit.ring_m=6";
const REFUSED: &str = "staya run orbit.toml --set plane.orbit.ring_m=0.1";
const SWEEP: &str = "staya sweep rings.toml";
const VIEW: &str = "staya view orbit.toml";
const SAVED: &str = "staya run orbit.toml --checkpoint 120ticks";
const CONTINUED: &str = "staya run orbit.toml --from out/orbit.checkpoint";
const RANKS: &str = "mpirun -n 2 staya-mpi run orbit.toml";
const DEVICE: &str = "staya hil orbit.toml --device qemu:stm32f405 --devices 2";
/// Packages whose programs the short run needs.
const QUICK: [&str; 3] = [MAIN, "staya-lab", "staya-view"];
/// How far circles of single robots, which evade each other, may differ.
const SLACK_M: f64 = 0.5;

/// Host programs; with `is_all` also what takes minutes to build: C, Python, MPI, firmware, and a
/// copy without the line of the list.
pub fn run(s: &mut Session, is_all: bool) {
    let unplanted = s.staya("debug");
    let copy = s.repo.in_target(FOLDER);
    let mut page = None;
    s.report.step("a program without the law of docs/laws.md names those it has", || {
        let page = page.insert(Page::read(&s.repo.root)?);
        let commands: Vec<&str> = page.code("")?.lines().collect();
        ensure!(commands == COMMANDS, "the page has other commands: {commands:?}");
        page.plant(&s.repo, &copy, &[])?;
        settle(&s.repo, &copy)?;
        is_unknown(&copy, &unplanted?)
    });
    let Some(page) = page else { return };
    if is_all {
        s.report.step("a law without its line is unknown", || {
            page.plant(&s.repo, &copy, &[LIST])?;
            execute(&mut copy.cargo("build --locked --package staya --bin staya"))?;
            is_unknown(&copy, &copy.program("debug", MAIN))
        });
    }
    let is_built = s.report.step("the law of docs/laws.md, compiled", || {
        page.plant(&s.repo, &copy, &[])?;
        let mut build = copy.cargo("build --locked");
        let needed = PROGRAMS.iter().filter(|(package, _)| is_all || QUICK.contains(package));
        execute(build.args(needed.flat_map(|(package, program)| ["--package", package, "--bin", program])))
    });
    if !is_built {
        return;
    }
    let law = Law { page: &page, copy: &copy };
    s.report.step("the law in a scenario: robots circle as its values say", || law.runs());
    s.report.step("the law by --set, and out of range", || law.is_set());
    s.report.step("the law in a sweep", || law.sweeps());
    s.report.step("the law on a page, with its slider", || law.is_shown());
    s.report.step("the law in a checkpoint", || law.continues());
    if !is_all {
        return;
    }
    s.report.step("the law in C", || law.in_c());
    s.report.step("the law in Python", || law.in_python(&s.repo));
    s.report.step("the law on two ranks", || law.on_ranks(&s.repo));
    let is_built = s.with_toolchain("firmware with the law", STM32F405.target, |_, toolchain| {
        firmware::make(&copy, toolchain, STM32F405, FIRMWARE, &["lockstep"])
    });
    s.report.step("the law on the emulated stm32f405", || {
        ensure!(is_built, skipped("there is no firmware of it"));
        QEMU.prepare(&s.repo)?;
        let mut hil = law.staya(DEVICE);
        is_identical(hil.words("--ticks 150 --firmware").arg(copy.target.join("firmware")))
    });
}

/// Writes settings of cargo above the copy. It shares with the repository what is compiled from
/// registries; its own crates are compiled quickly, and apart, since their profile differs.
fn settle(repo: &Repo, copy: &Repo) -> Result<()> {
    let mut settings = format!("[build]\nbuild-dir = {}\n", json!(repo.target));
    for package in packages(repo)? {
        let name = package["name"].as_str().context("a package without a name")?;
        settings += &format!("[profile.dev.package.{name}]\nopt-level = 0\ncodegen-units = 16\n");
        settings += &format!("[profile.firmware.package.{name}]\ncodegen-units = 2\n");
    }
    files::update(&copy.target.join(".cargo/config.toml"), settings.as_bytes())
}

/// Whether this `staya` refuses the page's scenario, and names the laws that it has.
fn is_unknown(copy: &Repo, program: &Path) -> Result<()> {
    refuses(&mut staya(copy, program, RUN), &["no law \"orbit\"; it has waypoint, ", ", formation"])
}

/// A command of the page by this `staya`.
fn staya(copy: &Repo, program: &Path, command: &str) -> Command {
    let mut staya = copy.command(program);
    staya.args(command.split(' ').skip(1)).arg("--quiet");
    staya
}

/// Whether a command fails and says all these words.
fn refuses(command: &mut Command, words: &[&str]) -> Result<()> {
    println!("$ {}", shown(command));
    let output = command.output().context("cannot start")?;
    let said = String::from_utf8_lossy(&output.stderr);
    print!("{said}");
    ensure!(!output.status.success(), "it is not refused");
    words.iter().try_for_each(|word| {
        ensure!(said.contains(word), "the error does not say {word:?}");
        Ok(())
    })
}

/// The standard output of a command that succeeds; its errors are passed through.
fn printed(command: &mut Command) -> Result<String> {
    println!("$ {}", shown(command));
    let output = command.stderr(std::process::Stdio::inherit()).output();
    let output = output.context("cannot start")?;
    ended(Ok(output.status))?;
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The page's law in the programs of the copy.
struct Law<'a> {
    page: &'a Page,
    copy: &'a Repo,
}

impl Law<'_> {
    /// A command of the page.
    fn staya(&self, command: &str) -> Command {
        staya(self.copy, &self.copy.program("debug", MAIN), command)
    }

    /// The trace hash of a run, a command of the page with further arguments.
    fn hash(&self, command: &str, further: &str) -> Result<String> {
        let summary: Value = serde_json::from_str(&printed(self.staya(command).words(further).arg("--json"))?)?;
        summary["trace_hash"].as_str().map(String::from).context("no trace hash")
    }

    /// The circles of a run with further arguments.
    fn circles(&self, further: &str) -> Result<Vec<Circle>> {
        execute(self.staya(RUN).words(further))?;
        circles(&files::read(&self.copy.root.join("out/orbit/trace.csv"))?)
    }

    fn runs(&self) -> Result<()> {
        circle_at(&self.circles("")?, RING_M, true)?;
        circle_at(&self.circles("--set plane.orbit.sense=left")?, RING_M, false)?;
        circle_at(&self.circles("--set plane.orbit.ring_m=6")?, 2.0 * RING_M, true)
    }

    fn is_set(&self) -> Result<()> {
        let plain = self.hash(RUN, "")?;
        ensure!(self.hash(SET, "")? != plain, "the value changes nothing");
        ensure!(self.hash(RUN, "--set plane.orbit.ring_m=3")? == plain, "the default is another one");
        let [least, greatest] = LIMITS;
        let limits = format!("{least} to {greatest}");
        refuses(&mut self.staya(REFUSED), &["plane.orbit.ring_m", &limits])?;
        let mut wrong = self.staya(RUN);
        refuses(wrong.words("--set plane.orbit.sense=up"), &["plane.orbit.sense", "left", "right"])
    }

    fn sweeps(&self) -> Result<()> {
        execute(self.staya(SWEEP).arg("--restart"))?;
        let rows = files::read(&self.copy.root.join("out/sweeps/rings/rows.csv"))?;
        println!("{rows}");
        let mut hashes = Vec::new();
        for further in ["ring_m=3 sense=left", "ring_m=3 sense=right", "ring_m=6 sense=left", "ring_m=6 sense=right"] {
            let set: String = further.split(' ').map(|value| format!(" --set plane.orbit.{value}")).collect();
            hashes.push(self.hash(RUN, &set)?);
        }
        let found: Vec<&str> = hashes.iter().map(String::as_str).filter(|hash| rows.contains(*hash)).collect();
        ensure!(found.len() == hashes.len(), "rows without the hashes of their runs: {hashes:?}");
        hashes.sort();
        hashes.dedup();
        ensure!(hashes.len() == 4 && rows.lines().count() == 5, "not a run for each pair of values");
        Ok(())
    }

    fn is_shown(&self) -> Result<()> {
        let mut live = Live::start(&mut self.staya(VIEW))?;
        let scene = live.next("scene")?;
        let row = |name| {
            let mut rows = scene["parameters"].as_array().into_iter().flatten();
            rows.find(|row| row["name"] == json!(name)).with_context(|| format!("no slider for {name}"))
        };
        let ring = row("ring_m")?;
        println!("{ring}");
        let [least, greatest] = LIMITS;
        for (field, wanted) in [("least", json!(least)), ("greatest", json!(greatest)), ("value", json!(RING_M))] {
            ensure!(ring[field] == wanted, "{field} of the slider is {} instead of {wanted}", ring[field]);
        }
        row("sense")?;
        // Moving it is an order that the run takes.
        live.say(&json!({ "do": "order", "order": { "kind": "parameter", "name": "ring_m", "value": 5 } }))?;
        live.say(&json!({ "do": "save" }))?;
        let saved = live.next("saved")?;
        ensure!(
            saved["text"].as_str().is_some_and(|text| text.contains("name = \"ring_m\"")),
            "the order is not taken"
        );
        Ok(())
    }

    fn continues(&self) -> Result<()> {
        // A checkpoint of another law would not be replaced.
        files::remove(&self.copy.root.join("out"))?;
        let whole = self.hash(SAVED, "")?;
        ensure!(self.hash(RUN, "")? == whole, "checkpoints change the run");
        // The last one is of tick 240 of 300.
        let rest = self.hash(CONTINUED, "")?;
        ensure!(rest == whole, "the trace hash is {rest} instead of {whole}");
        Ok(())
    }

    fn in_c(&self) -> Result<()> {
        ensure!(self.copy.says("cc --version"), skipped("no cc"));
        execute(&mut self.copy.cargo("build --locked --package staya-c"))?;
        files::write(&self.copy.target.join("c/law.inc"), self.page.code("c")?)?;
        let said = c::program(self.copy, "cc -std=c11 -I../c", "controller/c/tests/law.c")?;
        print!("{said}");
        ensure!(said.trim() == "orbit, 2 rows: 2.0 m, right", "it does not circle as its values say");
        Ok(())
    }

    fn in_python(&self, repo: &Repo) -> Result<()> {
        let python = python::package_environment(repo)?;
        let folder = self.copy.target.join("python");
        python::wheel(self.copy, &python, "--no-deps --upgrade --target", &[&folder])?;
        let mut run = self.copy.command(python);
        let said = printed(run.args(["-c", self.page.code("python")?]).env("PYTHONPATH", &folder))?;
        let wanted = self.hash(RUN, "--set plane.orbit.ring_m=6 --set plane.orbit.sense=left")?;
        ensure!(said.trim() == wanted, "the trace hash is {said:?} instead of {wanted}");
        Ok(())
    }

    fn on_ranks(&self, repo: &Repo) -> Result<()> {
        let variables = mpi::find(repo).map_err(|reason| skipped(format!("{reason:#}")))?;
        let mut build = self.copy.cargo("build --locked --package staya-mpi --features mpi");
        execute(build.envs(variables.iter().cloned()))?;
        // As the tests on ranks start them.
        let program = "from ranks import figures, ranks\n\
            print(*figures(ranks(2, 'orbit.toml'), ['trace_hash'])['trace_hash'])";
        let mut run = self.copy.command("python3");
        run.args(["-c", program]).envs(variables).env("STAYA", self.copy.program("debug", MAIN));
        let said = printed(run.env("PYTHONPATH", self.copy.root.join("tests/mpi")))?;
        let wanted = self.hash(RUN, "")?;
        ensure!(said.trim() == wanted, "the trace hash is {said:?} instead of {wanted}");
        Ok(())
    }
}

/// Whether all robots have one circle, with this radius and sense.
fn circle_at(circles: &[Circle], radius_m: f64, is_right: bool) -> Result<()> {
    let mean = |axis: usize| circles.iter().map(|circle| circle.centre_m[axis]).sum::<f64>() / circles.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    println!("{} robots around {x:.2}, {y:.2}", circles.len());
    for circle in circles {
        let [own_x, own_y] = circle.centre_m;
        let is_near = (own_x - x).abs().max((own_y - y).abs()) < SLACK_M;
        let is_it = (circle.radius_m - radius_m).abs() < SLACK_M && circle.is_right == is_right;
        ensure!(is_near && is_it, "not around {x:.2}, {y:.2} at {radius_m} m: {circle:?}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_that_differ_are_reported() {
        let circle = |x, radius_m, is_right| Circle { centre_m: [x, 0.0], radius_m, is_right };
        let right = |x, radius_m| circle(x, radius_m, true);
        assert!(circle_at(&[right(0.0, 3.0), right(0.2, 2.9)], 3.0, true).is_ok());
        for wrong in [right(2.0, 3.0), right(0.0, 4.0), circle(0.0, 3.0, false), right(0.0, f64::NAN)] {
            assert!(circle_at(&[right(0.0, 3.0), wrong], 3.0, true).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn a_command_that_succeeds_or_says_something_else_is_not_refused() {
        let says = |line: &str| {
            let mut shell = Command::new("sh");
            shell.args(["-c", line]);
            refuses(&mut shell, &["0.5 to 100"])
        };
        assert!(says("echo 0.5 to 100 >&2; false").is_ok());
        assert!(says("echo 0.5 to 100 >&2").is_err() && says("echo 1 to 2 >&2; false").is_err());
    }
}
