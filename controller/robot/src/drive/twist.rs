use staya_controller::agent::Command;
use staya_controller::geom::Vec2;
use staya_controller::scalar::Scalar;

/// The motion of a body in its own frame; also its displacement in a span (metres and radians).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Twist<S> {
    /// Ahead, m/s.
    pub forward_mps: S,
    /// To the left, m/s.
    pub left_mps: S,
    /// Counter-clockwise, rad/s.
    pub turn_radps: S,
}

impl<S: Scalar> Twist<S> {
    /// The motion of a holonomic robot with `velocity_mps` in the world, at `heading_rad`
    /// (counter-clockwise from east), while it turns at `turn_radps`.
    #[must_use]
    pub fn holonomic(velocity_mps: Vec2<S>, heading_rad: S, turn_radps: S) -> Self {
        let (sin, cos) = heading_rad.sin_cos();
        let seen = velocity_mps.rotate(cos, -sin);
        Self { forward_mps: seen.x, left_mps: seen.y, turn_radps }
    }

    /// Whether no component is NaN or infinite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.forward_mps.is_finite() && self.left_mps.is_finite() && self.turn_radps.is_finite()
    }
}

/// The world velocity that a command demands, m/s; zero for [`Command::Hold`] and
/// [`Command::Move`].
///
/// [`CellFollower`](staya_controller::agent::CellFollower) converts moves to velocities.
#[must_use]
pub fn wished_velocity<S: Scalar>(command: &Command<S>) -> Vec2<S> {
    match command {
        Command::Velocity(velocity_mps) => velocity_mps.xy(),
        Command::Hold | Command::Move(_) => Vec2::ZERO,
    }
}

/// The same angle in (-pi, pi]; NaN remains NaN.
#[must_use]
pub fn wrap_angle<S: Scalar>(angle_rad: S) -> S {
    let turn = S::PI + S::PI;
    // Angles in range keep their bits.
    if angle_rad > -S::PI && angle_rad <= S::PI {
        return angle_rad;
    }
    let turns = (S::PI - angle_rad).checked_div(turn);
    match turns.and_then(S::floor_to_i32) {
        Some(turns) => {
            let wrapped = angle_rad + S::from_i32(turns) * turn;
            // Rounding may leave the interval.
            if wrapped > -S::PI { wrapped.min(S::PI) } else { S::PI }
        }
        None => angle_rad,
    }
}

/// An arrangement of `W` wheels. Both directions are linear, so it applies to speeds and distances.
pub trait Kinematics<S, const W: usize> {
    /// The rim speeds for a motion of the body, m/s, without components that the body cannot have.
    fn wheels(&self, twist: &Twist<S>) -> [S; W];

    /// The motion of the body for given rim speeds, in the least-squares sense if they contradict.
    fn twist(&self, rims_mps: &[S; W]) -> Twist<S>;
}
