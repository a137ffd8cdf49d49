//! The voxel table, computed at compile time.

/// Scale of normals and sines: a power of two, exact in every scalar type.
pub(super) const ONE: i32 = 1 << 14;

/// Normals of the velocity obstacle by sine of its half angle and direction from its disc's centre.
#[derive(Clone, Copy, Debug)]
pub struct VelocityObstacleTable {
    /// Sines of the half angle, ascending from 0 to 1, in 1 / 2^14.
    pub(super) sines: &'static [u16],
    /// Directions per level: equal steps of x / (x + y), from perpendicular to straight back.
    pub(super) directions: usize,
    /// Outward normals in 1 / 2^14, by level, then by direction: along the axis (negated) and
    /// across it.
    pub(super) normals: &'static [[i16; 2]],
}

impl VelocityObstacleTable {
    /// Size of the table in bytes.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        size_of_val(self.sines) + size_of_val(self.normals)
    }

    /// Number of levels and directions.
    #[must_use]
    pub const fn shape(&self) -> [usize; 2] {
        [self.sines.len(), self.directions]
    }
}

/// ORCA's table of at most 2 KiB, as a source of half-planes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct VoxelTable2k;

const LEVELS: usize = 20;
const DIRECTIONS: usize = 25;

impl VoxelTable2k {
    /// The table of velocity obstacles.
    pub const TABLE: VelocityObstacleTable = {
        const LEGS: [[i16; 2]; LEVELS] = legs();
        static SINES: [u16; LEVELS] = sines(&LEGS);
        static NORMALS: [[i16; 2]; LEVELS * DIRECTIONS] = normals(&LEGS);
        VelocityObstacleTable { sines: &SINES, directions: DIRECTIONS, normals: &NORMALS }
    };
}

/// Normals of the left leg, with half angles of twice the arc tangents of equal steps.
#[expect(clippy::indexing_slicing, reason = "runs at compile time")]
const fn legs() -> [[i16; 2]; LEVELS] {
    let mut legs = [[0; 2]; LEVELS];
    let mut level = 0;
    while level < LEVELS {
        let t = level as f64 / (LEVELS - 1) as f64;
        let scale = ONE as f64 / (1.0 + t * t);
        legs[level] = [rounded(2.0 * t * scale), rounded((1.0 - t * t) * scale)];
        level += 1;
    }
    legs
}

/// Sines are rounded down: the cone must not be wider than the stored normals allow.
#[expect(clippy::indexing_slicing, reason = "runs at compile time")]
const fn sines(legs: &[[i16; 2]; LEVELS]) -> [u16; LEVELS] {
    let mut sines = [0; LEVELS];
    let mut level = 0;
    while level < LEVELS {
        let (x, y) = (legs[level][0] as f64, legs[level][1] as f64);
        sines[level] = (x / root(x * x + y * y) * ONE as f64) as u16;
        level += 1;
    }
    sines
}

#[expect(clippy::indexing_slicing, clippy::integer_division_remainder_used, reason = "runs at compile time")]
const fn normals(legs: &[[i16; 2]; LEVELS]) -> [[i16; 2]; LEVELS * DIRECTIONS] {
    let mut normals = [[0; 2]; LEVELS * DIRECTIONS];
    let mut at = 0;
    while at < LEVELS * DIRECTIONS {
        let (level, direction) = (at / DIRECTIONS, at % DIRECTIONS);
        let x = direction as f64 / (DIRECTIONS - 1) as f64;
        normals[at] = normal(legs[level], x, 1.0 - x);
        at += 1;
    }
    normals
}

/// The normal for a point `x` before and `y` beside the centre.
const fn normal(leg: [i16; 2], x: f64, y: f64) -> [i16; 2] {
    let scale = ONE as f64 / root(x * x + y * y);
    let found = [rounded(x * scale), rounded(y * scale)];
    // Rounding must not turn the disc's normal past the leg's.
    if found[0] as i32 * leg[1] as i32 > found[1] as i32 * leg[0] as i32 { found } else { leg }
}

const fn rounded(x: f64) -> i16 {
    (x + 0.5) as i16
}

/// Newton's method; std's root is not available at compile time.
const fn root(x: f64) -> f64 {
    let mut root = x;
    let mut step = 0;
    // Enough for 0.1 to 10^10.
    while step < 25 {
        root = 0.5 * (root + x / root);
        step += 1;
    }
    root
}
