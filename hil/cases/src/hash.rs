use staya_controller::agent::{Command, Outputs};
use staya_controller::geom::{Position, Vec3};
use staya_controller::scalar::Scalar;

/// 64-bit FNV-1a: cheap without a wide multiplier.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hash(u64);

impl Hash {
    pub(crate) const fn new() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }

    pub(crate) const fn value(self) -> u64 {
        self.0
    }

    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3);
        }
    }

    pub(crate) fn word(&mut self, word: u64) {
        self.bytes(&word.to_le_bytes());
    }

    pub(crate) fn vector<S: Scalar>(&mut self, v: Vec3<S>) {
        for component in [v.x, v.y, v.z] {
            self.word(component.to_bits());
        }
    }

    pub(crate) fn position(&mut self, position: Position) {
        for mm in position.mm {
            self.bytes(&mm.to_le_bytes());
        }
    }

    /// Hashes all outputs except events, which follow from the rest of the state.
    pub(crate) fn outputs<S: Scalar>(&mut self, out: &Outputs<S>) {
        self.command(&out.command);
        self.bytes(&out.received.to_le_bytes());
        self.bytes(&out.rejected.to_le_bytes());
        self.bytes(&out.outbox);
        self.word(out.call_again.as_micros().into());
    }

    pub(crate) fn command<S: Scalar>(&mut self, command: &Command<S>) {
        match command {
            Command::Hold => self.bytes(&[0]),
            Command::Move(moves) => {
                self.bytes(&[1, moves.len() as u8]);
                for dir in moves {
                    self.bytes(&[dir.index() as u8]);
                }
            }
            Command::Velocity(velocity_mps) => {
                self.bytes(&[2]);
                self.vector(*velocity_mps);
            }
        }
    }
}
