//! Robots that walk alone by the controller's router ([`crate::walk`]), with a memory of any size.

use super::Given;
use crate::error::SweepError;
use crate::walk::{Task, Walk, Walker};
use staya_controller::grid::{Cell, UNIT};
use staya_controller::rand::Rng;
use staya_controller::route::{Replan, RouteParams};
use staya_controller::shuffle::Sharpness;
use staya_sim::terrain::Terrain;

/// Largest search with its border: 255 x 255, the limit of 16-bit indices.
pub const CELLS: usize = 255 * 255;

/// A [`Walker`] without its sizes.
pub trait Walks {
    /// See [`Walker::walk_shuffled`].
    fn walk(&mut self, task: &Task<'_>, params: &RouteParams, replan: Replan, order: (Sharpness, &mut Rng)) -> Walk;

    /// See [`Walker::price`].
    fn price(&mut self, land: &Terrain, params: &RouteParams, from: Cell, to: Cell) -> Option<f64>;

    /// See [`Walker::path`].
    fn path(&self) -> &[Cell];
}

impl<const M: usize, const L: usize> Walks for Walker<CELLS, M, L> {
    fn walk(
        &mut self,
        task: &Task<'_>,
        params: &RouteParams,
        replan: Replan,
        (sharpness, rng): (Sharpness, &mut Rng),
    ) -> Walk {
        self.walk_shuffled(task, params, replan, sharpness, rng)
    }

    fn price(&mut self, land: &Terrain, params: &RouteParams, from: Cell, to: Cell) -> Option<f64> {
        self.price(land, params, from, to)
    }

    fn path(&self) -> &[Cell] {
        self.path()
    }
}

/// Creates a walker.
pub type Maker = fn() -> Box<dyn Walks>;

/// The walker with a memory of `visits` visited cells (6 bytes each) and `learned` cells with
/// learned travel costs (8 bytes each).
///
/// # Errors
/// There is no walker of this size.
pub fn maker(given: &Given<'_>, visits: u32, learned: u32) -> Result<Maker, SweepError> {
    let maker = match visits {
        16 => with_visits::<16>(learned),
        64 => with_visits::<64>(learned),
        256 => with_visits::<256>(learned),
        1024 => with_visits::<1024>(learned),
        other => {
            return Err(given.error("visits", format!("a memory of {other} cells"), "give 16, 64, 256 or 1024"));
        }
    };
    maker.ok_or_else(|| given.error("learned", format!("{learned} learned cells"), "give 0, 64 or 256"))
}

fn with_visits<const M: usize>(learned: u32) -> Option<Maker> {
    match learned {
        0 => Some(made::<M, 0>),
        64 => Some(made::<M, 64>),
        256 => Some(made::<M, 256>),
        _ => None,
    }
}

fn made<const M: usize, const L: usize>() -> Box<dyn Walks> {
    Box::new(Walker::<CELLS, M, L>::default())
}

/// Default size of the memory of visits.
pub const VISITS: u32 = 64;

/// Default size of the memory of learned costs, which the robots of scenarios have too.
pub const LEARNED: u32 = 256;

/// Excess of a value over the best one, percent.
pub fn percent(ours: f64, best: f64) -> f64 {
    if ours == best { 0.0 } else { 100.0 * (ours - best) / best }
}

/// Converts [`UNIT`]ths to cells or ticks.
pub fn whole(units: f64) -> f64 {
    units / f64::from(UNIT)
}
