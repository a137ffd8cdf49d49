//! Fields of a formation, shared by `[robots]` and `[plane]`.

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

/// `robots.formation`: robots 1, 2, 3, ... in rows, or at given places.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FormationEntry {
    /// Rows of a grid, numbered row by row; neighbours in a row or a column share an edge.
    pub rows: Option<u16>,
    /// Robots in a row.
    pub columns: Option<u16>,
    /// Cells between columns (x) and rows (y). Default: `[3, -3]`, with the first row on top.
    pub spacing: Option<[i16; 2]>,
    /// Instead of rows and columns: the place of each robot, in cells relative to the first.
    pub places: Option<Vec<[i16; 2]>>,
    /// With `places`: pairs of robot numbers that are neighbours in the formation's graph.
    pub edges: Option<Vec<[u32; 2]>>,
    /// Cell where robot 1, the top leader, starts; the others start at their places around it.
    pub start: Option<[i16; 2]>,
    /// Instead of `start`: the start cell of each robot, by number. The formation forms on the way.
    pub starts: Option<Vec<[i16; 2]>>,
    /// Goal cell of robot 1; the others go to their places around it.
    pub goal: [i16; 2],
}

/// Reads a table or an array of tables; unlike an untagged enum, errors name the form used.
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
