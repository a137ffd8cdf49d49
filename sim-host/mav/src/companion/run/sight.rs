use super::Vehicle;
use crate::geo::Origin;
use std::time::Duration;

/// The vehicles of this process at one moment, in the order of the configuration.
#[derive(Clone, Copy)]
pub struct Sight<'a> {
    pub(crate) vehicles: &'a [Vehicle],
    pub(crate) origin: &'a Origin,
    /// Time since the start.
    pub(crate) now: Duration,
}
