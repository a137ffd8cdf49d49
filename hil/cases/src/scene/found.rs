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
        walls_mm: [[[901, 395], [1245, 410]], [[1116, 1335], [909, 733]], [[477, 610], [34, 642]], [[-1161, 901], [900, 731]]],
        robots: [
            robot([325, -1459], [-493, 700], 180, 1, Heard),
            robot([-1496, -92], [540, 311], 400, 0, Heard),
            robot([82, -1489], [-346, 695], 200, 1, Heard),
            robot([84, -1348], [-557, 619], 135, 1, Stale),
            robot([-1182, 322], [557, 29], 250, 1, Heard),
            robot([-257, 1091], [57, -576], 400, 2, Stale),
            robot([-1142, 371], [369, 120], 339, 2, Heard),
            robot([-780, -1038], [47, 165], 377, 0, Heard),
            robot([-595, -379], [-265, 93], 339, 3, Stale),
            robot([-595, -379], [-272, 92], 336, 3, Stale),
            robot([-595, -379], [-283, 99], 334, 3, Stale),
            robot([-280, -826], [65, -442], 400, 2, Stale),
            robot([56, 458], [-266, 491], 157, 2, Stale),
            robot([56, 458], [-266, 491], 164, 1, Heard),
            robot([56, 458], [-266, 491], 166, 1, Heard),
            robot([-1036, 767], [-299, 394], 394, 0, Lost),
        ],
    },
];
