//! Ways to find neighbours.

use super::searches::{MidpointTree, MutualPairs, Tree};
use staya_sim::nearby::{AllPairs, Cells, Space};

/// Which search finds the neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Looks at everybody.
    AllPairs,
    /// Looks at each pair once.
    MutualPairs,
    /// Lattice cells.
    Cells,
    /// A k-d tree, the library's.
    Tree,
    /// A k-d tree by the sliding midpoint rule, which the paper describes.
    MidpointTree,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::AllPairs, Self::MutualPairs, Self::Cells, Self::Tree, Self::MidpointTree];

    /// What it is called.
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

    /// A search in this space for queries of this radius.
    pub(super) fn search(self, space: Space<f32, 2>, radius: f32) -> AnySearch {
        match self {
            Self::AllPairs => AnySearch::AllPairs(AllPairs::new(space)),
            Self::MutualPairs => AnySearch::MutualPairs(MutualPairs::new(space, radius)),
            // Neighbours of up to 150 among about 3: cells of the radius itself.
            Self::Cells => AnySearch::Cells(Cells::new(space, radius)),
            Self::Tree => AnySearch::Tree(Tree::new(space)),
            Self::MidpointTree => AnySearch::MidpointTree(MidpointTree::new(space)),
        }
    }
}

/// One of them.
#[derive(Clone, Debug)]
pub(super) enum AnySearch {
    AllPairs(AllPairs<f32, 2>),
    MutualPairs(MutualPairs<f32, 2>),
    Cells(Cells<f32, 2>),
    Tree(Tree<f32, 2>),
    MidpointTree(MidpointTree<f32, 2>),
}
