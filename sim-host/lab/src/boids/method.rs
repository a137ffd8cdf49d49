//! Neighbour searches of the boids experiment.

use super::searches::{MidpointTree, MutualPairs, Tree};
use staya_sim::nearby::{AllPairs, Cells, Space};

/// A neighbour search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Compares each boid with all others.
    AllPairs,
    /// Compares each pair once.
    MutualPairs,
    /// Lattice cells.
    Cells,
    /// The k-d tree of the crate `kiddo`.
    Tree,
    /// A k-d tree by the sliding midpoint rule, as in the paper.
    MidpointTree,
}

impl Method {
    /// All searches.
    pub const ALL: [Self; 5] = [Self::AllPairs, Self::MutualPairs, Self::Cells, Self::Tree, Self::MidpointTree];

    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::AllPairs => "all pairs",
            Self::MutualPairs => "pairs once",
            Self::Cells => "lattice cells",
            Self::Tree => "k-d tree",
            Self::MidpointTree => "midpoint tree",
        }
    }

    pub(super) fn search(self, space: Space<f32, 2>, radius: f32) -> AnySearch {
        match self {
            Self::AllPairs => AnySearch::AllPairs(AllPairs::new(space)),
            Self::MutualPairs => AnySearch::MutualPairs(MutualPairs::new(space, radius)),
            // For up to 150 neighbours, cells as large as the radius are fastest.
            Self::Cells => AnySearch::Cells(Cells::new(space, radius)),
            Self::Tree => AnySearch::Tree(Tree::new(space)),
            Self::MidpointTree => AnySearch::MidpointTree(MidpointTree::new(space)),
        }
    }
}

#[derive(Clone, Debug)]
pub(super) enum AnySearch {
    AllPairs(AllPairs<f32, 2>),
    MutualPairs(MutualPairs<f32, 2>),
    Cells(Cells<f32, 2>),
    Tree(Tree<f32, 2>),
    MidpointTree(MidpointTree<f32, 2>),
}
