//! A guidance made for the grid, on a body that moves in the plane.

use super::Parameter;
use super::guidance::{BadInput, Guidance, Guided, View};
use crate::geom::Vec2;
use crate::grid::{Cell, Dir};
use crate::rand::Rng;
use crate::scalar::Scalar;
use crate::time::Instant;
use crate::wire::TemplateAssignment;
use serde::Serialize;

/// Goes towards the centre of the cell that a guidance on the grid would move to.
///
/// The guidance decides anew when the robot has come into another cell, and otherwise as often as it would on the grid:
/// once in the time that the robot needs to cross a cell of its land at cruising speed. It sees other robots by their
/// cells as ever; that they may share a cell now is the safety layer's business.
#[derive(Clone, Debug, Serialize)]
pub struct InPlane<S, G> {
    guidance: G,
    speed_mps: S,
    last: Option<Decision<S>>,
}

#[derive(Clone, Debug, Serialize)]
struct Decision<S> {
    cell: Cell,
    at: Instant,
    guided: Guided<S>,
}

impl<S: Scalar, G> InPlane<S, G> {
    /// `guidance` in the plane, cruising at `speed_mps` (the body's own limit holds too).
    #[must_use]
    pub const fn new(guidance: G, speed_mps: S) -> Self {
        Self {
            guidance,
            speed_mps,
            last: None,
        }
    }

    /// The guidance on the grid, for what it can tell of itself.
    #[must_use]
    pub const fn inside(&self) -> &G {
        &self.guidance
    }
}

impl<S: Scalar, G: Guidance<S>> Guidance<S> for InPlane<S, G> {
    type Workspace = G::Workspace;

    #[inline(never)]
    fn decide(
        &mut self,
        view: &View<'_, S>,
        rng: &mut Rng,
        workspace: &mut Self::Workspace,
    ) -> Result<Guided<S>, BadInput> {
        let (state, place) = view.cell.zip(view.in_cell).ok_or(BadInput)?;
        let speed = self.speed_mps.min(view.body.max_speed_mps);
        let crossing_s = place.cell_m.checked_div(speed);
        let crossing_s = crossing_s.filter(|span| *span > S::ZERO).ok_or(BadInput)?;
        let is_due = |last: &Decision<S>| {
            let age_s = S::from_micro(view.now.since(last.at).as_micros());
            last.cell != state.cell || age_s < S::ZERO || age_s >= crossing_s
        };
        let guided = match &self.last {
            Some(last) if !is_due(last) => Guided {
                asks: heapless::Vec::new(),
                ..last.guided.clone()
            },
            _ => {
                self.last = None;
                let guided = self.guidance.decide(view, rng, workspace)?;
                self.last = Some(Decision {
                    cell: state.cell,
                    at: view.now,
                    guided: guided.clone(),
                });
                guided
            }
        };
        let to_center = |cells: Cell| {
            let along = |cells: i16, offset: S| S::from_i32(cells.into()) * place.cell_m - offset;
            Vec2::new(
                along(cells.x, place.offset_m.x),
                along(cells.y, place.offset_m.y),
            )
        };
        let dir = guided.moves.first().copied().unwrap_or(Dir::Stay);
        let way = to_center(dir.offset());
        // On the last step no farther than the centre.
        let needed = way.norm().checked_div(view.body.step_s).unwrap_or(speed);
        let ahead = way.normalized().unwrap_or_default();
        Ok(Guided {
            velocity_mps: (ahead * needed.min(speed)).extend(S::ZERO),
            way_m: Some(to_center(guided.target - state.cell).extend(S::ZERO)),
            ..guided
        })
    }

    fn redirect(&mut self) {
        self.guidance.redirect();
        self.last = None;
    }

    fn assign_template(&mut self, part: &TemplateAssignment, is_anew: bool) -> bool {
        self.guidance.assign_template(part, is_anew)
    }

    fn goes_to_cells(&self) -> bool {
        self.guidance.goes_to_cells()
    }

    fn goal_offset(&self) -> Cell {
        self.guidance.goal_offset()
    }

    fn needs(&self, id: crate::robot::RobotId) -> bool {
        self.guidance.needs(id)
    }

    fn parameter(&self, parameter: Parameter) -> Option<S> {
        (parameter == Parameter::Speed).then_some(self.speed_mps)
    }

    fn tune(&mut self, parameter: Parameter, value: S) -> bool {
        if parameter == Parameter::Speed {
            // Without a speed it could not decide.
            self.speed_mps = value.max(S::from_milli(1));
        }
        parameter == Parameter::Speed
    }
}
