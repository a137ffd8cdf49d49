use core::convert::Infallible;
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use std::cell::Cell;
use std::rc::Rc;

/// A PWM channel; clones are the same channel.
#[derive(Clone, Default)]
pub struct Channel<const MAX: u16>(pub Rc<Cell<u16>>);

impl<const MAX: u16> ErrorType for Channel<MAX> {
    type Error = Infallible;
}

impl<const MAX: u16> SetDutyCycle for Channel<MAX> {
    fn max_duty_cycle(&self) -> u16 {
        MAX
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        assert!(duty <= MAX);
        self.0.set(duty);
        Ok(())
    }
}
