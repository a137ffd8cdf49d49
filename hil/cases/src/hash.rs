use crate::Summary;
use staya_controller::agent::{Command, Outputs};
use staya_controller::geom::{Position, Vec3};
use staya_controller::scalar::Scalar;

/// Hashes of agents' commands, of their packets, and of their state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hashes {
    pub(crate) commands: Hash,
    bytes: Hash,
    digest: Hash,
}

impl Hashes {
    pub(crate) const fn new() -> Self {
        Self { commands: Hash::new(), bytes: Hash::new(), digest: Hash::new() }
    }

    /// Adds a step: its outputs without events, which follow from the rest, and the agent's digest.
    pub(crate) fn step<S: Scalar>(&mut self, out: &Outputs<S>, digest: u64) {
        self.commands.command(&out.command);
        self.commands.word(out.call_again.as_micros().into());
        self.bytes.bytes(&out.received.to_le_bytes());
        self.bytes.bytes(&out.rejected.to_le_bytes());
        self.bytes.bytes(&out.outbox);
        self.digest.word(digest);
    }

    pub(crate) const fn put(self, summary: &mut Summary) {
        summary.commands = self.commands.value();
        summary.bytes = self.bytes.value();
        summary.digest = self.digest.value();
    }
}

/// 64-bit FNV-1a: cheap without a wide multiplier.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hash(u64);

impl Hash {
    const fn new() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }

    const fn value(self) -> u64 {
        self.0
    }

    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3);
        }
    }

    fn word(&mut self, word: u64) {
        self.bytes(&word.to_le_bytes());
    }

    fn vector<S: Scalar>(&mut self, v: Vec3<S>) {
        for component in [v.x, v.y, v.z] {
            self.word(component.to_bits());
        }
    }

    pub(crate) fn position(&mut self, position: Position) {
        for mm in position.mm {
            self.bytes(&mm.to_le_bytes());
        }
    }

    fn command<S: Scalar>(&mut self, command: &Command<S>) {
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
