//! The mode of a robot as one pure function of its mode and its situation. Read [`next_mode`] first.

use crate::robot::Mode;
use serde::{Deserialize, Serialize};

/// What the next mode depends on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Situation {
    /// The motors are off, or somebody else steers.
    pub is_passive: bool,
    /// An input that the guidance needs is missing or wrong.
    pub has_fault: bool,
    /// There is somewhere to go.
    pub has_goal: bool,
    /// The robot stands where it should.
    pub is_at_goal: bool,
    /// Somebody asked the robot to stand, or its followers are too far behind.
    pub is_stopped: bool,
    /// No way is open.
    pub is_stuck: bool,
    /// It is too far from its place in the formation.
    pub is_off_place: bool,
}

/// The mode that follows `mode` in a situation: the first of these rules that applies.
///
/// 1. One that is not to be steered is passive, whatever else holds.
/// 2. A fault stands the robot still.
/// 3. Out of [`Mode::Passive`] and [`Mode::Fault`] the way leads through [`Mode::Idle`]: for one step it stands and looks.
/// 4. Without a goal it is idle.
/// 5. At its goal it has arrived; a stop changes nothing there.
/// 6. A stop, or no open way, holds it.
/// 7. Off its place it is forming; [`Mode::Cruise`] otherwise.
#[must_use]
pub const fn next_mode(mode: Mode, situation: Situation) -> Mode {
    let s = situation;
    if s.is_passive {
        Mode::Passive
    } else if s.has_fault {
        Mode::Fault
    } else if !mode.gives_way() || !s.has_goal {
        Mode::Idle
    } else if s.is_at_goal {
        Mode::Arrived
    } else if s.is_stopped || s.is_stuck {
        Mode::Hold
    } else if s.is_off_place {
        Mode::Forming
    } else {
        Mode::Cruise
    }
}

/// Whether a robot in this mode moves of its own accord.
#[must_use]
pub const fn moves(mode: Mode) -> bool {
    matches!(mode, Mode::Forming | Mode::Cruise)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODES: [Mode; 7] =
        [Mode::Idle, Mode::Forming, Mode::Cruise, Mode::Hold, Mode::Arrived, Mode::Fault, Mode::Passive];

    fn situations() -> impl Iterator<Item = Situation> {
        (0..128_u8).map(|bits| {
            let bit = |n: u8| bits & (1 << n) != 0;
            Situation {
                has_fault: bit(0),
                has_goal: bit(1),
                is_at_goal: bit(2),
                is_stopped: bit(3),
                is_stuck: bit(4),
                is_off_place: bit(5),
                is_passive: bit(6),
            }
        })
    }

    /// Each pair of modes: exactly the situations that lead from one to the other.
    #[test]
    fn every_pair_of_modes_has_its_condition() {
        for from in MODES {
            for s in situations() {
                let to = next_mode(from, s);
                let goes = s.has_goal && !s.is_at_goal && !s.is_stopped && !s.is_stuck;
                let sound = !s.is_passive && !s.has_fault;
                let settled = sound && from.gives_way();
                let expected = [
                    (Mode::Passive, s.is_passive),
                    (Mode::Fault, s.has_fault && !s.is_passive),
                    (Mode::Idle, sound && (!from.gives_way() || !s.has_goal)),
                    (Mode::Arrived, settled && s.has_goal && s.is_at_goal),
                    (Mode::Hold, settled && s.has_goal && !s.is_at_goal && (s.is_stopped || s.is_stuck)),
                    (Mode::Forming, settled && goes && s.is_off_place),
                    (Mode::Cruise, settled && goes && !s.is_off_place),
                ];
                for (mode, condition) in expected {
                    assert_eq!(to == mode, condition, "{from:?} {s:?} {mode:?}");
                }
            }
        }
    }

    #[test]
    fn every_mode_is_reached_from_every_other_that_is_steered() {
        for from in MODES {
            let reached: std::collections::HashSet<Mode> = situations().map(|s| next_mode(from, s)).collect();
            // From the two others the way leads through one step of standing.
            let modes = if from.gives_way() { 7 } else { 3 };
            assert_eq!(reached.len(), modes, "{from:?}");
        }
    }

    #[test]
    fn only_travelling_modes_move() {
        let moving: std::vec::Vec<Mode> = MODES.into_iter().filter(|&m| moves(m)).collect();
        assert_eq!(moving, [Mode::Forming, Mode::Cruise]);
    }
}
