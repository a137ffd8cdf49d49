//! Limits of a part, and which of them are breached.

use super::Measured;
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

/// The figures by the names of their limits, in the kind of number that limits are for; wire
/// formats have none.
fn figures(limits: &Table, measured: &Measured) -> BTreeMap<String, u64> {
    let mut figures = BTreeMap::new();
    let mut most = |name: String, figure: Option<u64>| {
        let largest = figures.entry(name).or_insert(0);
        *largest = figure.unwrap_or(0).max(*largest);
    };
    for column in ["text", "rodata", "ram"] {
        most(format!("lockstep_{column}"), measured.programs.get("lockstep", column));
    }
    for (law, _) in &measured.laws.rows {
        most(format!("text.{law}"), measured.laws.get(law, "text"));
    }
    for (row, _) in &measured.cases.rows {
        let figure = |column| measured.cases.get(row, column);
        let kinds = [number(limits), "-"];
        let Some((case, _)) = row.split_once(' ').filter(|(_, kind)| kinds.contains(kind)) else { continue };
        most(format!("instructions.{case}"), figure("worst"));
        most(format!("stacks.{case}"), figure("stack"));
        most("agent_and_workspace".into(), figure("agent").zip(figure("workspace")).map(|(a, b)| a + b));
        // Some cases have a limit of their own.
        if limits.get("stacks").is_none_or(|own| own.get(case).is_none()) {
            most("stack".into(), figure("stack"));
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
    use super::super::Table as Figures;
    use super::*;

    const TEXT: &str = "[a]\nnumber = 'f32'\nlockstep_text = 100\nram = 60\nstack = 10\n\
        [a.instructions]\nroute = 7\nfly = 9\n[b]\nnumber = 'Q16'\n";

    fn measured(text: u64, ram: u64, stack: u64, worst: u64) -> Measured {
        let row = |name: &str, worst| (name.to_string(), vec![worst, stack]);
        let empty = || Figures { columns: &["name", "text"], rows: Vec::new() };
        Measured {
            programs: Figures { columns: &["name", "text", "ram"], rows: vec![("lockstep".into(), vec![text, ram])] },
            cases: Figures {
                columns: &["name", "worst", "stack"],
                rows: vec![row("route f32", worst), row("fly f32", 1), row("route Q16", 1000)],
            },
            laws: Figures { rows: vec![("boids".into(), vec![worst])], ..empty() },
            steps: empty(),
            formats: empty(),
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
    fn a_case_can_have_a_stack_of_its_own() {
        let text = TEXT.replace("[a.instructions]", "[a.stacks]\nroute = 20\n[a.instructions]");
        let mut measured = measured(1, 1, 10, 1);
        measured.cases.rows[0].1[1] = 20;
        assert_eq!(told(&text, &measured), [""; 0]);
        measured.cases.rows[0].1[1] = 21;
        assert_eq!(told(&text, &measured), ["stacks.route: 21, at most 20"]);
        measured.cases.rows[1].1[1] = 11;
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
