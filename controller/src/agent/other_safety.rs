//! Collision avoidance in space, and push-out, as safety layers.

use super::Parameter;
use super::safety::{Safety, Sight};
use crate::geom::Vec3;
use crate::neighbor::StalenessInflation;
use crate::orca::{FlyParams, fly};
use crate::push_out::{PushOutParams, push_out};
use crate::rand::Rng;
use crate::scalar::Scalar;
use serde::Serialize;

/// ORCA in space: [`fly`] with at most `K` half-spaces.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct FlySafety<S, const K: usize> {
    params: FlyParams<S>,
    inflation: StalenessInflation<S>,
}

impl<S: Scalar, const K: usize> FlySafety<S, K> {
    /// `inflation`: how the balls of silent neighbours grow.
    #[must_use]
    pub const fn new(params: FlyParams<S>, inflation: StalenessInflation<S>) -> Self {
        Self { params, inflation }
    }
}

impl<S: Scalar, const K: usize> Safety<S> for FlySafety<S, K> {
    fn keep_clear(&mut self, sight: &Sight<'_, S>, _: &mut Rng) -> Vec3<S> {
        let Sight {
            body,
            wish_mps,
            way_m,
            nearby,
            obstacles,
        } = *sight;
        fly::<S, K>(&self.params, &body, wish_mps, way_m, nearby, obstacles).velocity_mps
    }

    fn inflation(&self) -> StalenessInflation<S> {
        self.inflation
    }

    fn parameter(&self, parameter: Parameter) -> Option<S> {
        let params = &self.params;
        Some(match parameter {
            Parameter::Horizon => params.horizon_s,
            Parameter::WallHorizon => params.obstacle_horizon_s,
            Parameter::Share => params.share,
            Parameter::Margin => params.margin_m,
            _ => return None,
        })
    }

    fn tune(&mut self, parameter: Parameter, value: S) -> bool {
        let params = &mut self.params;
        match parameter {
            Parameter::Horizon => params.horizon_s = value,
            Parameter::WallHorizon => params.obstacle_horizon_s = value,
            Parameter::Share => params.share = value,
            Parameter::Margin => params.margin_m = value,
            _ => return false,
        }
        true
    }
}

/// Push-out (PAV): steps that lead too near are put right, but only against where others are now.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PushOutSafety<S> {
    params: PushOutParams<S>,
}

impl<S: Scalar> PushOutSafety<S> {
    /// With these parameters.
    #[must_use]
    pub const fn new(params: PushOutParams<S>) -> Self {
        Self { params }
    }
}

impl<S: Scalar> Safety<S> for PushOutSafety<S> {
    fn keep_clear(&mut self, sight: &Sight<'_, S>, _: &mut Rng) -> Vec3<S> {
        push_out(
            &self.params,
            &sight.body,
            sight.wish_mps,
            sight.nearby,
            sight.obstacles,
        )
    }
}
