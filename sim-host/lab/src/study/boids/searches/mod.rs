//! Neighbour searches to compare with [`staya_sim::nearby`], with bitwise equal results.

mod midpoint;
mod mutual;
mod quadtree;
#[cfg(test)]
mod tests;
mod tree;

pub use midpoint::MidpointTree;
pub use mutual::MutualPairs;
pub use quadtree::Quadtree;
pub use tree::Tree;
