//! The mode of a robot as a pure function of its previous mode and its situation: [`next_mode`].

use crate::robot::Mode;
use serde::{Deserialize, Serialize};

/// The conditions on which the next mode depends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Situation {
    /// The motors are off, or another controller steers the robot.
    pub is_passive: bool,
    /// An input that the guidance law needs is missing or invalid.
    pub has_fault: bool,
    /// The robot has a goal.
    pub has_goal: bool,
    /// The robot is at its goal.
    pub is_at_goal: bool,
    /// Another robot asked this one to stop, or its followers are too far behind.
    pub is_stopped: bool,
    /// No open route exists.
    pub is_stuck: bool,
    /// The robot is too far from its place in the formation.
    pub is_off_place: bool,
}

/// Returns the mode that follows `mode`, by the first rule that applies:
///
/// 1. A robot that its agent may not steer is [`Mode::Passive`].
/// 2. A fault stops the robot: [`Mode::Fault`].
/// 3. From [`Mode::Passive`] and [`Mode::Fault`] it passes through [`Mode::Idle`] for one step.
/// 4. Without a goal it is [`Mode::Idle`].
/// 5. At its goal it is [`Mode::Arrived`], even if it was asked to stop.
/// 6. A stop, or the lack of an open route, gives [`Mode::Hold`].
/// 7. Away from its place in the formation it is [`Mode::Forming`], otherwise [`Mode::Cruise`].
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

/// Returns whether a robot in this mode moves by its own decision.
#[must_use]
pub const fn moves(mode: Mode) -> bool {
    matches!(mode, Mode::Forming | Mode::Cruise)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn modes() -> impl Iterator<Item = Mode> {
        (0..).map_while(Mode::from_number)
    }

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

    #[test]
    fn every_transition_has_exactly_its_condition() {
        for from in modes() {
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
    fn every_steered_mode_leads_to_all_modes() {
        for from in modes() {
            let reached: std::collections::HashSet<Mode> = situations().map(|s| next_mode(from, s)).collect();
            let modes = if from.gives_way() { 7 } else { 3 };
            assert_eq!(reached.len(), modes, "{from:?}");
        }
    }

    #[test]
    fn only_forming_and_cruise_move() {
        let moving: std::vec::Vec<Mode> = modes().filter(|&m| moves(m)).collect();
        assert_eq!(moving, [Mode::Forming, Mode::Cruise]);
    }
}
