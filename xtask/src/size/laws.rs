//! The minimal firmware of each law: an agent with one law and one safety layer, measured in
//! `bench` under its heaviest load.

use super::{Row, Table};

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

/// The laws in one kind of number, as far as they were measured, and `lockstep`.
pub fn laws(number: &str, programs: &Table, cases: &Table, steps: &Table) -> Table {
    let row =
        |text, rodata, ram, stack| Row::from([("text", text), ("rodata", rodata), ("ram", ram), ("stack", stack)]);
    let law = |(law, case, guidance, safety): &(&str, &str, &str, &str)| {
        let (_, step) = steps.iter().find(|(step, _)| {
            // Twice as many half-planes as neighbours.
            let neighbors = step.rsplit(", ").next().and_then(|it| it.parse::<u32>().ok());
            let safety = safety.replace('#', number).replace('K', &(2 * neighbors.unwrap_or(0)).to_string());
            let is_type = |name: &str, wanted: &str| name == wanted || name.starts_with(&format!("{wanted}<"));
            matches!(arguments(step)[..], [kind, one, other, "Postcard", ..]
                if kind == number && is_type(one, guidance) && is_type(other, &safety))
        })?;
        let case = cases.get(&format!("{case} {number}"))?;
        Some((law.to_string(), row(step["text"], step["rodata"], case["agent"] + case["workspace"], case["stack"])))
    };
    let of_number = cases.iter().filter(|(case, _)| case.ends_with(&format!(" {number}")));
    let stack = of_number.map(|(_, case)| case["stack"]).max().unwrap_or(0);
    let lockstep = programs.get("lockstep").map(|all| row(all["text"], all["rodata"], all["ram"], stack));
    let lockstep = lockstep.map(|row| ("lockstep, all laws".to_string(), row));
    LAWS.iter().filter_map(law).chain(lockstep).collect()
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
    use super::*;

    #[test]
    fn step_of_a_law_is_found_by_its_types() {
        let table = |columns: &[&'static str], rows: &[(&str, &[u64])]| -> Table {
            let row = |figures: &[u64]| columns.iter().copied().zip(figures.iter().copied()).collect();
            rows.iter().map(|(name, figures)| (name.to_string(), row(figures))).collect()
        };
        let cases = [("worst_orca_found f32", &[30, 20, 1][..]), ("worst_push_out f32", &[40, 20, 1])];
        let cases = table(&["stack", "agent", "workspace"], &cases);
        let steps = [
            ("Q16, WaypointGuidance<Q16>, OrcaSafety<Q16, 32>, Postcard, 16", &[1, 2][..]),
            ("f32, WaypointGuidance<f32>, OrcaSafety<f32, 32, VoxelTable2k>, Postcard, 16", &[2, 2]),
            ("f32, WaypointGuidance<f32>, OrcaSafety<f32, 32>, Postcard, 16", &[3, 2]),
            ("f32, WaypointGuidance<f32>, PushOutSafety<f32>, Mavlink, 16", &[4, 2]),
        ];
        let steps = table(&["text", "rodata"], &steps);
        let programs = table(&["text", "rodata", "ram"], &[("lockstep", &[7, 8, 9])]);
        let expected = [("waypoint_orca", &[3, 2, 21, 30][..]), ("lockstep, all laws", &[7, 8, 9, 40])];
        assert_eq!(laws("f32", &programs, &cases, &steps), table(&["text", "rodata", "ram", "stack"], &expected));
    }
}
