//! What a file says of a formation, wherever it says it.

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

/// `robots.formation`: robots 1, 2, 3, ... in rows, or at given places.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FormationEntry {
    /// Rows of a grid formation: robots are numbered row by row, neighbours in a row or column are
    /// joined by an edge.
    pub rows: Option<u16>,
    /// Robots in a row.
    pub columns: Option<u16>,
    /// Cells from one column to the next (x) and from one row to the next (y), either may be
    /// negative. Default: `[3, -3]`, which looks as on paper.
    pub spacing: Option<[i16; 2]>,
    /// Instead of rows and columns: where each robot should be, in cells relative to the first.
    pub places: Option<Vec<[i16; 2]>>,
    /// With `places`: pairs of robot numbers that are neighbours in the formation's graph.
    pub edges: Option<Vec<[u32; 2]>>,
    /// The cell where robot 1, the top leader, starts, and the others in their places around it.
    pub start: Option<[i16; 2]>,
    /// Instead of `start`: the cell where each robot starts, by its number; they form on the way.
    pub starts: Option<Vec<[i16; 2]>>,
    /// The cell where robot 1 should go; the others go to their places around it.
    pub goal: [i16; 2],
}

/// A table, or an array of such tables: mistakes are named as if only that were allowed which stands there.
pub(super) fn one_or_more<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<FormationEntry>, D::Error> {
    struct OneOrMore;
    impl<'de> Visitor<'de> for OneOrMore {
        type Value = Vec<FormationEntry>;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str("a formation or a list of formations")
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
            FormationEntry::deserialize(MapAccessDeserializer::new(map)).map(|entry| vec![entry])
        }

        fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Self::Value, A::Error> {
            Vec::deserialize(SeqAccessDeserializer::new(seq))
        }
    }
    from.deserialize_any(OneOrMore)
}
