//! A guidance that is told when its vehicle is not its own.

use staya_controller::agent::{BadInput, Guidance, Guided, Place, View};
use staya_controller::grid::Cell;
use staya_controller::rand::Rng;
use staya_controller::wire::{RobotId, TemplateAssignment};

/// A guidance that has a fault while its body cannot move: so the robot stands, says so by its beacons, and the others make way.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Held<G>(pub G);

impl<G: Guidance<f32>> Guidance<f32> for Held<G> {
    type Workspace = G::Workspace;

    fn decide(
        &mut self,
        view: &View<'_, f32>,
        rng: &mut Rng,
        workspace: &mut Self::Workspace,
    ) -> Result<Guided<f32>, BadInput> {
        if view.body.max_speed_mps > 0.0 {
            self.0.decide(view, rng, workspace)
        } else {
            Err(BadInput)
        }
    }

    fn redirect(&mut self) {
        self.0.redirect();
    }

    fn assign_template(&mut self, part: &TemplateAssignment, is_anew: bool) -> bool {
        self.0.assign_template(part, is_anew)
    }

    fn assign_place(&mut self, index: u8, place: &Place<f32>) -> bool {
        self.0.assign_place(index, place)
    }

    fn has_own_goal(&self) -> bool {
        self.0.has_own_goal()
    }

    fn goal_offset(&self) -> Cell {
        self.0.goal_offset()
    }

    fn needs(&self, id: RobotId) -> bool {
        self.0.needs(id)
    }
}
