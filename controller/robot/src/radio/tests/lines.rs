use embedded_io::{ErrorKind, ErrorType, Read, ReadReady, Write, WriteReady};
#[cfg(feature = "async")]
pub use halves::half;
use std::collections::VecDeque;
use std::vec::Vec;

#[derive(Default)]
pub struct Uart {
    pub inbound: VecDeque<u8>,
    pub outbound: Vec<u8>,
    /// Bytes that it accepts before it is busy.
    pub room: usize,
    pub read_fails: bool,
    pub write_fails: bool,
    pub calls: usize,
}

impl ErrorType for Uart {
    type Error = ErrorKind;
}

impl Read for Uart {
    fn read(&mut self, buf: &mut [u8]) -> Result<usize, ErrorKind> {
        assert!(!self.inbound.is_empty(), "would block");
        self.calls += 1;
        let len = buf.len().min(self.inbound.len()).min(5);
        for (to, from) in buf.iter_mut().zip(self.inbound.drain(..len)) {
            *to = from;
        }
        Ok(len)
    }
}

impl ReadReady for Uart {
    fn read_ready(&mut self) -> Result<bool, ErrorKind> {
        if core::mem::take(&mut self.read_fails) {
            return Err(ErrorKind::InvalidData);
        }
        Ok(!self.inbound.is_empty())
    }
}

impl Write for Uart {
    fn write(&mut self, buf: &[u8]) -> Result<usize, ErrorKind> {
        assert!(self.room > 0, "would block");
        let len = buf.len().min(self.room).min(3);
        self.outbound.extend(&buf[..len]);
        self.room -= len;
        Ok(len)
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        panic!("would block")
    }
}

impl WriteReady for Uart {
    fn write_ready(&mut self) -> Result<bool, ErrorKind> {
        if self.write_fails && self.room == 0 {
            self.write_fails = false;
            return Err(ErrorKind::BrokenPipe);
        }
        Ok(self.room > 0)
    }
}

#[cfg(feature = "async")]
mod halves {
    use embedded_io::{ErrorKind, ErrorType};
    use std::collections::VecDeque;
    use std::vec::Vec;

    /// Half of a line: ready while bytes are left, then pending.
    pub struct Half {
        script: VecDeque<Result<Vec<u8>, ErrorKind>>,
        heard: Vec<u8>,
    }

    impl ErrorType for Half {
        type Error = ErrorKind;
    }

    impl embedded_io_async::Read for Half {
        async fn read(&mut self, buf: &mut [u8]) -> Result<usize, ErrorKind> {
            match self.script.pop_front() {
                None => core::future::pending().await,
                Some(Err(error)) => Err(error),
                Some(Ok(bytes)) => {
                    buf[..bytes.len()].copy_from_slice(&bytes);
                    Ok(bytes.len())
                }
            }
        }
    }

    impl embedded_io_async::Write for Half {
        async fn write(&mut self, buf: &[u8]) -> Result<usize, ErrorKind> {
            match self.script.pop_front() {
                None => core::future::pending().await,
                Some(Err(error)) => Err(error),
                Some(Ok(room)) => {
                    let len = room.len().min(buf.len());
                    self.heard.extend(&buf[..len]);
                    Ok(len)
                }
            }
        }

        async fn flush(&mut self) -> Result<(), ErrorKind> {
            core::future::pending().await
        }
    }

    pub fn half(script: impl IntoIterator<Item = Result<Vec<u8>, ErrorKind>>) -> Half {
        Half { script: script.into_iter().collect(), heard: Vec::new() }
    }
}
