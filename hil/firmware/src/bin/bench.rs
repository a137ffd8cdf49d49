//! Measures instructions and stack of a step, for each canned swarm and for an agent under heavy
//! load, and of a beacon in each wire format.
//!
//! Prints `case scalar steps median max stack agent workspace`: counts, instructions (on a board:
//! clock cycles), bytes. Wire formats have no scalar (`-`). In an emulator with `-icount shift=0`,
//! an instruction takes 1 ns, and the tick counter resolves single instructions.
#![cfg_attr(target_os = "none", no_std, no_main)]

staya_firmware::entry!(program::run);
staya_firmware::faults_are_printed!();

#[cfg(target_os = "none")]
mod program {
    use core::hint::black_box;
    use heapless::Vec;
    #[cfg(not(part = "nrf51"))]
    use staya_cases::Case;
    use staya_cases::{Probe, Summary, WorstCase};
    use staya_controller::agent::{Agent, Grid, GridPayload, Inputs, Law, OUTBOX, Outputs, Protocol as _, Safety};
    use staya_controller::grid::{Cell, Dir};
    use staya_controller::robot::{Mode, RobotId};
    #[cfg(all(part = "stm32f405", not(debug_assertions)))]
    use staya_controller::scalar::Fast32;
    use staya_controller::scalar::{Q16, Scalar};
    use staya_controller::time::Instant;
    use staya_controller::wire::{
        Beacon, Content as _, DecodeError, EncodeError, Frame, Header, Message, Postcard, Wire,
    };
    use staya_firmware::{runtime, stack};
    #[cfg(not(part = "nrf51"))]
    use {
        staya_controller::auth::{KEY_LEN, Key},
        staya_controller::wire::Sealed,
        staya_mavlink::signed::Signed,
        staya_mavlink::signing::Signing,
        staya_mavlink::wire::Mavlink,
    };

    /// If there are more steps, every second, fourth, ... is sampled.
    const SAMPLES: usize = if cfg!(part = "nrf51") { 64 } else { 1024 };

    struct Meter {
        samples: Vec<u32, SAMPLES>,
        stride: u32,
        steps: u32,
        most_ticks: u32,
        deepest: u32,
        empty: u32,
    }

    impl Meter {
        fn new() -> Self {
            let before = runtime::ticks();
            let empty = runtime::ticks().wrapping_sub(before);
            Self { samples: Vec::new(), stride: 1, steps: 0, most_ticks: 0, deepest: 0, empty }
        }

        #[inline(always)]
        fn measure<T>(&mut self, work: impl FnOnce() -> T) -> T {
            let painted = stack::paint();
            let before = runtime::ticks();
            let out = work();
            let ticks = runtime::ticks().wrapping_sub(before);
            let depth = painted.deepest().saturating_sub(painted.began());
            self.take(ticks.saturating_sub(self.empty), depth);
            out
        }

        fn take(&mut self, ticks: u32, depth: u32) {
            self.most_ticks = self.most_ticks.max(ticks);
            self.deepest = self.deepest.max(depth);
            if self.samples.is_full() {
                let mut is_kept = false;
                self.samples.retain(|_| {
                    is_kept = !is_kept;
                    is_kept
                });
                self.stride *= 2;
            }
            if self.steps.is_multiple_of(self.stride) {
                let _ = self.samples.push(ticks);
            }
            self.steps += 1;
        }

        fn median(&mut self) -> u32 {
            self.samples.sort_unstable();
            let middle = self.samples.len() / 2;
            self.samples.get(middle).copied().unwrap_or(0)
        }
    }

    impl<S: Scalar> Probe<S> for Meter {
        fn step<G: Law<S>, A: Safety<S>, W: Wire, const N: usize>(
            &mut self,
            agent: &mut Agent<S, G, N, A, W>,
            inputs: &Inputs<'_, S, G::Surroundings<'_>>,
            now: Instant,
            workspace: &mut G::Workspace,
            out: &mut Outputs<S>,
        ) {
            *out = self.measure(|| step(agent, inputs, now, workspace));
        }
    }

    /// Not inlined, so that the caller's frame does not count.
    #[inline(never)]
    fn step<S: Scalar, G: Law<S>, A: Safety<S>, W: Wire, const N: usize>(
        agent: &mut Agent<S, G, N, A, W>,
        inputs: &Inputs<'_, S, G::Surroundings<'_>>,
        now: Instant,
        workspace: &mut G::Workspace,
    ) -> Outputs<S> {
        agent.step(inputs, now, workspace)
    }

    pub fn run() -> ! {
        let start = runtime::start();
        let row = |name: &str, scalar: &str, meter: &mut Meter, bytes: [u32; 2]| {
            let [agent_bytes, workspace_bytes] = bytes;
            let instructions = |ticks: u32| {
                if start.emulated {
                    u64::from(ticks) * 1_000_000_000 / u64::from(start.tick_hz)
                } else {
                    u64::from(ticks) * u64::from(start.clock_hz) / u64::from(start.tick_hz)
                }
            };
            let median = instructions(meter.median());
            runtime::print(format_args!(
                "{name} {scalar} {} {} {} {} {} {}\n",
                meter.steps,
                median,
                instructions(meter.most_ticks),
                meter.deepest,
                agent_bytes,
                workspace_bytes,
            ));
        };
        #[cfg(not(part = "nrf51"))]
        format(Mavlink, Mavlink, ["encode_mavlink", "decode_mavlink"], &row);
        format(Postcard, Postcard, ["encode_postcard", "decode_postcard"], &row);
        #[cfg(not(part = "nrf51"))]
        {
            let names = ["encode_signed", "decode_signed"];
            format::<Signed>(signed(), signed(), names, &row);
            let names = ["encode_sealed", "decode_sealed"];
            if let (Some(own), Some(other)) = (sealed(), sealed()) {
                format::<Sealed>(own, other, names, &row);
            }
            swarms::<f32>("f32", &row);
            worst::<f32, 16, 32>("f32", &row);
        }
        // Needs an FPU, and optimisation to fit the flash.
        #[cfg(all(part = "stm32f405", not(debug_assertions)))]
        worst::<Fast32, 16, 32>("Fast32", &row);
        // The flash fits the worst cases only; `replay` runs the swarms.
        #[cfg(not(part = "nrf51"))]
        {
            swarms::<Q16>("Q16", &row);
            worst::<Q16, 16, 32>("Q16", &row);
        }
        #[cfg(part = "nrf51")]
        worst::<Q16, 8, 16>("Q16", &row);
        runtime::exit(0)
    }

    #[cfg(not(part = "nrf51"))]
    fn signed() -> Signed {
        Signed::new(Signing::new(Key::new(black_box([7; KEY_LEN])), 0, 0))
    }

    #[cfg(not(part = "nrf51"))]
    fn sealed() -> Option<Sealed> {
        Sealed::at_start(&Key::new(black_box([7; KEY_LEN])), 0)
    }

    trait Print: Fn(&str, &str, &mut Meter, [u32; 2]) {}
    impl<F: Fn(&str, &str, &mut Meter, [u32; 2])> Print for F {}

    const fn bytes(summary: &Summary) -> [u32; 2] {
        [summary.agent_bytes, summary.workspace_bytes]
    }

    #[inline(never)]
    fn format<W: Wire>(mut own: W, mut other: W, names: [&str; 2], row: &impl Print) {
        let (mut saying, mut hearing) = (Meter::new(), Meter::new());
        for sequence in 0..64_u16 {
            let header = Header { boot: 1, sender: RobotId(7), sequence };
            let payload = GridPayload {
                cell: Cell::new(98, -98),
                target: Cell::new(98, 70),
                busy_ms: 400,
                heading: Dir::NorthWest,
                slot: 4,
                leader: RobotId(1),
            };
            let (protocol, payload) = payload.encode(Grid::ID).unwrap_or_default();
            let beacon = Message::Beacon(Beacon {
                position_mm: [12_345 + i32::from(sequence), -678_901, 4_000],
                velocity_mmps: [250, -3, 1],
                radius_mm: 150,
                mode: Mode::Cruise,
                flock: 0,
                protocol,
                payload,
            });
            let mut out = Vec::<u8, OUTBOX>::new();
            let said = saying.measure(|| encode(&mut own, header, black_box(&beacon), &mut out));
            let heard = hearing.measure(|| decode(&mut other, black_box(&out)));
            assert!(said.is_ok() && heard.is_ok_and(|frame| frame.message == beacon));
        }
        let kept = [size_of::<W>() as u32, 0];
        let [encode, decode] = names;
        row(encode, "-", &mut saying, kept);
        row(decode, "-", &mut hearing, kept);
    }

    /// Not inlined: `cargo xtask size` finds the flash of this function by its name.
    #[inline(never)]
    fn encode<W: Wire>(
        wire: &mut W,
        header: Header,
        message: &Message,
        out: &mut Vec<u8, OUTBOX>,
    ) -> Result<usize, EncodeError> {
        wire.encode(header, message, out)
    }

    #[inline(never)]
    fn decode<W: Wire>(wire: &mut W, mut inbox: &[u8]) -> Result<Frame, DecodeError> {
        let frame = wire.next_frame(&mut inbox).ok_or(DecodeError::Empty)?;
        wire.decode(frame)
    }

    #[cfg(not(part = "nrf51"))]
    fn swarms<S: Scalar>(scalar: &str, row: &impl Print) {
        for &case in Case::ALL {
            let mut meter = Meter::new();
            let summary = case.run::<S, _>(&mut meter);
            row(case.name(), scalar, &mut meter, bytes(&summary));
        }
    }

    fn worst<S: Scalar, const N: usize, const K: usize>(scalar: &str, row: &impl Print) {
        for &case in WorstCase::ALL {
            let mut meter = Meter::new();
            let summary = case.run::<S, _, N, K>(&mut meter);
            row(case.name(), scalar, &mut meter, bytes(&summary));
        }
    }
}
