//! Maps each [`Parameter`] to a field of a guidance law or a safety layer.

use super::Parameter;
use crate::cost::Gain;
use crate::flock::boids::BoidsParams;
use crate::flock::goal::GoalParams;
use crate::flock::lattice::LatticeParams;
use crate::formation::FormationParams;
use crate::grid::UNIT;
use crate::orca::AvoidParams;
use crate::push_out::PushOutParams;
use crate::route::RouteParams;
use crate::scalar::Scalar;

pub(super) trait Tunable<S>: Copy {
    fn get(&self, parameter: Parameter) -> Option<S>;

    /// `value` is within [`Parameter::range`].
    fn set(&mut self, parameter: Parameter, value: S) -> bool;

    fn is_sound(&self) -> bool {
        true
    }

    fn tune(&mut self, parameter: Parameter, value: S) -> bool {
        let mut tuned = *self;
        let takes = tuned.set(parameter, value) && tuned.is_sound();
        if takes {
            *self = tuned;
        }
        takes
    }
}

macro_rules! fields {
    ($params:ident { $($parameter:ident => $($field:ident).+),* $(,)? } $($is_sound:ident)?) => {
        impl<S: Scalar> Tunable<S> for $params<S> {
            fn get(&self, parameter: Parameter) -> Option<S> {
                Some(match parameter {
                    $(Parameter::$parameter => self.$($field).+,)*
                    _ => return None,
                })
            }

            fn set(&mut self, parameter: Parameter, value: S) -> bool {
                let field = match parameter {
                    $(Parameter::$parameter => &mut self.$($field).+,)*
                    _ => return false,
                };
                *field = value;
                true
            }

            $(fn is_sound(&self) -> bool {
                self.$is_sound()
            })?
        }
    };
}

fields!(AvoidParams {
    Horizon => horizon_s,
    WallHorizon => wall_horizon_s,
    Share => share,
    Margin => margin_m,
    Lean => deadlock.lean_rad,
    PatienceRadii => deadlock.patience_radii,
});

fields!(PushOutParams { MinDistance => min_distance_m });

fields!(GoalParams {
    Speed => speed_mps,
    MinDistance => min_distance_m,
    Neighborhood => neighborhood_m,
    GoalGain => goal_gain,
    CenterGain => center_gain,
    RepulsionGain => repulsion_gain,
} is_sound);

fields!(LatticeParams {
    Spacing => spacing_m,
    RangeRatio => range_ratio,
    ObstacleRatio => obstacle_ratio,
    Attraction => attraction,
    Repulsion => repulsion,
    AlphaPosition => alpha.position,
    AlphaVelocity => alpha.velocity,
    BetaPosition => beta.position,
    BetaVelocity => beta.velocity,
    GammaPosition => gamma.position,
    GammaVelocity => gamma.velocity,
} is_sound);

impl<S: Scalar> Tunable<S> for BoidsParams<S> {
    fn get(&self, parameter: Parameter) -> Option<S> {
        let [crowded_m, closest_m, max_turn, max_turn_away] = self.values();
        Some(match parameter {
            Parameter::Crowded => crowded_m,
            Parameter::Closest => closest_m,
            Parameter::MaxTurn => max_turn,
            Parameter::MaxTurnAway => max_turn_away,
            _ => return None,
        })
    }

    fn set(&mut self, parameter: Parameter, value: S) -> bool {
        let [mut crowded_m, mut closest_m, mut max_turn, mut max_turn_away] = self.values();
        let slot = match parameter {
            Parameter::Crowded => &mut crowded_m,
            Parameter::Closest => &mut closest_m,
            Parameter::MaxTurn => &mut max_turn,
            Parameter::MaxTurnAway => &mut max_turn_away,
            _ => return false,
        };
        *slot = value;
        *self = Self::new(crowded_m, closest_m, max_turn, max_turn_away);
        true
    }
}

fn whole<S: Scalar>(value: S, parts: i32) -> Option<u16> {
    let parts = (value * S::from_i32(parts) + S::HALF).floor_to_i32()?;
    u16::try_from(parts).ok()
}

fn gain<S: Scalar>(gain: Gain) -> S {
    S::from_ratio(gain.sixteenths().into(), 16)
}

impl<S: Scalar> Tunable<S> for RouteParams {
    fn get(&self, parameter: Parameter) -> Option<S> {
        Some(gain(match parameter {
            Parameter::TimeGain => self.a0,
            Parameter::OthersGain => self.a1,
            Parameter::VisitsGain => self.a2,
            Parameter::WayGain => self.a3,
            _ => return None,
        }))
    }

    fn set(&mut self, parameter: Parameter, value: S) -> bool {
        let slot = match parameter {
            Parameter::TimeGain => &mut self.a0,
            Parameter::OthersGain => &mut self.a1,
            Parameter::VisitsGain => &mut self.a2,
            Parameter::WayGain => &mut self.a3,
            _ => return false,
        };
        let sixteenths = whole(value, 16);
        *slot = sixteenths.map_or(*slot, Gain::from_sixteenths);
        sixteenths.is_some()
    }
}

impl<S: Scalar> Tunable<S> for FormationParams {
    fn get(&self, parameter: Parameter) -> Option<S> {
        let cells = |units: u16| S::from_ratio(units.into(), UNIT.cast_signed());
        Some(match parameter {
            Parameter::Eps => S::from_i32(self.eps.into()),
            Parameter::PlaceGain => gain(self.gain),
            Parameter::HaltLag => cells(self.halt_lag),
            Parameter::ResumeLag => cells(self.resume_lag),
            Parameter::Lead => S::from_i32(self.lead.into()),
            Parameter::Footprint => S::from_i32(self.footprint.into()),
            Parameter::Patience => S::from_i32(self.patience.into()),
            _ => return None,
        })
    }

    fn set(&mut self, parameter: Parameter, value: S) -> bool {
        let parts = match parameter {
            Parameter::PlaceGain => 16,
            Parameter::HaltLag | Parameter::ResumeLag => UNIT.cast_signed(),
            _ => 1,
        };
        let Some(whole) = whole(value, parts) else {
            return false;
        };
        let byte = u8::try_from(whole).unwrap_or(u8::MAX);
        match parameter {
            Parameter::Eps => self.eps = byte,
            Parameter::PlaceGain => self.gain = Gain::from_sixteenths(whole),
            Parameter::HaltLag => self.halt_lag = whole,
            Parameter::ResumeLag => self.resume_lag = whole,
            Parameter::Lead => self.lead = byte,
            Parameter::Footprint => self.footprint = byte,
            Parameter::Patience => self.patience = whole,
            _ => return false,
        }
        true
    }

    fn is_sound(&self) -> bool {
        self.resume_lag <= self.halt_lag
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gains_and_cells_are_rounded_to_the_nearest_part() {
        let mut route = RouteParams::default();
        let mut formation = FormationParams::default();
        for (value, rounded) in [(0.7, 0.6875), (0.72, 0.75), (3.0, 3.0)] {
            assert!(Tunable::<f32>::tune(&mut route, Parameter::VisitsGain, value));
            assert_eq!(route.get(Parameter::VisitsGain), Some(rounded));
            assert!(Tunable::<f32>::tune(&mut formation, Parameter::PlaceGain, value));
            assert_eq!(formation.get(Parameter::PlaceGain), Some(rounded));
        }
        for (value, rounded) in [(4.4, 4.0), (4.6, 5.0)] {
            assert!(Tunable::<f32>::tune(&mut formation, Parameter::Eps, value));
            assert_eq!(formation.get(Parameter::Eps), Some(rounded));
        }
        assert!(!Tunable::<f32>::tune(&mut formation, Parameter::ResumeLag, 100.0), "above the lag that halts");
        assert!(!Tunable::<f32>::tune(&mut route, Parameter::VisitsGain, -1.0));
    }
}
