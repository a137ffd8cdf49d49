//! Neighbour searches that STA describes, and a k-d tree by a library, measured beside the lattice cells of
//! [`staya_sim::nearby`]. All answer alike, bit for bit.

mod midpoint;
mod mutual;
#[cfg(test)]
mod tests;
mod tree;

pub use midpoint::MidpointTree;
pub use mutual::MutualPairs;
pub use tree::Tree;
