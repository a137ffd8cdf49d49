//! A safety layer wrapper that records its inputs.

use serde::{Deserialize, Serialize};
use staya_controller::agent::{Safety, SafetyInput};
use staya_controller::body::Body;
use staya_controller::geom::Vec3;
use staya_controller::neighbor::{Nearby, StalenessInflation};
use staya_controller::obstacle::Obstacle;
use staya_controller::parameters::Parameters;
use staya_controller::rand::Rng;

#[derive(Clone, Debug)]
pub struct Asked {
    pub body: Body<f32>,
    pub wish_mps: Vec3<f32>,
    pub nearby: Vec<Nearby<f32>>,
    pub obstacles: Vec<Obstacle<f32>>,
}

/// Records the inputs of layer `A` after [`Witness::listen`]; state and results are those of `A`.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Witness<A> {
    inside: A,
    #[serde(skip)]
    listens: bool,
    #[serde(skip)]
    asked: Option<Box<Asked>>,
}

impl<A> Witness<A> {
    pub const fn new(inside: A) -> Self {
        Self { inside, listens: false, asked: None }
    }

    pub const fn listen(&mut self) {
        self.listens = true;
    }

    pub const fn inside(&self) -> &A {
        &self.inside
    }

    /// Inputs of the last step, if they were recorded.
    pub fn asked(&self) -> Option<&Asked> {
        self.asked.as_deref()
    }
}

impl<A: Safety<f32>> Safety<f32> for Witness<A> {
    fn keep_clear(&mut self, input: &SafetyInput<'_, f32>, rng: &mut Rng) -> Vec3<f32> {
        if self.listens {
            self.asked = Some(Box::new(Asked {
                body: input.body,
                wish_mps: input.wish_mps,
                nearby: input.nearby.to_vec(),
                obstacles: input.obstacles.to_vec(),
            }));
        }
        self.inside.keep_clear(input, rng)
    }

    fn inflation(&self) -> Option<StalenessInflation<f32>> {
        self.inside.inflation()
    }

    fn downwash(&self) -> f32 {
        self.inside.downwash()
    }

    fn waits_for_turn(&self) -> bool {
        self.inside.waits_for_turn()
    }

    fn parameters(&mut self, visit: &mut dyn FnMut(&mut dyn Parameters)) {
        self.inside.parameters(visit);
    }
}
