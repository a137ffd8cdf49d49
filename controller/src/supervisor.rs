//! The mode of a robot as one pure function of its mode and its situation. Read [`next_mode`] first.

use crate::wire::Mode;
use serde::Serialize;

/// What the next mode depends on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Situation {
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
/// 1. A fault stands the robot still, whatever else holds.
/// 2. Out of [`Mode::Fault`] the way leads through [`Mode::Idle`]: for one step it stands and looks.
/// 3. Without a goal it is idle.
/// 4. At its goal it has arrived; a stop changes nothing there.
/// 5. A stop, or no open way, holds it.
/// 6. Off its place it is forming; [`Mode::Cruise`] otherwise.
#[must_use]
pub const fn next_mode(mode: Mode, situation: Situation) -> Mode {
    match (mode, situation) {
        (
            _,
            Situation {
                has_fault: true, ..
            },
        ) => Mode::Fault,
        (Mode::Fault, _)
        | (
            _,
            Situation {
                has_goal: false, ..
            },
        ) => Mode::Idle,
        (
            _,
            Situation {
                is_at_goal: true, ..
            },
        ) => Mode::Arrived,
        (
            _,
            Situation {
                is_stopped: true, ..
            }
            | Situation { is_stuck: true, .. },
        ) => Mode::Hold,
        (
            _,
            Situation {
                is_off_place: true, ..
            },
        ) => Mode::Forming,
        _ => Mode::Cruise,
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

    const MODES: [Mode; 6] = [
        Mode::Idle,
        Mode::Forming,
        Mode::Cruise,
        Mode::Hold,
        Mode::Arrived,
        Mode::Fault,
    ];

    fn situations() -> impl Iterator<Item = Situation> {
        (0..64_u8).map(|bits| {
            let bit = |n: u8| bits & (1 << n) != 0;
            Situation {
                has_fault: bit(0),
                has_goal: bit(1),
                is_at_goal: bit(2),
                is_stopped: bit(3),
                is_stuck: bit(4),
                is_off_place: bit(5),
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
                let expected = [
                    (Mode::Fault, s.has_fault),
                    (
                        Mode::Idle,
                        !s.has_fault && (from == Mode::Fault || !s.has_goal),
                    ),
                    (Mode::Arrived, s.has_goal && s.is_at_goal),
                    (
                        Mode::Hold,
                        s.has_goal && !s.is_at_goal && (s.is_stopped || s.is_stuck),
                    ),
                    (Mode::Forming, goes && s.is_off_place),
                    (Mode::Cruise, goes && !s.is_off_place),
                ];
                for (mode, condition) in expected {
                    let shadowed = s.has_fault && mode != Mode::Fault
                        || from == Mode::Fault && !matches!(mode, Mode::Fault | Mode::Idle);
                    assert_eq!(
                        to == mode,
                        condition && !shadowed,
                        "{from:?} {s:?} {mode:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn every_mode_is_reached_from_every_other_except_out_of_a_fault() {
        for from in MODES {
            let reached: std::collections::HashSet<Mode> =
                situations().map(|s| next_mode(from, s)).collect();
            assert_eq!(
                reached.len(),
                if from == Mode::Fault { 2 } else { 6 },
                "{from:?}"
            );
        }
    }

    #[test]
    fn only_travelling_modes_move() {
        let moving: std::vec::Vec<Mode> = MODES.into_iter().filter(|&m| moves(m)).collect();
        assert_eq!(moving, [Mode::Forming, Mode::Cruise]);
    }
}
