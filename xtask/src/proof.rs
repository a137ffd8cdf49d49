//! `cargo xtask proof`: the proof in `controller/proof` that robots never touch.
//!
//! Coq compiles it, its second program checks the result again, and the axioms must be those of
//! Coq's real numbers. Then errors are planted in a copy, one at a time, and Coq must refuse each:
//! so the theorems depend on every part of the rule.

use crate::apt::Tools;
use crate::prelude::*;
use crate::repo::{ended, shown};
use std::collections::BTreeSet;

const COQ: Tools = Tools {
    packages: "coq",
    programs: "coqc coqchk",
    question: "coqc --version && coqchk --version",
    ways: "unpack install",
};
const FOLDER: &str = "controller/proof";
/// The files, each after those that it needs.
const FILES: [&str; 9] = ["Space", "Rule", "Course", "Invariant", "Hearing", "Never", "Clock", "Brake", "Touch"];
/// The files up to this one are compiled with a planted error; the others have no theorem on the
/// rule, or robots that break it.
const LAST_OF_THEOREM: &str = "Clock";

/// The rule in Rust, and the test that compares it with the hypotheses of the theorems.
const RULE: &str = "controller/src/neighbor/gap_limit.rs";
const TIE: &str = "test --locked --package staya-controller --no-default-features --features wire --lib hypotheses";

/// The axioms of Coq's real numbers, which the theorems use.
const AXIOMS: [&str; 3] = ["sig_forall_dec", "sig_not_dec", "functional_extensionality_dep"];
/// An axiom in the modules that come along with the real numbers. No theorem uses it.
const LOADED: &str = "classic";

/// Each part of the rule that the theorems depend on; `file` is one of [`FILES`].
#[rustfmt::skip]
const PLANTS: [Plant; 20] = [
    Plant { name: "share 6/10", file: "Invariant",
        right: "Hypothesis half : share = 1 / 2.",
        wrong: "Hypothesis half : share = 6 / 10." },
    Plant { name: "sine alone", file: "Space",
        right: "else closing * cos + side * slant.",
        wrong: "else closing + side * slant." },
    Plant { name: "cosine inside the cone", file: "Space",
        right: "then norm m else closing",
        wrong: "then closing * cos + side * slant else closing" },
    Plant { name: "cosine without the sine", file: "Space",
        right: "else closing * cos + side * slant.",
        wrong: "else closing * cos." },
    Plant { name: "tilt by the distance alone", file: "Rule",
        right: "reach k t / (norm (seen k t) - reach k t / 2)",
        wrong: "reach k t / norm (seen k t)" },
    Plant { name: "ball does not grow", file: "Rule",
        right: "norm (seen k t) - keep - reach k t.",
        wrong: "norm (seen k t) - keep." },
    Plant { name: "tolerance not subtracted", file: "Rule",
        right: "- Rmax (taken k b) 0 - 2 * slack.",
        wrong: "- Rmax (taken k b) 0." },
    Plant { name: "receding counted", file: "Rule",
        right: "- Rmax (taken k b) 0 - 2 * slack.",
        wrong: "- taken k b - 2 * slack." },
    Plant { name: "stored bound not reduced by the motion", file: "Rule",
        right: "- Rmax (taken k b) 0 - 2 * slack.",
        wrong: "- 2 * slack." },
    Plant { name: "bound kept over a pause", file: "Rule",
        right: "exists b, last p b t /\\ decides p b",
        wrong: "exists b, last p b t /\\ acts p b = true" },
    Plant { name: "credit ignored", file: "Rule",
        right: "(spare k t + decisions q t <= spare k b + halved k t + decisions q b)%nat",
        wrong: "(spare k t <= spare k b + halved k t)%nat" },
    Plant { name: "old path forgotten by the stored bound", file: "Rule",
        right: "2 ^ spare k t * (gap k t + 2 * slack) <= left_aside p k b",
        wrong: "0 <= left_aside p k b - left_aside p k b" },
    Plant { name: "whole gap to a robot that paused before", file: "Rule",
        right: "forall u, (b < u <= t)%nat -> acts c u = false.",
        wrong: "forall u, (b < u < t)%nat -> acts c u = false." },
    Plant { name: "whole gap to a silent robot that moves", file: "Rule",
        right: "taken k t <= gap k t - fastest",
        wrong: "taken k t <= gap k t" },
    Plant { name: "ends alone", file: "Rule",
        right: "<= Rmax (beyond k t + slack) 0",
        wrong: "<= norm (motion p t)" },
    Plant { name: "plane before the end alone", file: "Rule",
        right: "clear k t <= dot (aside k t) (begun k t)",
        wrong: "clear k t <= dot (aside k t) (seen k t)" },
    Plant { name: "retreat from the end alone", file: "Rule",
        right: "dot (begun k t) (motion p t) + reach k t",
        wrong: "dot (seen k t) (motion p t) + reach k t" },
    Plant { name: "path in progress counts as over", file: "Hearing",
        right: "/\\ (heard t <= t)%nat /\\ (1 <= count t)%nat",
        wrong: "/\\ (heard t <= t)%nat /\\ (0 <= count t)%nat" },
    Plant { name: "margin without twice the slack", file: "Never",
        right: "Hypothesis margin_large : error + 2 * slack <= margin.",
        wrong: "Hypothesis margin_large : error + slack <= margin." },
    Plant { name: "window as long as a step", file: "Clock",
        right: "Hypothesis window_short : 2 * window <= step.",
        wrong: "Hypothesis window_short : window <= step." },
];

/// Each part of the rule in Rust: the program's text, and an error.
#[rustfmt::skip]
const CHANGES: [(&str, &str, &str); 15] = [
    ("51 % of the gap to a robot that is heard",
        "((gap * S::HALF).min(gap - other_m), S::ZERO)",
        "((gap * S::from_milli(510)).min(gap - other_m), S::ZERO)"),
    ("51 % of the gap to a silent robot",
        "(gap * S::HALF, comes_mps",
        "(gap * S::from_milli(510), comes_mps"),
    ("51 % of a stored bound",
        "other.gap_m * S::HALF - self.taken_m",
        "other.gap_m * S::from_milli(510) - self.taken_m"),
    ("first bound halved once",
        "let is_first = !self.is_synchronous && gap <= ball_m;",
        "let is_first = gap > ball_m;"),
    ("99 % of the growth",
        "inflation.growth_mps * silent_s;",
        "inflation.growth_mps * silent_s * S::from_milli(990);"),
    ("sine alone",
        "closing * self.cos + side * self.slant }",
        "closing + side * self.slant }"),
    ("cosine inside the cone",
        "side * self.cos <= closing * self.slant;",
        "side < S::ZERO;"),
    ("whole gap to a silent robot that does not give way",
        "(gap - comes_mps * body.step_s, comes_mps",
        "(gap, comes_mps"),
    ("tolerance not subtracted",
        "gap.max(kept_m - S::from_micro(TOLERANCE_UM) * S::TWO)",
        "gap.max(kept_m)"),
    ("receding counted out of phase",
        "taken_mps = taken_mps.max(S::ZERO);",
        "taken_mps = taken_mps.max(-S::ONE);"),
    ("path in use ignored",
        "limit.left_m = limit.left_m.min(gap_m);",
        "limit.left_m = limit.left_m.max(gap_m);"),
    ("retreat from the nearest point alone",
        "if gap_m < S::ZERO { end_m - told_m } else { nearest_m }",
        "nearest_m"),
    ("no robot is hidden",
        "is_silent && reach_m >= distance)",
        "is_silent && reach_m < S::ZERO)"),
    ("place without rounding",
        "let mut reach_m = S::from_micro(OFFSET_ERROR_UM);",
        "let mut reach_m = S::from_micro(OFFSET_ERROR_UM >> 4);"),
    ("lost robot exactly at its place",
        "if other.is_lost() { other.gap_m } else { S::ZERO };",
        "S::ZERO;"),
];

/// Compiles the proof, checks it again, prints its axioms, plants the errors, and plants errors in
/// the rule in Rust.
pub fn run(s: &mut Session) {
    theorems_hold(s);
    for (name, right, wrong) in CHANGES {
        let plant = Plant { name, file: RULE, right, wrong };
        s.report.step(&format!("noticed in Rust: {name}"), || is_noticed(&s.repo, &plant));
    }
}

/// Whether a test finds a decision that breaks a hypothesis, if the rule in Rust is changed.
fn is_noticed(repo: &Repo, plant: &Plant) -> Result<()> {
    let folder = repo.target.join("proof/rust");
    repo.plant(&folder, plant)?;
    let mut test = repo.cargo(TIE);
    test.current_dir(&folder).env("CARGO_TARGET_DIR", repo.target.join("proof/rust-target"));
    test.env("CARGO_PROFILE_DEV_OPT_LEVEL", "1");
    println!("$ {}", shown(&test));
    let said = test.output().context("cannot start cargo")?;
    let said = String::from_utf8_lossy(&said.stdout).into_owned() + &String::from_utf8_lossy(&said.stderr);
    if said.contains("1 failed") {
        return Ok(());
    }
    print!("{said}");
    ensure!(said.contains("1 passed"), "the test does not run");
    bail!("the test still passes with `{}`", plant.wrong)
}

fn theorems_hold(s: &mut Session) {
    let whole = s.repo.target.join("proof/whole");
    let is_compiled = s.report.step("the proof that robots never touch", || {
        COQ.prepare(&s.repo)?;
        copy(&s.repo, &whole)?;
        FILES.iter().try_for_each(|file| execute(coqc(&s.repo, &whole).arg(format!("{file}.v"))))
    });
    if !is_compiled {
        return;
    }
    s.report.part("its axioms", || axioms(&s.repo, &whole));
    s.report.step("the proof, checked again", || {
        let mut coqchk = s.repo.command("coqchk");
        coqchk.words("-silent -o").args(FILES).current_dir(&whole);
        println!("$ {}", shown(&coqchk));
        let output = coqchk.output();
        // It prints the summary as a complaint.
        let said = output.as_ref().map(|output| [&output.stdout[..], &output.stderr].concat()).unwrap_or_default();
        let summary = String::from_utf8_lossy(&said);
        print!("{summary}");
        ended(output.map(|output| output.status))?;
        judged(&summary)
    });
    for plant in &PLANTS {
        s.report.step(&format!("refused: {}", plant.name), || is_refused(&s.repo, &whole, plant));
    }
}

/// Copies the sources into a folder that is empty.
fn copy(repo: &Repo, folder: &Path) -> Result<()> {
    files::make_empty(folder)?;
    FILES.iter().try_for_each(|file| {
        let file = format!("{file}.v");
        files::copy(&repo.root.join(FOLDER).join(&file), &folder.join(&file))
    })
}

fn coqc(repo: &Repo, folder: &Path) -> Command {
    let mut coqc = repo.command("coqc");
    coqc.arg("-q").current_dir(folder);
    coqc
}

/// One success for each theorem that depends on the axioms of the real numbers only.
fn axioms(repo: &Repo, whole: &Path) -> Result<(Counts, String)> {
    let mut asked = format!("Require Import {}.\n", FILES.join(" "));
    let mut count = 0;
    for file in FILES {
        for theorem in theorems(&files::read(&whole.join(format!("{file}.v")))?) {
            asked += &format!("Print Assumptions {file}.{theorem}.\n");
            count += 1;
        }
    }
    files::write(&whole.join("Axioms.v"), asked)?;
    let mut answer = String::new();
    run_reading(coqc(repo, whole).arg("Axioms.v"), |line| answer += &format!("{line}\n"))?;
    let used = assumed(&answer);
    let foreign: Vec<&str> = used.iter().copied().filter(|name| !AXIOMS.contains(name)).collect();
    ensure!(foreign.is_empty(), "not axioms of the real numbers: {}", foreign.join(", "));
    ensure!(count > 0, "no theorem was found");
    let note = format!("{} of Coq's real numbers", used.into_iter().collect::<Vec<_>>().join(", "));
    Ok((Counts { passed: count, ..Counts::default() }, note))
}

/// The names of the theorems of a file.
fn theorems(text: &str) -> impl Iterator<Item = &str> {
    let stated = text.lines().filter_map(|line| line.split_once(' '));
    let stated = stated.filter(|(word, _)| ["Theorem", "Corollary"].contains(word));
    stated.filter_map(|(_, rest)| rest.split([' ', ':', '(']).next())
}

/// The axioms in the answers to `Print Assumptions`, without their modules.
fn assumed(answer: &str) -> BTreeSet<&str> {
    let entries = answer.lines().filter(|line| !line.starts_with(' '));
    let names = entries.filter_map(|line| line.split([' ', ':']).find(|word| !word.is_empty()));
    names.filter(|name| !["Axioms", "Closed"].contains(name)).map(last_part).collect()
}

fn last_part(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or(name)
}

/// Whether the summary of `coqchk` has no other axioms, and nothing that is assumed instead of
/// checked.
fn judged(summary: &str) -> Result<()> {
    let mut lines = summary.lines().skip_while(|line| !line.starts_with("* Axioms:"));
    let axioms = lines.by_ref().skip(1).map(str::trim).take_while(|line| !line.is_empty() && !line.starts_with('*'));
    let axioms: Vec<&str> = axioms.collect();
    ensure!(!axioms.is_empty(), "coqchk has printed no axioms");
    let foreign: Vec<&str> =
        axioms.into_iter().filter(|name| last_part(name) != LOADED && !AXIOMS.contains(&last_part(name))).collect();
    ensure!(foreign.is_empty(), "not axioms of the real numbers: {}", foreign.join(", "));
    let assumptions: Vec<&str> = lines.filter(|line| line.starts_with('*')).collect();
    ensure!(assumptions.len() == 3, "coqchk has printed another summary");
    let unchecked = assumptions.iter().find(|line| !line.ends_with("<none>"));
    ensure!(unchecked.is_none(), "unchecked: {}", unchecked.unwrap_or(&""));
    Ok(())
}

/// Compiles the files with the error, from its own file on.
fn is_refused(repo: &Repo, whole: &Path, plant: &Plant) -> Result<()> {
    let folder = repo.target.join("proof/planted");
    copy(repo, &folder)?;
    let source = folder.join(format!("{}.v", plant.file));
    let text = files::read(&source)?;
    files::write(&source, plant.planted(&text)?)?;
    let mut is_behind = false;
    for file in FILES {
        is_behind |= file == plant.file;
        if !is_behind {
            let compiled = format!("{file}.vo");
            files::copy(&whole.join(&compiled), &folder.join(&compiled))?;
            continue;
        }
        let output = coqc(repo, &folder).arg(format!("{file}.v")).output().context("cannot start coqc")?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            print!("{said}");
            return is_error_of_proof(&said);
        }
        if file == LAST_OF_THEOREM {
            break;
        }
    }
    bail!("{}.v: the proof still passes with `{}`", plant.file, plant.wrong)
}

/// Whether a step of a proof fails, and not merely the spelling of the error.
fn is_error_of_proof(said: &str) -> Result<()> {
    ensure!(said.contains("Error:"), "coqc fails without an error");
    for spelling in ["Syntax error", "was not found in the current"] {
        ensure!(!said.contains(spelling), "refused for its spelling: {spelling}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn folder() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(FOLDER)
    }

    #[test]
    fn every_file_of_the_folder_is_compiled() {
        let sources = files::sources(&folder(), &["v"]).expect("the folder");
        let stems: BTreeSet<String> = sources.iter().map(|path| files::stem(path)).collect();
        assert_eq!(stems, FILES.iter().map(ToString::to_string).collect());
        assert!(FILES.contains(&LAST_OF_THEOREM));
    }

    #[test]
    fn every_error_has_its_place_and_name() {
        let names: BTreeSet<&str> = PLANTS.iter().map(|plant| plant.name).collect();
        assert_eq!(names.len(), PLANTS.len());
        for plant in &PLANTS {
            let text = files::read(&folder().join(format!("{}.v", plant.file))).expect(plant.file);
            assert_ne!(plant.planted(&text).expect(plant.name), text);
        }
    }

    #[test]
    fn every_change_has_its_place() {
        let text = files::read(&folder().join("../../").join(RULE)).expect(RULE);
        for (name, right, wrong) in CHANGES {
            assert!(text.matches(right).count() == 1 && right != wrong, "{name}: `{right}`");
        }
    }

    #[test]
    fn error_that_changes_nothing_or_has_no_place_is_a_failure() {
        let plant = Plant { name: "", file: "Rule", right: "a", wrong: "b" };
        assert_eq!(plant.planted("a c").ok().as_deref(), Some("b c"));
        assert!(plant.planted("a a").is_err() && plant.planted("c").is_err());
        assert!(Plant { wrong: "a", ..plant }.planted("a").is_err());
    }

    #[test]
    fn spelling_does_not_count_as_a_refusal() {
        assert!(is_error_of_proof("File \"./Rule.v\", line 1:\nError: Tactic failure: Cannot find witness.").is_ok());
        assert!(is_error_of_proof("Error: Syntax error: '.' expected after [gallina].").is_err());
        assert!(is_error_of_proof("Error: The reference reech was not found in the current\nenvironment.").is_err());
        assert!(is_error_of_proof("").is_err());
    }

    #[test]
    fn theorems_and_their_axioms_are_read() {
        let text = "Lemma a b : c.\nTheorem cone u w : d.\n  Theorem no.\nCorollary safe: e.\n(* Theorem x *)\n";
        assert_eq!(theorems(text).collect::<Vec<_>>(), ["cone", "safe"]);
        let answer = "Closed under the global context\nAxioms:\nA.sig_not_dec : forall P : Prop, P\nB.other\n  : nat\n";
        assert_eq!(assumed(answer).into_iter().collect::<Vec<_>>(), ["other", "sig_not_dec"]);
    }

    #[test]
    fn summary_with_a_foreign_axiom_or_an_assumption_is_refused() {
        let summary = |axiom: &str, last: &str| {
            format!(
                "* Theory: Set is predicative\n\n* Axioms:\n    Coq.Reals.Q.sig_not_dec\n    {axiom}\n\n\
                 * Constants relying on type-in-type: <none>\n\n* Constants on unsafe fixpoints: <none>\n\n\
                 * Inductives whose positivity is assumed: {last}\n"
            )
        };
        assert!(judged(&summary("Coq.Logic.Classical_Prop.classic", "<none>")).is_ok());
        assert!(judged(&summary("Never.two_robots_never_touch", "<none>")).is_err());
        assert!(judged(&summary("Coq.Logic.Classical_Prop.classic", "Space.vec")).is_err());
        assert!(judged("").is_err());
    }
}
