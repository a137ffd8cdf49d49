use super::*;
use crate::sweep::aggregate;
use crate::sweep::merge::Merged;
use crate::sweep::plan::Changes;
use crate::sweep::row::{Outcome, Row};
use proptest::prelude::*;
use std::fs;

const SCENARIO: &str = "name = 'duel'\nticks = 20\ntick_s = 0.1\n\n[radio]\nrange_m = 5\n\n[plane]\nradius_m = 0.2\n\
    max_speed_mps = 1\n\n[plane.robots.circle]\ncount = 4\nradius_m = 3\n";

/// The verdict on values at losses of 0, 0.1 and 0.2, beside a reference of 10, 10 and 20.
fn verdict(condition: &str, values: [&[f64]; 3]) -> Verdict {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("duel.toml"), SCENARIO).expect("room");
    fs::write(folder.path().join("paper.csv"), "radio.loss,arrived\n0,10\n0.1,10\n0.2,20\n").expect("room");
    let seeds = values[0].len();
    let text = format!(
        "name = 'p'\nscenario = 'duel.toml'\nseeds = {seeds}\nmeasures = ['arrived']\nreference = 'paper.csv'\n\
         [axes]\nradio.loss = [0, 0.1, 0.2]\n[[accept]]\nmeasure = 'arrived'\n{condition}\n"
    );
    let plan = Plan::parse(&text, &folder.path().join("plan.toml"), &Changes::default()).expect(condition);
    let row = |(run, value): (u64, &f64)| Row {
        run,
        outcome: Outcome::Done,
        figures: vec![Figure(Some(*value))],
        trace_hash: String::new(),
    };
    let rows: Vec<_> = (0..).zip(values.concat().iter()).map(row).collect();
    let merged = Merged { rows, ..Merged::default() };
    plan.accept[0].judge(&plan, &aggregate::points(&plan, &merged))
}

fn judged(condition: &str, values: [&[f64]; 3]) -> Judgement {
    verdict(condition, values).judgement
}

#[test]
fn the_whole_interval_of_a_mean_lies_inside() {
    let least = |values: &[f64]| judged("where = { loss = 0 }\nat_least = 0.9\nmean = true", [values; 3]);
    assert_eq!(least(&[0.95, 0.96, 0.97, 0.95, 0.96]), Judgement::Holds);
    assert_eq!(least(&[0.5, 0.52, 0.51, 0.5, 0.53]), Judgement::DoesNotHold);
    // The mean is 0.898, and the interval of two runs is wide.
    assert_eq!(least(&[0.969, 0.827]), Judgement::TooFewRuns);
    // Few and wild runs decide nothing, whatever their mean.
    assert_eq!(least(&[1.0, 0.0, 1.0, 1.0, 1.0, 1.0]), Judgement::TooFewRuns);
    assert_eq!(least(&[1.0]), Judgement::TooFewRuns);
    assert_eq!(least(&[1.0; 4]), Judgement::TooFewRuns);
    assert_eq!(least(&[1.0; 5]), Judgement::Holds);
}

#[test]
fn a_limit_without_mean_is_that_of_each_run() {
    let each = |values: [&[f64]; 3]| verdict("equals = 4", values);
    assert_eq!(each([&[4.0], &[4.0], &[4.0]]).judgement, Judgement::Holds);
    let broken = each([&[4.0, 4.0], &[4.0, 3.0], &[4.0, 4.0]]);
    assert_eq!((broken.judgement, &broken.measured[..]), (Judgement::DoesNotHold, "3 to 4 at 0.1"));
}

#[test]
fn the_interval_is_near_the_reference() {
    let near = |low: &[f64], high: &[f64]| judged("within = 0.1", [low, low, high]);
    assert_eq!(near(&[10.1, 10.2, 9.9, 9.8, 10.0], &[20.5, 20.0, 19.5, 20.1, 19.9]), Judgement::Holds);
    assert_eq!(near(&[10.1, 10.2, 9.9, 9.8, 10.0], &[10.0, 10.1, 9.9, 10.0, 10.1]), Judgement::DoesNotHold);
    assert_eq!(near(&[8.0, 12.0, 9.0, 11.0, 10.0], &[20.5, 20.0, 19.5, 20.1, 19.9]), Judgement::TooFewRuns);
}

#[test]
fn points_are_compared_seed_by_seed() {
    // Means differ by less than their deviation, but in each run by a tenth.
    let wild = [5.0, 9.0, 7.0, 8.0, 6.0, 5.5];
    let less = wild.map(|value| value - 0.7);
    let over = |limit: &str, values| judged(&format!("where = {{ loss = 0.1 }}\nmean = true\n{limit}"), values);
    let beside = "beside = { loss = 0 }";
    assert_eq!(over(&format!("{beside}\nat_most = 0.95"), [&wild, &less, &wild]), Judgement::Holds);
    assert_eq!(over(&format!("{beside}\nat_least = 1"), [&wild, &less, &wild]), Judgement::DoesNotHold);
    assert_eq!(over(&format!("{beside}\nat_most = 0.9"), [&wild, &less, &wild]), Judgement::TooFewRuns);
    // From one value to the next; the first has none before it.
    let falls = "mean = true\nprevious = 'radio.loss'\nat_most = 1";
    let least = less.map(|value| value - 0.1);
    assert_eq!(judged(falls, [&wild, &less, &least]), Judgement::Holds);
    assert_eq!(judged(falls, [&less, &wild, &least]), Judgement::DoesNotHold);
    assert_eq!(verdict(falls, [&less, &wild, &least]).measured, "1.1157 at 0.1");
}

#[test]
fn a_known_failure_is_expected_until_it_holds() {
    let known = "where = { loss = 0 }\nequals = 4\nclaim = 'all arrive'\npaper = '4'\nfails = 'one jams'";
    let verdict = |value: f64| verdict(known, [&[value]; 3]);
    assert!(verdict(3.0).is_expected() && !verdict(4.0).is_expected());
    let Verdict { claim, paper, fails, .. } = verdict(3.0);
    assert_eq!((&claim[..], &paper[..], fails.as_deref()), ("all arrive", "4", Some("one jams")));
}

proptest! {
    #[test]
    fn opposite_limits_hold_or_fail_opposed(values in prop::collection::vec(0.0..2.0, 1..9), limit in 0.2..1.8) {
        let judge = |limits: &str| judged(&format!("{limits} = {limit}\nmean = true"), [&values; 3]);
        let (most, least) = (judge("at_most"), judge("at_least"));
        let is_one = |one, other| most == one && least == other || most == other && least == one;
        let are_undecided = most == Judgement::TooFewRuns && least == Judgement::TooFewRuns;
        let is_small = values.len() < 5 && is_one(Judgement::TooFewRuns, Judgement::DoesNotHold);
        prop_assert!(are_undecided || is_small || is_one(Judgement::Holds, Judgement::DoesNotHold));
        prop_assert!(values.len() >= 5 || most != Judgement::Holds && least != Judgement::Holds);
    }
}
