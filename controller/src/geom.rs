//! Vectors in the plane and in space.

/// A vector in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec2<S> {
    /** East. */
    pub x: S,
    /** North. */
    pub y: S,
}
impl<S> Vec2<S> {
    /** A vector. */
    pub const fn new(x: S, y: S) -> Self {
        Self { x, y }
    }
}
/// A vector in space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3<S> {
    /** East. */
    pub x: S,
    /** North. */
    pub y: S,
    /** Up. */
    pub z: S,
}
impl<S> Vec3<S> {
    /** A vector. */
    pub const fn new(x: S, y: S, z: S) -> Self {
        Self { x, y, z }
    }
}
