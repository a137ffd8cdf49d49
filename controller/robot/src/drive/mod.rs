//! From the controller's velocity to the duty of each motor.
//!
//! ```text
//! Command::Velocity (world, m/s) --LookAhead or Twist::holonomic--> Twist (body, m/s and rad/s)
//!   --Mixer (Kinematics, limits)--> rim speed of each wheel, m/s
//!   --Wheels (Calibration)--> signed duty --Motor--> embedded-hal's PWM and pins
//! ```
//!
//! Directions: x ahead, y to the left, turns counter-clockwise seen from above. Rim speeds are
//! positive when they drive the robot ahead (omni wheels: counter-clockwise). To keep speeds under
//! load, close a loop around each motor with the mixer's speeds as set points.

mod differential;
mod holonomic;
mod mixer;
mod motor;
mod twist;
mod wheels;

pub use differential::{Differential, LookAhead};
pub use holonomic::{Mecanum, Omni};
pub use mixer::{Limits, Mixer};
pub use motor::{FULL, HBridge, Motor, MotorError, SignMagnitude, TwoPins};
pub use twist::{Kinematics, Twist, wished_velocity, wrap_angle};
pub use wheels::{Calibration, Wheels, rim_speed};

#[cfg(test)]
mod tests;
