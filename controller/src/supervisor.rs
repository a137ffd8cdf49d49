//! The mode of a robot as a pure function of its previous mode and its situation: [`next_mode`].

use crate::robot::Mode;
use serde::{Deserialize, Serialize};

/// The conditions of the next mode: those of its agent, and the progress of its law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Situation {
    /// The motors are off, or another controller steers the robot.
    Passive,
    /// An input that the guidance law needs is missing or invalid.
    Fault,
    /// It has no goal.
    #[default]
    Idle,
    /// It is at its goal.
    Arrived,
    /// It has a reason to wait.
    Waiting,
    /// No open route exists.
    Stuck,
    /// Another robot asked this one to stop, or all others are out of contact.
    Stopped,
    /// It is too far from its place in the formation.
    Forming,
    /// It goes.
    Going,
}

/// Returns the mode that follows `mode`. From [`Mode::Passive`] and [`Mode::Fault`] a robot that
/// its agent steers passes through [`Mode::Idle`] for one step.
#[must_use]
pub const fn next_mode(mode: Mode, situation: Situation) -> Mode {
    match situation {
        Situation::Passive => Mode::Passive,
        Situation::Fault => Mode::Fault,
        _ if !mode.gives_way() => Mode::Idle,
        Situation::Idle => Mode::Idle,
        Situation::Arrived => Mode::Arrived,
        Situation::Waiting | Situation::Stuck | Situation::Stopped => Mode::Hold,
        Situation::Forming => Mode::Forming,
        Situation::Going => Mode::Cruise,
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

    const SITUATIONS: [(Situation, Mode); 9] = [
        (Situation::Passive, Mode::Passive),
        (Situation::Fault, Mode::Fault),
        (Situation::Idle, Mode::Idle),
        (Situation::Arrived, Mode::Arrived),
        (Situation::Waiting, Mode::Hold),
        (Situation::Stuck, Mode::Hold),
        (Situation::Stopped, Mode::Hold),
        (Situation::Forming, Mode::Forming),
        (Situation::Going, Mode::Cruise),
    ];

    #[test]
    fn each_situation_has_a_mode_that_follows_steered_modes_at_once() {
        for from in modes() {
            for (situation, mode) in SITUATIONS {
                let is_steered = !matches!(mode, Mode::Passive | Mode::Fault);
                let passes_through = is_steered && !from.gives_way();
                let expected = if passes_through { Mode::Idle } else { mode };
                assert_eq!(next_mode(from, situation), expected, "{from:?} {situation:?}");
            }
        }
    }

    #[test]
    fn only_forming_and_cruise_move() {
        let moving: std::vec::Vec<Mode> = modes().filter(|&m| moves(m)).collect();
        assert_eq!(moving, [Mode::Forming, Mode::Cruise]);
    }
}
