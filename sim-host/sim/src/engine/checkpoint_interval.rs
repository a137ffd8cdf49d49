//! The interval between checkpoints.

use std::str::FromStr;
use std::time::Duration;

/// Interval between checkpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckpointInterval {
    /// Real time.
    Time(Duration),
    /// Number of ticks.
    Ticks(u32),
}

impl FromStr for CheckpointInterval {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
        let (number, unit) = text.split_at(end);
        let seconds = match unit.trim() {
            "s" => 1,
            "min" => 60,
            "h" => 3600,
            "ticks" => 0,
            _ => return Err("give a number and its unit: 600s, 10min, 2h or 1000ticks".to_owned()),
        };
        let number: u32 = number.parse().map_err(|_| "give a whole number, such as 600s or 1000ticks".to_owned())?;
        match (number, seconds) {
            (0, _) => Err("give 1 or more".to_owned()),
            (ticks, 0) => Ok(Self::Ticks(ticks)),
            (number, seconds) => Ok(Self::Time(Duration::from_secs(u64::from(number) * seconds))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_has_a_unit() {
        let seconds = |seconds| Ok(CheckpointInterval::Time(Duration::from_secs(seconds)));
        assert_eq!("600s".parse(), seconds(600));
        assert_eq!("10min".parse(), seconds(600));
        assert_eq!("2h".parse(), seconds(7200));
        assert_eq!("1000ticks".parse(), Ok(CheckpointInterval::Ticks(1000)));
        for wrong in ["", "600", "s", "-1s", "0s", "0ticks", "1.5h", "99999999999s", "5 days"] {
            assert!(wrong.parse::<CheckpointInterval>().is_err(), "{wrong}");
        }
    }
}
