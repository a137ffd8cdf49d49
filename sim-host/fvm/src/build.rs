//! Builds a model of a function: the tangent plane of its graph in each node of a grid.

use crate::Function;
use anyhow::{Result, bail};
use staya_voxel::{Header, checksum};

/// The grid on which a function is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid<const V: usize> {
    /// Smallest and largest coordinate along each axis.
    pub extent: [[f64; 2]; V],
    /// Nodes along each axis, 2 to 65,535; the first and last are at the ends of the extent.
    pub nodes: [u16; V],
}

/// Largest size of a model, bytes.
pub(crate) const MOST_BYTES: usize = 64 << 20;

/// Builds the model of a function on a grid, as bytes for `staya_voxel::Model`. Each node's plane
/// has the function's value there; its slopes are central differences over half a step to both
/// sides. `depth`: bits per component, 4 to 16.
///
/// # Errors
/// The variables are not two or three, the depth or an axis is invalid, the model exceeds 64 MiB,
/// or the function is not finite or too steep at a node.
pub fn build<const V: usize>(function: &Function<V>, grid: &Grid<V>, depth: u8) -> Result<Vec<u8>> {
    let header = header(grid, depth)?;
    let step = |axis: usize| f64::from(header.step[axis]);
    let half: [f64; V] = std::array::from_fn(|axis| 0.5 * step(axis));
    let scales: [f64; V] = std::array::from_fn(|axis| half[axis] * f64::from(grid.nodes[axis] - 1));
    let mut planes = Vec::with_capacity(header.count());
    let mut most = 0.0_f64;
    for node in 0..header.count() {
        let mut rest = node;
        let at: [f64; V] = std::array::from_fn(|axis| {
            let along = usize::from(grid.nodes[axis]);
            let index = rest % along;
            rest /= along;
            f64::from(header.first[axis]) + step(axis) * index as f64
        });
        let (value, gradient) = (function.value(at), function.gradient(at, half));
        if !((value as f32).is_finite() && gradient.iter().all(|slope| slope.is_finite())) {
            bail!(
                "the function is not finite in 32 bits at {at:?}; exclude that point from the extent, or define the \
                 function there"
            );
        }
        most = most.max(value.abs());
        planes.push((at, value, gradient));
    }
    let unit = if most > 1e-30 { most as f32 } else { 1.0 };
    let header = Header { unit, ..header };
    let mut bytes = header.to_bytes().to_vec();
    let whole = f64::from((1_u32 << (depth - 1)) - 1);
    for (at, value, gradient) in planes {
        let slopes = std::array::from_fn::<f64, V, _>(|axis| gradient[axis] * scales[axis] / f64::from(unit));
        let free = -value / f64::from(unit);
        let length = libm::sqrt(slopes.iter().map(|slope| slope * slope).sum::<f64>() + 1.0 + free * free);
        let level = |component: f64| libm::round(component / length * whole) as i16;
        let down = level(-1.0);
        if down == 0 {
            bail!("the function is too steep at {at:?} for {depth} bits; give a greater depth");
        }
        for component in slopes.map(level).into_iter().chain([down, level(free)]) {
            let pair = component.to_le_bytes();
            bytes.extend_from_slice(&pair[..header.component_len()]);
        }
    }
    let sum = checksum(&bytes).to_le_bytes();
    bytes[44..48].copy_from_slice(&sum);
    Ok(bytes)
}

fn header<const V: usize>(grid: &Grid<V>, depth: u8) -> Result<Header> {
    if V != 2 && V != 3 {
        bail!("{V} variables: give a function of two or three");
    }
    if !(4..=16).contains(&depth) {
        bail!("depth {depth}: give 4 to 16 bits");
    }
    let mut header = Header { variables: V as u8, depth, nodes: [1; 3], first: [0.0; 3], step: [0.0; 3], unit: 1.0 };
    for (axis, (&nodes, &[low, high])) in grid.nodes.iter().zip(&grid.extent).enumerate() {
        let (first, step) = (low as f32, ((high - low) / (f64::from(nodes) - 1.0)) as f32);
        let last = first + step * (f32::from(nodes) - 1.0);
        let is_sound = nodes >= 2 && step.is_normal() && first < last && last.is_finite();
        if !is_sound {
            bail!("axis {}: give at least two nodes, and an extent from a smaller to a larger number", axis + 1);
        }
        (header.nodes[axis], header.first[axis], header.step[axis]) = (nodes, first, step);
    }
    if header.model_len() > MOST_BYTES {
        bail!("a model of {} bytes exceeds 64 MiB; give fewer nodes", header.model_len());
    }
    Ok(header)
}
