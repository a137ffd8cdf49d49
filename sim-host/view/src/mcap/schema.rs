//! The parts of Foxglove's schemas that runs need, with names, numbers and types as in its .proto
//! files (<https://docs.foxglove.dev/docs/visualization/message-schemas/introduction>).

use super::proto::{Field, File, Kind, Type, descriptor_set, many, one};
use Kind::{Bool, Bytes, Double, Enum, Fixed32, Int32, Int64, Message, Text};

const TIME: Kind = Message("google.protobuf.Timestamp");
const POSE: Kind = Message("foxglove.Pose");
const COLOR: Kind = Message("foxglove.Color");
const POINT: Kind = Message("foxglove.Point3");
const VECTOR: Kind = Message("foxglove.Vector3");

const fn plain(name: &'static str, fields: &'static [Field]) -> Type {
    Type { name, fields, enums: &[] }
}

static TIMESTAMP: File = File {
    name: "google/protobuf/timestamp.proto",
    package: "google.protobuf",
    imports: &[],
    types: &[plain("Timestamp", &[one("seconds", 1, Int64), one("nanos", 2, Int32)])],
};

static DURATION: File = File {
    name: "google/protobuf/duration.proto",
    package: "google.protobuf",
    imports: &[],
    types: &[plain("Duration", &[one("seconds", 1, Int64), one("nanos", 2, Int32)])],
};

static FOXGLOVE: File = File {
    name: "staya/foxglove.proto",
    package: "foxglove",
    imports: &["google/protobuf/timestamp.proto", "google/protobuf/duration.proto"],
    types: &[
        plain("Vector2", &[one("x", 1, Double), one("y", 2, Double)]),
        plain("Vector3", &[one("x", 1, Double), one("y", 2, Double), one("z", 3, Double)]),
        plain("Point3", &[one("x", 1, Double), one("y", 2, Double), one("z", 3, Double)]),
        plain("Quaternion", &[one("x", 1, Double), one("y", 2, Double), one("z", 3, Double), one("w", 4, Double)]),
        plain("Pose", &[one("position", 1, VECTOR), one("orientation", 2, Message("foxglove.Quaternion"))]),
        plain("Color", &[one("r", 1, Double), one("g", 2, Double), one("b", 3, Double), one("a", 4, Double)]),
        plain("PosesInFrame", &[one("timestamp", 1, TIME), one("frame_id", 2, Text), many("poses", 3, POSE)]),
        plain(
            "FrameTransform",
            &[
                one("timestamp", 1, TIME),
                one("parent_frame_id", 2, Text),
                one("child_frame_id", 3, Text),
                one("translation", 4, VECTOR),
                one("rotation", 5, Message("foxglove.Quaternion")),
            ],
        ),
        plain("FrameTransforms", &[many("transforms", 1, Message("foxglove.FrameTransform"))]),
        plain("KeyValuePair", &[one("key", 1, Text), one("value", 2, Text)]),
        plain("SpherePrimitive", &[one("pose", 1, POSE), one("size", 2, VECTOR), one("color", 3, COLOR)]),
        plain(
            "CylinderPrimitive",
            &[
                one("pose", 1, POSE),
                one("size", 2, VECTOR),
                one("bottom_scale", 3, Double),
                one("top_scale", 4, Double),
                one("color", 5, COLOR),
            ],
        ),
        Type {
            name: "LinePrimitive",
            fields: &[
                one("type", 1, Enum("foxglove.LinePrimitive.Type")),
                one("pose", 2, POSE),
                one("thickness", 3, Double),
                one("scale_invariant", 4, Bool),
                many("points", 5, POINT),
                one("color", 6, COLOR),
                many("colors", 7, COLOR),
                many("indices", 8, Fixed32),
            ],
            enums: &[("Type", &["LINE_STRIP", "LINE_LOOP", "LINE_LIST"])],
        },
        Type {
            name: "SceneEntityDeletion",
            fields: &[
                one("timestamp", 1, TIME),
                one("type", 2, Enum("foxglove.SceneEntityDeletion.Type")),
                one("id", 3, Text),
            ],
            enums: &[("Type", &["MATCHING_ID", "ALL"])],
        },
        // Without arrows (7), cubes (8), triangles (12), texts (13) and models (14).
        plain(
            "SceneEntity",
            &[
                one("timestamp", 1, TIME),
                one("frame_id", 2, Text),
                one("id", 3, Text),
                one("lifetime", 4, Message("google.protobuf.Duration")),
                one("frame_locked", 5, Bool),
                many("metadata", 6, Message("foxglove.KeyValuePair")),
                many("spheres", 9, Message("foxglove.SpherePrimitive")),
                many("cylinders", 10, Message("foxglove.CylinderPrimitive")),
                many("lines", 11, Message("foxglove.LinePrimitive")),
            ],
        ),
        plain(
            "SceneUpdate",
            &[
                many("deletions", 1, Message("foxglove.SceneEntityDeletion")),
                many("entities", 2, Message("foxglove.SceneEntity")),
            ],
        ),
        Type {
            name: "PackedElementField",
            fields: &[
                one("name", 1, Text),
                one("offset", 2, Fixed32),
                one("type", 3, Enum("foxglove.PackedElementField.NumericType")),
            ],
            enums: &[(
                "NumericType",
                &["UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64"],
            )],
        },
        plain(
            "Grid",
            &[
                one("timestamp", 1, TIME),
                one("frame_id", 2, Text),
                one("pose", 3, POSE),
                one("column_count", 4, Fixed32),
                one("cell_size", 5, Message("foxglove.Vector2")),
                one("row_stride", 6, Fixed32),
                one("cell_stride", 7, Fixed32),
                many("fields", 8, Message("foxglove.PackedElementField")),
                one("data", 9, Bytes),
            ],
        ),
        Type {
            name: "Log",
            fields: &[
                one("timestamp", 1, TIME),
                one("level", 2, Enum("foxglove.Log.Level")),
                one("message", 3, Text),
                one("name", 4, Text),
                one("file", 5, Text),
                one("line", 6, Fixed32),
            ],
            enums: &[("Level", &["UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"])],
        },
    ],
};

pub fn descriptors() -> Vec<u8> {
    descriptor_set(&[&TIMESTAMP, &DURATION, &FOXGLOVE])
}

pub const FIGURES: &str = r#"{
  "$schema": "https://json-schema.org/draft/2020-12/schema",
  "title": "staya.Figures",
  "description": "The swarm as a whole after a tick",
  "type": "object",
  "required": ["tick", "arrived", "waiting", "collisions", "packets", "formation_error", "order", "gap_m", "hash"],
  "properties": {
    "tick": { "type": "integer", "minimum": 0 },
    "arrived": { "type": "integer", "description": "robots that are at their goals" },
    "waiting": { "type": "integer", "description": "robots that have a goal but do not move" },
    "collisions": { "type": "integer", "description": "collisions so far" },
    "packets": {
      "type": "object",
      "description": "radio frames of this tick, by result",
      "properties": {
        "implausible": { "type": "object", "additionalProperties": { "type": "integer", "minimum": 0 } }
      },
      "additionalProperties": { "type": "integer", "minimum": 0 }
    },
    "formation_error": { "type": ["number", "null"], "description": "mean distance from the formation's places, cells" },
    "order": { "type": ["number", "null"], "description": "length of the mean direction, 0 to 1" },
    "gap_m": { "type": ["number", "null"], "description": "least distance between two bodies, metres" },
    "hash": { "type": "string", "pattern": "^[0-9a-f]{16}$", "description": "trace hash so far" }
  }
}
"#;
