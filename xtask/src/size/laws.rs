//! The minimal firmware of each law: an agent with one law and one safety layer, measured in
//! `bench` under its heaviest load.

use super::bench::Row;
use super::reach::Step;
use serde::Serialize;

/// Each law with its case in `bench`, its guidance and its safety layer in numbers `#` with at most
/// `K` half-planes.
const LAWS: [(&str, &str, &str, &str); 10] = [
    ("route", "worst_route", "RouteGuidance", "Unguarded"),
    ("formation", "worst_formation_reflexive", "FormationGuidance", "Unguarded"),
    ("waypoint_orca", "worst_orca_found", "WaypointGuidance", "OrcaSafety<#, K>"),
    ("waypoint_orca_template", "worst_orca_template_2k", "WaypointGuidance", "OrcaSafety<#, K, VoxelTable2k>"),
    ("waypoint_orca_in_space", "worst_fly", "WaypointGuidance", "OrcaSafety<#, K, InSpace<#>>"),
    ("waypoint_push_out", "worst_push_out", "WaypointGuidance", "PushOutSafety"),
    ("lattice", "worst_lattice", "LatticeGuidance", "Unguarded"),
    ("goal_flock", "worst_goal_flock", "GoalFlockGuidance", "Unguarded"),
    ("boids", "worst_boids", "BoidsGuidance", "Unguarded"),
    ("negotiation", "worst_negotiation", "NegotiationGuidance", "Unguarded"),
];

/// The measurements of one law.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Law {
    /// Guidance and safety layer.
    pub law: &'static str,
    /// Machine code of a step, bytes.
    pub text: u64,
    /// Its constants.
    pub rodata: u64,
    /// The agent and its workspace.
    pub ram: u64,
    /// The deepest step.
    pub stack: u64,
}

/// The laws in one kind of number, as far as they were measured.
pub fn laws(number: &str, rows: &[Row], steps: &[Step]) -> Vec<Law> {
    let law = |(law, case, guidance, safety): &(&'static str, &str, &str, &str)| {
        let row = rows.iter().find(|row| row.case == *case && row.number == number)?;
        let step = steps.iter().find(|step| {
            // Twice as many half-planes as neighbours.
            let neighbors = step.behaviour.rsplit(", ").next().and_then(|it| it.parse::<u32>().ok());
            let safety = safety.replace('#', number).replace('K', &(2 * neighbors.unwrap_or(0)).to_string());
            let mut arguments = arguments(&step.behaviour).into_iter();
            arguments.next() == Some(number)
                && arguments.next().is_some_and(|it| it == *guidance || it.starts_with(&format!("{guidance}<")))
                && arguments.next().is_some_and(|it| it == safety || it.starts_with(&format!("{safety}<")))
                && arguments.next() == Some("Postcard")
        })?;
        let (text, rodata) = (step.reach.text, step.reach.rodata);
        Some(Law { law, text, rodata, ram: row.agent + row.workspace, stack: row.stack })
    };
    LAWS.iter().filter_map(law).collect()
}

/// The arguments of a generic type, split at the commas between them.
fn arguments(text: &str) -> Vec<&str> {
    let mut depth = 0_i32;
    let is_between = |c: char| {
        depth += i32::from(c == '<') - i32::from(c == '>');
        c == ',' && depth == 0
    };
    text.split(is_between).map(str::trim).collect()
}

#[cfg(test)]
mod tests {
    use super::super::reach::Reach;
    use super::*;

    #[test]
    fn step_of_a_law_is_found_by_its_types() {
        let row = |case: &str| Row {
            case: case.to_string(),
            number: String::from("f32"),
            steps: 1,
            median: 1,
            worst: 1,
            stack: 30,
            agent: 20,
            workspace: 1,
        };
        let step = |behaviour: &str, text| Step { behaviour: behaviour.to_string(), reach: Reach { text, rodata: 2 } };
        let rows = [row("worst_orca_found"), row("worst_push_out")];
        let steps = [
            step("Q16, WaypointGuidance<Q16>, OrcaSafety<Q16, 32>, Postcard, 16", 1),
            step("f32, WaypointGuidance<f32>, OrcaSafety<f32, 32, VoxelTable2k>, Postcard, 16", 2),
            step("f32, WaypointGuidance<f32>, OrcaSafety<f32, 32>, Postcard, 16", 3),
            step("f32, WaypointGuidance<f32>, PushOutSafety<f32>, Mavlink, 16", 4),
        ];
        let law = Law { law: "waypoint_orca", text: 3, rodata: 2, ram: 21, stack: 30 };
        assert_eq!(laws("f32", &rows, &steps), [law]);
    }
}
