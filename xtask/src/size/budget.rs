//! Limits of a part, and which of them are breached.

use super::{Measured, Row};
use crate::prelude::*;
use std::collections::BTreeMap;
use toml::{Table, Value};

/// The limits of a part: figures, and tables of figures of cases or laws. Other figures have no
/// limit.
pub fn read(text: &str, part: &str) -> Result<Table> {
    let parts: Table = text.parse()?;
    let limits = parts.get(part).and_then(Value::as_table).with_context(|| format!("no limits for {part}"))?;
    ensure!(!number(limits).is_empty(), "no `number` for {part}");
    Ok(limits.clone())
}

/// The kind of number that the limits are for.
pub fn number(limits: &Table) -> &str {
    limits.get("number").and_then(Value::as_str).unwrap_or_default()
}

/// A line for each limit that is breached, or that nothing was measured for.
pub fn breaches(limits: &Table, measured: &Measured) -> Vec<String> {
    let figures = figures(limits, measured);
    let mut breaches = Vec::new();
    let mut check = |name: &str, limit: &Value| match (limit.as_integer(), figures.get(name)) {
        (Some(limit), Some(&figure)) if i128::from(figure) <= limit.into() => {}
        (Some(limit), Some(figure)) => breaches.push(format!("{name}: {figure}, at most {limit}")),
        _ => breaches.push(format!("{name}: limited, but not measured")),
    };
    for (name, limit) in limits.iter().filter(|(name, _)| *name != "number") {
        match limit.as_table() {
            None => check(name, limit),
            Some(cases) => cases.iter().for_each(|(case, limit)| check(&format!("{name}.{case}"), limit)),
        }
    }
    breaches
}

/// The same of a program alone, by the limits whose names begin with its name.
pub fn breaches_of(program: &str, row: Row, limits: &Table) -> Vec<String> {
    let own = limits.iter().filter(|(name, _)| name.strip_prefix(program).is_some_and(|rest| rest.starts_with('_')));
    let own: Table = own.map(|(name, limit)| (name.clone(), limit.clone())).collect();
    breaches(&own, &Measured { programs: [(program.into(), row)].into(), ..Measured::default() })
}

/// The figures by the names of their limits, in the kind of number that limits are for; wire
/// formats have none.
fn figures(limits: &Table, measured: &Measured) -> BTreeMap<String, u64> {
    let mut figures = BTreeMap::new();
    let mut most = |name: String, figure: u64| {
        let largest = figures.entry(name).or_insert(0);
        *largest = figure.max(*largest);
    };
    for (column, figure) in &measured.programs["lockstep"] {
        most(format!("lockstep_{column}"), *figure);
    }
    for (law, row) in &measured.laws {
        most(format!("text.{law}"), row["text"]);
    }
    let kinds = [number(limits), "-"];
    let cases = measured.cases.iter().filter_map(|(name, row)| Some((name.split_once(' ')?, row)));
    for ((case, _), row) in cases.filter(|((_, kind), _)| kinds.contains(kind)) {
        most(format!("instructions.{case}"), row["worst"]);
        most(format!("stacks.{case}"), row["stack"]);
        most("agent_and_workspace".into(), row["agent"] + row["workspace"]);
        // Some cases have a limit of their own.
        if limits.get("stacks").is_none_or(|own| own.get(case).is_none()) {
            most("stack".into(), row["stack"]);
        }
    }
    // Static RAM and the deepest step.
    if let Some((ram, stack)) = figures.get("lockstep_ram").zip(figures.get("stack")) {
        figures.insert("ram".into(), ram + stack);
    }
    figures
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "[a]\nnumber = 'f32'\nlockstep_text = 100\nram = 60\nstack = 10\n\
        [a.instructions]\nroute = 7\nfly = 9\n[b]\nnumber = 'Q16'\n";

    fn measured(text: u64, ram: u64, stack: u64, worst: u64) -> Measured {
        let case = |case: &str, worst| {
            let row = [("worst", worst), ("stack", stack), ("agent", 0), ("workspace", 0)];
            (case.to_string(), Row::from(row))
        };
        Measured {
            programs: [(String::from("lockstep"), Row::from([("text", text), ("ram", ram)]))].into(),
            cases: [case("route f32", worst), case("fly f32", 1), case("route Q16", 1000)].into(),
            laws: [(String::from("boids"), Row::from([("text", worst)]))].into(),
            ..Measured::default()
        }
    }

    fn told(text: &str, measured: &Measured) -> Vec<String> {
        breaches(&read(text, "a").unwrap(), measured)
    }

    #[test]
    fn values_within_limits_pass_and_each_breach_is_reported() {
        assert_eq!(told(TEXT, &measured(100, 50, 10, 7)), [""; 0]);
        assert_eq!(told(TEXT, &measured(101, 50, 10, 8)).len(), 2);
        assert_eq!(told(TEXT, &measured(100, 50, 11, 7)), ["ram: 61, at most 60", "stack: 11, at most 10"]);
    }

    #[test]
    fn a_program_alone_has_the_limits_of_its_name() {
        let limits = read(TEXT, "a").unwrap();
        let told = |text: u64| breaches_of("lockstep", Row::from([("text", text)]), &limits);
        assert_eq!((told(100), told(101)), (vec![], vec![String::from("lockstep_text: 101, at most 100")]));
    }

    #[test]
    fn a_case_can_have_a_stack_of_its_own() {
        let text = TEXT.replace("[a.instructions]", "[a.stacks]\nroute = 20\n[a.instructions]");
        let mut measured = measured(1, 1, 10, 1);
        measured.cases.get_mut("route f32").unwrap().insert("stack", 20);
        assert_eq!(told(&text, &measured), [""; 0]);
        measured.cases.get_mut("route f32").unwrap().insert("stack", 21);
        assert_eq!(told(&text, &measured), ["stacks.route: 21, at most 20"]);
        measured.cases.get_mut("fly f32").unwrap().insert("stack", 11);
        assert_eq!(told(&text, &measured).len(), 2);
    }

    #[test]
    fn a_limit_without_a_measurement_is_a_breach() {
        let text = TEXT.replace("[a.instructions]", "[a.text]\nboids = 7\nlattice = 9\n[a.instructions]");
        let expected =
            ["instructions.route: 8, at most 7", "text.boids: 8, at most 7", "text.lattice: limited, but not measured"];
        assert_eq!(told(&text, &measured(1, 1, 1, 8)), expected);
        assert_eq!(told(&TEXT.replace("fly", "boids"), &measured(1, 1, 1, 1)).len(), 1);
        assert_eq!(told(&TEXT.replace("stack", "stuck"), &measured(1, 1, 1, 1)).len(), 1);
        assert!(read(TEXT, "c").is_err());
    }
}
