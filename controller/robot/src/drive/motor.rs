use core::fmt;
use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;

/// Full power: duties are in [-[`FULL`], [`FULL`]].
pub const FULL: i16 = i16::MAX;

/// A motor that turns in both directions.
pub trait Motor {
    /// The error that its pins can report.
    type Error;

    /// Sets the duty; [`FULL`] is full power ahead.
    ///
    /// # Errors
    /// The error of the pins; the duty is then unknown.
    fn set(&mut self, duty: i16) -> Result<(), Self::Error>;
}

/// The error of a [`SignMagnitude`] or [`TwoPins`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MotorError<P, D> {
    /// Error of the PWM channel.
    Pwm(P),
    /// Error of a direction pin.
    Pin(D),
}

impl<P: fmt::Debug, D: fmt::Debug> fmt::Display for MotorError<P, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pwm(error) => write!(f, "the PWM channel failed: {error:?}"),
            Self::Pin(error) => write!(f, "the direction pin failed: {error:?}"),
        }
    }
}

impl<P: fmt::Debug, D: fmt::Debug> core::error::Error for MotorError<P, D> {}

/// PWM for the power and a pin for the direction (high: ahead), as on DRV8835 (PH/EN) and TB9051.
#[derive(Clone, Debug)]
pub struct SignMagnitude<P, D> {
    pwm: P,
    direction: D,
}

impl<P: SetDutyCycle, D: OutputPin> SignMagnitude<P, D> {
    /// Creates a motor on these pins without setting them.
    #[must_use]
    pub const fn new(pwm: P, direction: D) -> Self {
        Self { pwm, direction }
    }

    /// Returns the pins.
    #[must_use]
    pub fn release(self) -> (P, D) {
        (self.pwm, self.direction)
    }
}

impl<P: SetDutyCycle, D: OutputPin> Motor for SignMagnitude<P, D> {
    type Error = MotorError<P::Error, D::Error>;

    fn set(&mut self, duty: i16) -> Result<(), Self::Error> {
        let power = scaled(duty, self.pwm.max_duty_cycle());
        // Half a period in the wrong direction is a jerk.
        let pwm = |result: Result<(), P::Error>| result.map_err(MotorError::Pwm);
        pwm(self.pwm.set_duty_cycle(0))?;
        self.direction.set_state((duty >= 0).into()).map_err(MotorError::Pin)?;
        pwm(self.pwm.set_duty_cycle(power))
    }
}

/// PWM for the power and two pins for the direction (both low: coast), as on L298N and TB6612.
#[derive(Clone, Debug)]
pub struct TwoPins<P, A, B> {
    pwm: P,
    ahead: A,
    back: B,
}

impl<P: SetDutyCycle, A: OutputPin, B: OutputPin<Error = A::Error>> TwoPins<P, A, B> {
    /// Creates a motor on these pins without setting them.
    #[must_use]
    pub const fn new(pwm: P, ahead: A, back: B) -> Self {
        Self { pwm, ahead, back }
    }
}

impl<P: SetDutyCycle, A: OutputPin, B: OutputPin<Error = A::Error>> Motor for TwoPins<P, A, B> {
    type Error = MotorError<P::Error, A::Error>;

    fn set(&mut self, duty: i16) -> Result<(), Self::Error> {
        let power = scaled(duty, self.pwm.max_duty_cycle());
        let pwm = |result: Result<(), P::Error>| result.map_err(MotorError::Pwm);
        pwm(self.pwm.set_duty_cycle(0))?;
        let ahead = self.ahead.set_state((duty > 0).into());
        let back = self.back.set_state((duty < 0).into());
        ahead.and(back).map_err(MotorError::Pin)?;
        pwm(self.pwm.set_duty_cycle(power))
    }
}

/// A PWM channel for each direction, of one type, as on DRV8833 and DRV8871 (IN/IN mode). The idle
/// channel stays low, and between pulses the motor coasts.
#[derive(Clone, Debug)]
pub struct HBridge<P> {
    ahead: P,
    back: P,
}

impl<P: SetDutyCycle> HBridge<P> {
    /// Creates a motor on these channels without setting them.
    #[must_use]
    pub const fn new(ahead: P, back: P) -> Self {
        Self { ahead, back }
    }

    /// Returns the channels.
    #[must_use]
    pub fn release(self) -> (P, P) {
        (self.ahead, self.back)
    }
}

impl<P: SetDutyCycle> Motor for HBridge<P> {
    type Error = P::Error;

    fn set(&mut self, duty: i16) -> Result<(), P::Error> {
        let (used, idle) = if duty < 0 { (&mut self.back, &mut self.ahead) } else { (&mut self.ahead, &mut self.back) };
        // Both on would brake with full current.
        idle.set_duty_cycle(0)?;
        let power = scaled(duty, used.max_duty_cycle());
        used.set_duty_cycle(power)
    }
}

fn scaled(duty: i16, max: u16) -> u16 {
    let full = u32::from(FULL.unsigned_abs());
    let power = u32::from(duty.unsigned_abs()).min(full);
    let scaled = (power * u32::from(max) + (full >> 1)).checked_div(full);
    scaled.and_then(|s| u16::try_from(s).ok()).unwrap_or(0)
}
