//! Moves of one robot on changing land with limited knowledge.

use super::Run;
use crate::route::CELLS;
use staya_controller::agent::VISITS;
use staya_controller::grid::{Cell, UNIT};
use staya_controller::route::{CostField, Replan, RouteParams, Router};
use staya_sim::terrain::Terrain;
use staya_sim::terrain::change::{LandChange, change};
use staya_sim::world::scouts::Memory;
use staya_sim::world::{known_window, window};

/// Moves after which a robot counts as lost, per cell of width + height.
const PATIENCE: usize = 200;

#[derive(Clone, Copy, Debug)]
pub(super) struct Knowledge<'a> {
    /// `None`: plans on its sight.
    pub map: Option<&'a Terrain>,
    pub sight: u8,
}

pub(super) type Changing<'a> = (&'a Terrain, &'a [LandChange], u64);

#[derive(Default)]
pub(super) struct Scout {
    field: Box<CostField<CELLS>>,
    known: Vec<u8>,
    seen: Vec<u8>,
}

impl Scout {
    /// Crosses cells at their pace on entry, as in the simulator. Ends at the target, without a
    /// possible move, or after `PATIENCE`.
    pub fn walk(
        &mut self,
        (land, changes, seed): Changing<'_>,
        [from, to]: [Cell; 2],
        knowledge: &Knowledge<'_>,
        params: &RouteParams,
        replan: Replan,
    ) -> Run {
        let (mut land, mut ticks) = (land.clone(), 0..);
        let (mut router, mut memory) = (Router::<VISITS>::new(), Memory::new());
        let (mut here, mut run) = (from, Run::default());
        let limit = PATIENCE * (usize::from(land.width()) + usize::from(land.height()));
        let mut next = ticks.next();
        while (run.moves as usize) < limit {
            // Decides at the first tick after arrival in the cell.
            let now = run.cost.div_ceil(u64::from(UNIT));
            while let Some(tick) = next.filter(|&tick| u64::from(tick) <= now) {
                change(&mut land, changes, seed, tick, |_, _| ());
                next = ticks.next();
            }
            router.observe(params, here, to);
            run.arrived = here == to;
            if run.arrived {
                break;
            }
            let planned = match knowledge.map {
                None => window(&land, here, params.radius, &mut self.known),
                Some(map) => {
                    if let Some(seen) = window(&land, here, knowledge.sight, &mut self.seen) {
                        memory.observe(here, &seen, |cell| map.get(cell));
                    }
                    let radii = [knowledge.sight, params.radius];
                    known_window(&land, (map, &memory), here, radii, &mut self.known)
                }
            };
            let Some(planned) = planned else { break };
            let dir = match replan {
                Replan::EachCell => router
                    .weights(params, &mut self.field, &planned, here, to, [])
                    .ok()
                    .and_then(|weights| weights.best()),
                Replan::UntilChanged => router.follow(params, &mut self.field, &planned, here, to, []).ok(),
            };
            let Some(dir) = dir else { break };
            here = here + dir.offset();
            run.cost += u64::from(dir.length(params.norm)) * u64::from(land.get(here));
            run.moves += 1;
        }
        run.remembered = memory.iter().count() as u32;
        run
    }
}
