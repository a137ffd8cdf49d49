//! Written by `cargo xtask size --search`.

use super::Radio::{self, Heard, Lost, Stale};
use super::{Robot, Scene};

const fn robot(at_mm: [i16; 2], velocity_mmps: [i16; 2], radius_mm: i16, mode: u8, radio: Radio) -> Robot {
    Robot { at_mm, velocity_mmps, radius_mm, mode, radio }
}

/// The scenes with the longest steps that the search found.
pub const FOUND: &[Scene] = &[
    Scene {
        velocity_mmps: [-11, -94], way_mm: [-4282, 7101], is_second: true,
        walls_mm: [[[929, 347], [1500, 8]], [[1099, 1500], [906, 741]], [[470, 603], [-303, 651]], [[-1147, 941], [907, 730]]],
        robots: [
            robot([317, -1478], [-493, 700], 180, 2, Heard),
            robot([-1142, 371], [575, 100], 337, 1, Stale),
            robot([82, -1489], [-288, 700], 200, 1, Heard),
            robot([-1240, 283], [593, 70], 214, 2, Heard),
            robot([-1496, -92], [540, 311], 400, 0, Heard),
            robot([-263, 1146], [60, -564], 395, 2, Stale),
            robot([91, -1377], [-557, 619], 129, 2, Heard),
            robot([-780, -1038], [40, 169], 373, 2, Stale),
            robot([-1006, -854], [-123, 251], 317, 2, Stale),
            robot([-1009, -857], [-123, 251], 325, 0, Heard),
            robot([56, 458], [-266, 491], 158, 1, Heard),
            robot([56, 458], [-266, 491], 164, 1, Heard),
            robot([-280, -826], [65, -442], 371, 0, Stale),
            robot([56, 458], [-266, 491], 166, 0, Heard),
            robot([-595, -379], [-257, 217], 301, 3, Stale),
            robot([-1036, 767], [-299, 394], 400, 0, Lost),
        ],
    },
];
