//! Fields of a formation, shared by `[robots]` and `[plane]`.

use super::{Line, Node, Read, Wrong};
use crate::{one_of, table};
use toml::de::DeValue;

one_of! {
    /// Starts of a formation.
    pub enum FormationStarts {
        /// Cell where robot 1, the top leader, starts; the others start at their places around it.
        First([i16; 2]) = "start";
        /// Instead of `start`: the start cell of each robot, by number. The formation forms on the
        /// way.
        All(Vec<[i16; 2]>) = "starts";
    }
}

table! {
    /// `robots.formation`: robots 1, 2, 3, ... in rows, or at given places.
    pub struct FormationEntry {
        part starts: FormationStarts;
        /// Rows of a grid, numbered row by row; neighbours in a row or a column share an edge.
        pub rows: Option<u16>;
        /// Robots in a row.
        pub columns: Option<u16>;
        /// Cells between columns (x) and rows (y). Default: `[3, -3]`, with the first row on top.
        pub spacing: Option<[i16; 2]>;
        /// Instead of rows and columns: the place of each robot, in cells relative to the first.
        pub places: Option<Vec<[i16; 2]>>;
        /// With `places`: pairs of robot numbers that are neighbours in the formation's graph.
        pub edges: Option<Vec<[u32; 2]>>;
        /// Largest number of graph edges between robots that count as neighbours, 1 or more; no
        /// robot may have more than 8 neighbours. Default: the largest of 3, 2, 1 that fits.
        pub rho: Option<u8>;
        /// Goal cell of robot 1; the others go to their places around it.
        pub goal: [i16; 2];
    }
}

/// `[robots.formation]` or `[[robots.formation]]`.
#[derive(Clone, Debug, Default)]
pub struct FormationEntries(pub Vec<FormationEntry>);

impl Read for FormationEntries {
    const KIND: &'static str = "a table or a list of tables";

    fn read(node: &Node<'_>) -> Result<Self, Wrong> {
        match node.get_ref() {
            DeValue::Array(_) => Vec::read(node).map(Self),
            _ => FormationEntry::read(node).map(|entry| Self(vec![entry])),
        }
    }

    fn lines() -> Vec<Line> {
        FormationEntry::lines()
    }
}
