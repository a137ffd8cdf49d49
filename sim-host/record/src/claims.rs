//! The claims of a paper's figure, beside what a full run of it measured.

use serde::{Deserialize, Serialize};
use staya_sim::file::{TEXT, read_text};
use staya_sim::scenario::{Node, Source};
use std::path::Path;

/// A claim of the figure that a scenario belongs to.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Claim {
    /// The claim.
    pub claim: String,
    /// The paper's figure; may be empty.
    pub paper: String,
    /// Name of the measure.
    pub measure: String,
    /// Measure, points and limits; empty if no full run is recorded.
    pub condition: String,
    /// The values of the recorded run.
    pub measured: String,
    /// `"holds"`, `"does not hold"` or `"too few runs"`.
    pub judgement: String,
    /// Why the claim is known not to hold.
    pub fails: String,
}

/// The record of a full run beside a plan, as far as it is shown.
#[derive(Deserialize)]
struct Record {
    conditions: Vec<Condition>,
}

#[derive(Deserialize)]
struct Condition {
    condition: String,
    judgement: String,
    measured: String,
}

/// The claims of the plan `figure.toml` in the folder of a scenario, as far as they are of this
/// scenario. Empty if there is no plan, or if it does not name the scenario.
///
/// # Errors
/// Says which file cannot be read.
pub fn claims(scenario: &Path) -> Result<Vec<Claim>, String> {
    let folder = scenario.parent().unwrap_or(Path::new(""));
    let (plan, record) = (folder.join("figure.toml"), folder.join("measured.json"));
    if !plan.is_file() {
        return Ok(Vec::new());
    }
    let wrong = |path: &Path, error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let text = read_text(&plan, TEXT).map_err(|error| wrong(&plan, &error))?;
    let source = Source::new(&plan, &text).map_err(|error| error.to_string())?;
    let names = |node: &Node<'_>| -> Vec<String> {
        let list = node.get_ref().as_array().map_or(std::slice::from_ref(node), |list| &list[..]);
        list.iter().filter_map(|node| node.get_ref().as_str()).map(str::to_owned).collect()
    };
    let all = source.get("scenario").map(names).unwrap_or_default();
    if !all.iter().any(|name| scenario.file_name().is_some_and(|own| own == Path::new(name))) {
        return Ok(Vec::new());
    }
    let conditions = match record.is_file() {
        true => {
            let text = read_text(&record, TEXT).map_err(|error| wrong(&record, &error))?;
            let record: Record = serde_json::from_str(&text).map_err(|error| wrong(&record, &error))?;
            record.conditions
        }
        false => Vec::new(),
    };
    let accepted = source.get("accept").and_then(|node| node.get_ref().as_array());
    let accepted: Vec<&Node<'_>> = accepted.into_iter().flat_map(|list| list.iter()).collect();
    let stem = scenario.file_stem().unwrap_or_default();
    let claim = |(index, node): (usize, &&Node<'_>)| {
        let table = node.get_ref().as_table()?;
        let text = |name: &str| table.get(name).and_then(|node| node.get_ref().as_str()).unwrap_or_default().to_owned();
        let points = table.get("where").and_then(|node| node.get_ref().as_table());
        let is_own = points.and_then(|points| points.get("scenario")).is_none_or(|node| {
            let of = names(node);
            of.iter().any(|name| stem == Path::new(name).file_stem().unwrap_or_default())
        });
        let claim = Claim {
            claim: text("claim"),
            paper: text("paper"),
            measure: text("measure"),
            fails: text("fails"),
            ..Claim::default()
        };
        // A record of an earlier plan may have other conditions.
        let found = conditions.get(index).filter(|found| conditions.len() == accepted.len() && is_of(found, &claim));
        let claim = match found {
            None => claim,
            Some(found) => Claim {
                condition: found.condition.clone(),
                measured: found.measured.clone(),
                judgement: found.judgement.replace('_', " "),
                ..claim
            },
        };
        (is_own && !claim.claim.is_empty()).then_some(claim)
    };
    Ok(accepted.iter().enumerate().filter_map(claim).collect())
}

fn is_of(condition: &Condition, claim: &Claim) -> bool {
    condition.condition.split(' ').next() == Some(&claim.measure)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn shipped(path: &str) -> Vec<Claim> {
        claims(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)).expect("a figure")
    }

    #[test]
    fn a_scenario_of_a_figure_has_its_claims_with_the_record() {
        let all = shipped("papers/pav/goals/scenario.toml");
        let shares: Vec<_> = all.iter().filter(|claim| claim.paper == "about equal").collect();
        assert_eq!(shares.len(), 3);
        for claim in shares {
            assert!(claim.condition.starts_with(&claim.measure) && claim.judgement == "holds", "{claim:?}");
            assert!(claim.measured.contains(" to 0.") && claim.fails.is_empty(), "{claim:?}");
        }
    }

    #[test]
    fn claims_of_other_scenarios_and_conditions_without_a_claim_are_left_out() {
        let (one, other) = (shipped("papers/orca/crossing/four_ways.toml"), shipped("papers/orca/crossing/mixed.toml"));
        let has = |all: &[Claim], text: &str| all.iter().any(|claim| claim.claim.starts_with(text));
        assert!(has(&one, "`four_ways`") && !has(&one, "`mixed`") && has(&one, "Robots do not overlap"));
        assert!(!has(&other, "`four_ways`") && has(&other, "`mixed`"));
        assert!(one.iter().chain(&other).all(|claim| !claim.claim.is_empty()));
        assert_eq!(shipped("scenarios/swap-circle.toml"), []);
        // The figure does not name it.
        assert_eq!(shipped("papers/pav/goals/other.toml"), []);
    }

    #[test]
    fn a_record_of_another_plan_is_not_shown_and_a_damaged_one_is_named() {
        let folder = std::env::temp_dir().join(format!("staya-claims-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let (plan, record, scenario) =
            (folder.join("figure.toml"), folder.join("measured.json"), folder.join("s.toml"));
        let accept = "[[accept]]\nclaim = \"It is so\"\npaper = \"3\"\nmeasure = \"arrived\"\nequals = 3\n";
        fs::write(&plan, format!("scenario = \"s.toml\"\n{accept}")).expect("a plan");
        let judged = |measure: &str| {
            let record = format!(
                "{{\"conditions\": [{{\"condition\": \"{measure} = 3\", \"judgement\": \"does_not_hold\", \
                 \"measured\": \"2\"}}]}}"
            );
            fs::write(folder.join("measured.json"), record).expect("a record");
            claims(&scenario).expect("claims")
        };
        let found = judged("arrived");
        assert_eq!((found[0].judgement.as_str(), found[0].measured.as_str()), ("does not hold", "2"));
        assert_eq!(judged("collisions")[0].judgement, "");
        fs::write(&record, "{").expect("a record");
        let error = claims(&scenario).expect_err("it is damaged");
        assert!(error.contains("measured.json: "), "{error}");
        fs::remove_dir_all(&folder).expect("it is there");
    }
}
