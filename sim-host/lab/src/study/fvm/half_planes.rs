//! Half-planes of random pairs of robots from tables and models, beside the formula.

use super::example::neighbor_model;
use super::{Parameters, Source, Values};
use staya_controller::orca::{Analytic, VoxelTable2k};
use staya_fvm::{HalfPlaneErrors, half_planes};
use staya_voxel::{Model, VoxelNeighbor};

pub const MEASURES: &[(&str, &str)] = &[
    ("angle_deg", "mean angle between normals of half-planes and those of the formula, degrees"),
    ("worst_angle_deg", "largest such angle"),
    ("change", "mean difference of the corrections, in (R_A + R_B) / tau"),
    ("worst_change", "largest such difference"),
    ("bytes", "size of the table or model; 0 of the formula"),
];

pub fn measure(parameters: &Parameters, seed: u64) -> Result<Values, String> {
    let pairs = parameters.pairs;
    let (errors, bytes) = match parameters.source {
        Source::Formula => (half_planes(&Analytic, pairs, seed), 0),
        Source::Table => (half_planes(&VoxelTable2k, pairs, seed), VoxelTable2k::TABLE.bytes()),
        Source::Neighbor | Source::Distance | Source::RFunction => {
            let bytes = neighbor_model(parameters)?;
            let model = Model::<f32, 3>::from_bytes(&bytes).map_err(|error| error.to_string())?;
            (half_planes(&VoxelNeighbor::new(model), pairs, seed), bytes.len())
        }
    };
    let HalfPlaneErrors { angle_deg, change } = errors.ok_or("a pair has no half-plane")?;
    Ok(vec![
        ("angle_deg", Some(angle_deg.mean)),
        ("worst_angle_deg", Some(angle_deg.max)),
        ("change", Some(change.mean)),
        ("worst_change", Some(change.max)),
        ("bytes", Some(bytes as f64)),
    ])
}
