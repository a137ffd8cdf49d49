//! Limits of a part, and which of them are breached.

use super::Measured;
use super::bench::{NO_NUMBER, Row};
use serde::Deserialize;
use std::collections::BTreeMap;

/// The limits of one part; what is not there is not limited.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// The kind of number that the limits are for.
    number: String,
    lockstep_text: Option<u64>,
    lockstep_rodata: Option<u64>,
    lockstep_ram: Option<u64>,
    /// Static RAM of `lockstep` and the deepest step.
    ram: Option<u64>,
    agent_and_workspace: Option<u64>,
    stack: Option<u64>,
    /// Cases with another limit of the stack.
    #[serde(default)]
    stacks: BTreeMap<String, u64>,
    /// Machine code of the minimal agent, by law.
    #[serde(default)]
    text: BTreeMap<String, u64>,
    /// Of the longest step, by case.
    #[serde(default)]
    instructions: BTreeMap<String, u64>,
}

impl Budget {
    /// The limits of the part `name`.
    pub fn read(text: &str, name: &str) -> Result<Self, String> {
        let mut parts: BTreeMap<String, Self> = toml::from_str(text).map_err(|error| error.to_string())?;
        parts.remove(name).ok_or_else(|| format!("no limits for {name}"))
    }

    /// The kind of number that the limits are for.
    pub fn number(&self) -> &str {
        &self.number
    }

    /// A line for each limit that is breached, or that nothing was measured for.
    pub fn breaches(&self, measured: &Measured) -> Vec<String> {
        let is_limited = |row: &&Row| row.number == self.number || row.number == NO_NUMBER;
        let rows = || measured.rows.iter().filter(is_limited);
        let most = |value: fn(&Row) -> u64| rows().map(value).max();
        let lockstep =
            measured.programs.iter().find(|(program, _)| program == "lockstep").map(|(_, sections)| sections);
        let stack = rows().filter(|row| !self.stacks.contains_key(&row.case)).map(|row| row.stack).max();
        let ram = lockstep.zip(stack).map(|(it, stack)| it.ram + stack);
        let mut checks = vec![
            ("text of lockstep", self.lockstep_text, lockstep.map(|it| it.text)),
            ("rodata of lockstep", self.lockstep_rodata, lockstep.map(|it| it.rodata)),
            ("RAM of lockstep", self.lockstep_ram, lockstep.map(|it| it.ram)),
            ("RAM of lockstep with the deepest step", self.ram, ram),
            ("agent and workspace", self.agent_and_workspace, most(|row| row.agent + row.workspace)),
            ("stack of a step", self.stack, stack),
        ];
        for (case, limit) in &self.instructions {
            let row = rows().find(|row| row.case == *case);
            checks.push((case, Some(*limit), row.map(|row| row.worst)));
        }
        let stacks: Vec<String> = self.stacks.keys().map(|case| format!("stack of {case}")).collect();
        for (name, (case, limit)) in stacks.iter().zip(&self.stacks) {
            let row = rows().find(|row| row.case == *case);
            checks.push((name, Some(*limit), row.map(|row| row.stack)));
        }
        let names: Vec<String> = self.text.keys().map(|law| format!("text of {law}")).collect();
        for ((name, limit), law) in names.iter().zip(self.text.values()).zip(self.text.keys()) {
            let law = measured.laws.iter().find(|it| it.law == law);
            checks.push((name, Some(*limit), law.map(|law| law.text)));
        }
        checks
            .into_iter()
            .filter_map(|(what, limit, value)| match (limit?, value) {
                (limit, Some(value)) if value <= limit => None,
                (limit, Some(value)) => Some(format!("{what}: {value}, at most {limit}")),
                (_, None) => Some(format!("{what}: limited, but not measured")),
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::laws::Law;
    use super::*;
    use crate::firmware::Sections;

    const TEXT: &str = "[a]\nnumber = 'f32'\nlockstep_text = 100\nram = 60\nstack = 10\n\
        [a.instructions]\nroute = 7\nfly = 9\n[b]\nnumber = 'Q16'\n";

    fn measured(text: u64, ram: u64, stack: u64, worst: u64) -> Measured {
        let row = |case: &str, number: &str, worst| Row {
            case: case.to_string(),
            number: number.to_string(),
            steps: 1,
            median: 1,
            worst,
            stack,
            agent: 1,
            workspace: 1,
        };
        let sections = Sections { text, rodata: 0, flash: 0, ram };
        Measured {
            part: "a",
            programs: vec![(String::from("lockstep"), sections)],
            rows: vec![row("route", "f32", worst), row("fly", "f32", 1), row("route", "Q16", 1000)],
            laws: vec![Law { law: "boids", text: worst, rodata: 0, ram: 0, stack: 0 }],
            steps: Vec::new(),
            formats: Vec::new(),
        }
    }

    #[test]
    fn values_within_limits_pass_and_each_breach_is_reported() {
        let budget = Budget::read(TEXT, "a").unwrap();
        assert!(budget.breaches(&measured(100, 50, 10, 7)).is_empty());
        assert_eq!(budget.breaches(&measured(101, 50, 10, 8)).len(), 2);
        let told = budget.breaches(&measured(100, 50, 11, 7));
        assert_eq!(told[0], "RAM of lockstep with the deepest step: 61, at most 60");
        assert_eq!(told[1], "stack of a step: 11, at most 10");
    }

    #[test]
    fn a_case_can_have_a_stack_of_its_own() {
        let text = TEXT.replace("[a.instructions]", "[a.stacks]\nroute = 20\n[a.instructions]");
        let mut measured = measured(1, 1, 10, 1);
        measured.rows[0].stack = 20;
        assert!(Budget::read(&text, "a").unwrap().breaches(&measured).is_empty());
        measured.rows[0].stack = 21;
        let told = Budget::read(&text, "a").unwrap().breaches(&measured);
        assert_eq!(told, ["stack of route: 21, at most 20"]);
        measured.rows[1].stack = 11;
        assert_eq!(Budget::read(&text, "a").unwrap().breaches(&measured).len(), 2);
    }

    #[test]
    fn a_limit_without_a_measurement_is_a_breach() {
        let text = TEXT.replace("[a.instructions]", "[a.text]\nboids = 7\nlattice = 9\n[a.instructions]");
        let told = Budget::read(&text, "a").unwrap().breaches(&measured(1, 1, 1, 8));
        assert_eq!(told[..2], ["route: 8, at most 7", "text of boids: 8, at most 7"]);
        assert_eq!(told[2..], ["text of lattice: limited, but not measured"]);
        let text = TEXT.replace("fly", "boids");
        let budget = Budget::read(&text, "a").unwrap();
        assert_eq!(budget.breaches(&measured(1, 1, 1, 1)).len(), 1);
        assert!(Budget::read(TEXT, "c").is_err());
        assert!(Budget::read(&TEXT.replace("stack", "stuck"), "a").is_err());
    }
}
