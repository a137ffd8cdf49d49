use staya_controller::robot::RobotId;
use staya_link::message::StepResult;
use std::fmt;

/// First different results of a device and of its shadow.
#[derive(Clone, Debug, PartialEq)]
pub struct Mismatch {
    /// The robot.
    pub robot: RobotId,
    /// The device.
    pub device: String,
    /// Whether the robot follows a law of the user's own.
    pub has_own_law: bool,
    /// The host's step count.
    pub tick: u32,
    /// The device's result.
    pub on_device: StepResult,
    /// The shadow's result.
    pub in_shadow: StepResult,
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { robot, device, tick, on_device, in_shadow, has_own_law } = self;
        writeln!(f, "robot {} on {device} differs at step {tick}:", robot.0)?;
        writeln!(f, "{:>10}  {:<38}  this host", "", "device")?;
        let (a, b) = (on_device, in_shadow);
        let rows = [
            ("digest", format!("{:016x}", a.digest), format!("{:016x}", b.digest)),
            ("mode", format!("{:?}", a.mode), format!("{:?}", b.mode)),
            ("leader", a.leader.0.to_string(), b.leader.0.to_string()),
            ("target", format!("{:?}", a.target), format!("{:?}", b.target)),
            ("command", format!("{:?}", a.outputs.command), format!("{:?}", b.outputs.command)),
            (
                "heard",
                format!("{} and {} refused, {:?}", a.outputs.received, a.outputs.rejected, a.outputs.refused),
                format!("{} and {} refused, {:?}", b.outputs.received, b.outputs.rejected, b.outputs.refused),
            ),
            ("events", format!("{:?}", a.outputs.events), format!("{:?}", b.outputs.events)),
            ("outbox", hex(&a.outputs.outbox), hex(&b.outputs.outbox)),
            (
                "call again",
                format!("{} us", a.outputs.call_again.as_micros()),
                format!("{} us", b.outputs.call_again.as_micros()),
            ),
        ];
        for (name, device, host) in rows {
            let mark = if device == host { ' ' } else { '*' };
            if device.len() <= 38 {
                writeln!(f, "{mark}{name:>9}  {device:<38}  {host}")?;
            } else {
                writeln!(f, "{mark}{name:>9}  {device}\n{:>10}  {:<38}  {host}", "", "")?;
            }
        }
        if *has_own_law {
            writeln!(
                f,
                "Does your law take functions of f32, as in `y.atan2(x)` with y: f32? They differ between processors: take \
                 those of Scalar (docs/project.md); `cargo clippy --all-targets` finds the others"
            )?;
        }
        Ok(())
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
